// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "base/log.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/mesh/reader/gmsh.h"
#include "fem/mesh/reader/header.h"
#include "fem/mesh/reader/medit.h"
#include "fem/mesh/reader/tetgen.h"
#include "fem/mesh/reader/worker.h"

static bool is_meshed_here(FemMeshFormat format) {
  return format == FEM_MESH_FORMAT_STL || format == FEM_MESH_FORMAT_GEO;
}

static Status check_options(const char *path, FemMeshFormat format, const FemMeshOptions *options) {
  if (!(options->size >= 0 && isfinite(options->size)))
    return status_fail(STATUS_INPUT,
                       "%s: size is %g; give a positive length in the units of the file, or leave it out",
                       path, options->size);
  if (options->size > 0 && !is_meshed_here(format))
    return status_fail(STATUS_INPUT,
                       "%s: is meshed already, so size has no effect; leave size out, or give a .stl or .geo",
                       path);
  return STATUS_OK;
}

// gmsh in a process of its own, and a check that it left nothing out.
static Status read_by_gmsh(FemMeshSource *source, const char *path, FemMeshFormat format,
                           const FemMeshOptions *options, const FemMeshHeader *header, size_t memory_limit) {
  char *copy = NULL;
  if (format == FEM_MESH_FORMAT_MEDIT) TRY(fem_mesh_medit_split(path, &copy));
  Status status = fem_mesh_worker_run(fem_mesh_gmsh_read, source, copy ? copy : path, options, memory_limit);
  if (copy) remove(copy);
  memory_free(copy);
  long long announced = header->tet_count;
  if (status == STATUS_OK && announced >= 0 && announced != source->tet_count)
    status = status_fail(STATUS_INPUT, "announces %lld tetrahedra, but %d can be read; is it complete?",
                         announced, source->tet_count);
  return status == STATUS_OK ? STATUS_OK : status_prefix(status, "%s", path);
}

static Status read_source(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  FemMeshFormat format;
  FemMeshHeader header;
  TRY(fem_mesh_header_format(path, &format));
  TRY(check_options(path, format, options));
  if (format == FEM_MESH_FORMAT_TETGEN) return fem_mesh_tetgen_read(source, path);
  TRY(fem_mesh_header_check(path, format, &header));
  if (is_meshed_here(format) && ranks()->count > 1)
    return status_fail(STATUS_USAGE,
                       "%s: is meshed by gmsh, which several ranks cannot do at once: mesh it first, as in "
                       "`tetlap mesh`, and name the mesh",
                       path);
  // Reading takes memory in proportion to the file (a 4-byte integer makes a pointer or two); meshing does
  // not.
  size_t limit = is_meshed_here(format) ? 0 : ((size_t)1 << 30) + 64 * header.size;
  return read_by_gmsh(source, path, format, options, &header, limit);
}

Status fem_mesh_read(FemMesh *mesh, const char *path, const FemMeshOptions *options,
                     FemMeshRepairs *repairs) {
  static const FemMeshOptions plain = {0};
  FemMeshSource source = {0};
  FemMeshRepairs mended = {0};
  *mesh = (FemMesh){0};
  Status status = read_source(&source, path, options ? options : &plain);
  if (status == STATUS_OK) status = fem_mesh_validate(mesh, &source, path, &mended);
  fem_mesh_source_destroy(&source);
  if (mended.reoriented_tets)
    log_info("%s: inverted tetrahedra whose orientation was corrected: %d", path, mended.reoriented_tets);
  if (mended.dropped_vertices)
    log_info("%s: vertices that belong to no tetrahedron and have been left out: %d", path,
             mended.dropped_vertices);
  if (repairs) *repairs = mended;
  return status;
}
