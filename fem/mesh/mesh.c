// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/mesh.h"

#include <float.h>
#include <limits.h>
#include <stdbool.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"

void fem_mesh_group_destroy(FemMeshGroup *group) {
  memory_free(group->name), memory_free(group->vertices), memory_free(group->middles);
  memory_free(group->tets);
  *group = (FemMeshGroup){0};
}

void fem_mesh_destroy(FemMesh *mesh) {
  for (int g = 0; g < mesh->group_count; g++) fem_mesh_group_destroy(&mesh->groups[g]);
  memory_free(mesh->groups);
  memory_free(mesh->rest);
  memory_free(mesh->tets);
  memory_free(mesh->middles), memory_free(mesh->tet_tags);
  memory_free(mesh->quadratic);
  *mesh = (FemMesh){0};
}

// A copy of an array into the pointer at `copy`; of none, none. False: no memory.
static bool copy_array(void *copy, const void *array, size_t count, size_t size) {
  void *made = array ? memory_copy(array, count, size) : NULL;
  memcpy(copy, &made, sizeof made);
  return made || !array;
}

static bool copy_group(FemMeshGroup *copy, const FemMeshGroup *group) {
  copy->vertex_count = group->vertex_count, copy->middle_count = group->middle_count;
  copy->tet_count = group->tet_count;
  return copy_array(&copy->name, group->name, strlen(group->name) + 1, 1) &&
         copy_array(&copy->vertices, group->vertices, (size_t)group->vertex_count, sizeof(int)) &&
         copy_array(&copy->middles, group->middles, (size_t)group->middle_count, sizeof(int)) &&
         copy_array(&copy->tets, group->tets, (size_t)group->tet_count, sizeof(int));
}

static bool copy_groups(FemMesh *copy, const FemMesh *mesh) {
  copy->groups = memory_zeroed((size_t)mesh->group_count, sizeof *copy->groups);
  if (!copy->groups) return false;
  copy->group_count = mesh->group_count;
  for (int g = 0; g < mesh->group_count; g++)
    if (!copy_group(&copy->groups[g], &mesh->groups[g])) return false;
  return true;
}

Status fem_mesh_copy(FemMesh *copy, const FemMesh *mesh) {
  size_t vertices = (size_t)mesh->vertex_count, tets = (size_t)mesh->tet_count;
  *copy = (FemMesh){.vertex_count = mesh->vertex_count,
                    .tet_count = mesh->tet_count,
                    .edge_count = mesh->edge_count,
                    .quadratic_count = mesh->quadratic_count};
  bool is_whole =
      copy_array(&copy->rest, mesh->rest, vertices, sizeof(double[3])) &&
      copy_array(&copy->tets, mesh->tets, tets, sizeof *mesh->tets) &&
      copy_array(&copy->middles, mesh->middles, (size_t)mesh->edge_count, sizeof(double[3])) &&
      copy_array(&copy->tet_tags, mesh->tet_tags, tets, sizeof *mesh->tet_tags) &&
      copy_array(&copy->quadratic, mesh->quadratic, (size_t)mesh->quadratic_count, sizeof *mesh->quadratic) &&
      copy_groups(copy, mesh);
  if (is_whole) return STATUS_OK;
  fem_mesh_destroy(copy);
  return status_no_memory("a copy of a mesh");
}

// Sine and cosine of an angle in degrees, exact at quarter turns.
static void sine_cosine(double degrees, double *sine, double *cosine) {
  double reduced = remainder(degrees, 360), quarters = nearbyint(reduced / 90);
  double rest = (reduced - 90 * quarters) * (acos(-1) / 180), s = sin(rest), c = cos(rest);
  switch ((int)quarters & 3) {
  case 0:
    *sine = s, *cosine = c;
    return;
  case 1:
    *sine = c, *cosine = -s;
    return;
  case 2:
    *sine = -s, *cosine = -c;
    return;
  default:
    *sine = -c, *cosine = s;
    return;
  }
}

