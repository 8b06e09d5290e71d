// SPDX-License-Identifier: Apache-2.0
#include "overlap/api/argument.h"

#include <limits.h>
#include <math.h>
#include <string.h>

Status overlap_api_argument_copy(void *ours, size_t size, size_t first_size, const void *theirs,
                                 const char *name) {
  size_t given;
  if (!theirs) return status_fail(STATUS_INPUT, "%s is NULL", name);
  memcpy(&given, theirs, sizeof given);
  if (given < first_size)
    return status_fail(STATUS_INPUT, "%s: its size is %zu, at least %zu are expected; begin with %s_INIT",
                       name, given, first_size, "TETLAP_OVERLAP_…");
  for (size_t at = size; at < given; at++)
    if (((const char *)theirs)[at] != 0)
      return status_fail(
          STATUS_INPUT,
          "%s: it has %zu bytes, this library knows %zu, and a field set beyond that needs a later library",
          name, given, size);
  memset(ours, 0, size);
  memcpy(ours, theirs, given < size ? given : size);
  return STATUS_OK;
}

static Status check_mesh(const TetlapOverlapMesh *mesh, int number) {
  if (mesh->tet_count > INT_MAX || mesh->point_count > INT_MAX)
    return status_fail(STATUS_INPUT, "mesh %d: at most %d points and tetrahedra are expected", number,
                       INT_MAX);
  if ((mesh->tet_count > 0 && !mesh->tets) || (mesh->point_count > 0 && !mesh->points))
    return status_fail(STATUS_INPUT, "mesh %d: `%s` is NULL", number, mesh->points ? "tets" : "points");
  for (size_t k = 0; k < 3 * mesh->point_count; k++)
    if (!isfinite(mesh->points[k]))
      return status_fail(STATUS_INPUT, "mesh %d, point %zu: coordinate %c is %g, it must be a finite number",
                         number, k / 3, "xyz"[k % 3], mesh -> points[k]);
  for (size_t k = 0; k < 4 * mesh->tet_count; k++)
    if (mesh->tets[k] < 0 || (size_t)mesh->tets[k] >= mesh->point_count)
      return status_fail(STATUS_INPUT, "mesh %d, tetrahedron %zu: there is no point %d, of 0 to %zd", number,
                         k / 4, (int)mesh->tets[k], (ptrdiff_t)mesh->point_count - 1);
  return STATUS_OK;
}

Status overlap_api_argument_mesh(TetlapOverlapMesh *mesh, const TetlapOverlapMesh *theirs, int number) {
  TRY(overlap_api_argument_copy(mesh, sizeof *mesh, sizeof *mesh, theirs, "TetlapOverlapMesh"));
  return check_mesh(mesh, number);
}

int overlap_api_argument_status(Status status) {
  switch (status) {
  case STATUS_OK:
    return TETLAP_OVERLAP_OK;
  case STATUS_USAGE:
  case STATUS_INPUT:
    return TETLAP_OVERLAP_INVALID;
  case STATUS_IO:
    return TETLAP_OVERLAP_NO_FILE;
  case STATUS_MEMORY:
    return TETLAP_OVERLAP_MEMORY;
  case STATUS_DEVICE:
    return TETLAP_OVERLAP_DEVICE;
  default:
    return TETLAP_OVERLAP_INTERNAL;
  }
}