// Rotation by the axis and angle of a placement (Rodrigues), row-major.
static void rotation_of(const FemPlacement *placement, double R[9]) {
  memcpy(R, (double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, 9 * sizeof *R);
  Vec3 axis = vec3_at(placement->axis);
  double length = vec3_length(axis), s, c;
  if (length == 0) return;
  Vec3 k = vec3_scale(1 / length, axis);
  sine_cosine(placement->angle_degrees, &s, &c);
  memcpy(R,
         (double[9]){c + k.x * k.x * (1 - c), k.x * k.y * (1 - c) - k.z * s, k.x * k.z * (1 - c) + k.y * s,
                     k.y * k.x * (1 - c) + k.z * s, c + k.y * k.y * (1 - c), k.y * k.z * (1 - c) - k.x * s,
                     k.z * k.x * (1 - c) - k.y * s, k.z * k.y * (1 - c) + k.x * s, c + k.z * k.z * (1 - c)},
         9 * sizeof *R);
}

void fem_mesh_placement_axes(const FemPlacement *placement, double axes[3][3]) {
  double R[9];
  rotation_of(placement, R);
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) axes[k][c] = R[3 * c + k];
}

static bool is_finite3(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static Status check_placement(const FemMesh *mesh, const FemPlacement *placement) {
  const double *s = placement->scale, *t = placement->translate;
  if (!(is_finite3(s) && isnormal(s[0] * s[1] * s[2])))
    return status_fail(STATUS_INPUT, "scale is (%g, %g, %g); give three finite factors other than zero", s[0],
                       s[1], s[2]);
  if (!is_finite3(t))
    return status_fail(STATUS_INPUT, "translate is (%g, %g, %g); give three finite lengths", t[0], t[1],
                       t[2]);
  if (!(is_finite3(placement->axis) && isfinite(placement->angle_degrees)))
    return status_fail(STATUS_INPUT, "rotation by %g° about (%g, %g, %g); give finite numbers",
                       placement->angle_degrees, placement->axis[0], placement->axis[1], placement->axis[2]);
  if (placement->angle_degrees != 0 && vec3_length(vec3_at(placement->axis)) == 0)
    return status_fail(STATUS_INPUT, "rotation by %g° about no axis; give an axis other than (0, 0, 0)",
                       placement->angle_degrees);
  double reach = 0;
  for (size_t k = 0; k < 3 * (size_t)mesh->vertex_count; k++)
    reach = fmax(reach, fabs(mesh->rest[k] * s[k % 3]));
  for (size_t k = 0; k < 3 * (size_t)mesh->edge_count; k++)
    reach = fmax(reach, fabs(mesh->middles[k] * s[k % 3]));
  if (!(reach < DBL_MAX / 8 && fmax(fabs(t[0]), fmax(fabs(t[1]), fabs(t[2]))) < DBL_MAX / 8))
    return status_fail(STATUS_INPUT,
                       "placing the mesh exceeds the range of numbers; give a smaller scale or translation");
  return STATUS_OK;
}

static void place_points(const FemPlacement *placement, const double R[9], int count, double *points) {
  const double *s = placement->scale, *t = placement->translate;
  for (int v = 0; v < count; v++) {
    double *x = points + 3 * (size_t)v;
    double p[3] = {s[0] * x[0], s[1] * x[1], s[2] * x[2]};
    for (int i = 0; i < 3; i++) x[i] = t[i] + (R[3 * i] * p[0] + R[3 * i + 1] * p[1] + R[3 * i + 2] * p[2]);
  }
}

Status fem_mesh_place(FemMesh *mesh, const FemPlacement *placement) {
  TRY(check_placement(mesh, placement));
  const double *s = placement->scale;
  double R[9];
  rotation_of(placement, R);
  place_points(placement, R, mesh->vertex_count, mesh->rest);
  place_points(placement, R, mesh->edge_count, mesh->middles);
  // Edges keep their ends, and so their numbers.
  bool is_mirrored = (s[0] < 0) != ((s[1] < 0) != (s[2] < 0));
  for (int e = 0; is_mirrored && e < mesh->tet_count; e++) {
    int kept = mesh->tets[e][2];
    mesh->tets[e][2] = mesh->tets[e][3];
    mesh->tets[e][3] = kept;
  }
  return STATUS_OK;
}
