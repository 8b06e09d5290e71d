// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/reader/gmsh.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
#include "fem/mesh/reader/gmsh_library.h"
#include "fem/mesh/reader/gmsh_model.h"

// gmsh keeps its state in globals, so there is one.
static FemMeshGmshLibrary gmsh;

static Status set_option(const char *name, double value) {
  int error = 0;
  gmsh.OptionSetNumber(name, value, &error);
  return error ? fem_mesh_gmsh_library_fail(&gmsh, "take an option") : STATUS_OK;
}

static Status start(void) {
  int error = 0;
  fem_mesh_gmsh_library_start(&gmsh, &error);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "start");
  gmsh.LoggerStart(&error);
  static const struct {
    const char *name;
    double value;
  } options[] = {
      {"General.Terminal", 0},     {"General.NumThreads", 1},   {"Mesh.MaxNumThreads1D", 1},
      {"Mesh.MaxNumThreads2D", 1}, {"Mesh.MaxNumThreads3D", 1},
  };
  for (size_t k = 0; k < sizeof options / sizeof *options; k++)
    TRY(set_option(options[k].name, options[k].value));
  return STATUS_OK;
}

// A size far below the model's is a slip of units: say so before gmsh works on it for hours.
static Status set_size(double size) {
  double low[3], high[3], volume = 1;
  int error = 0;
  gmsh.ModelGetBoundingBox(-1, -1, &low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &error);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "find the bounding box");
  for (int c = 0; c < 3; c++) volume *= fmax(high[c] - low[c], size);
  // A regular tetrahedron of edge a has a³/(6√2).
  double tets = volume / (size * size * size) * 6 * sqrt(2);
  if (!(tets <= FEM_MESH_MAX_TETS))
    return status_fail(
        STATUS_INPUT,
        "size %g would make about %.1g tetrahedra of a body of %g × %g × %g; give a larger one, in the "
        "units of the file",
        size, tets, high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  TRY(set_option("Mesh.MeshSizeMin", size));
  return set_option("Mesh.MeshSizeMax", size);
}

static Status generate(int seed) {
  int error = 0;
  TRY(set_option("Mesh.RandomSeed", seed));
  gmsh.ModelMeshGenerate(3, &error);
  return error ? fem_mesh_gmsh_library_fail(&gmsh, "mesh it") : STATUS_OK;
}

static Status clear_mesh(void) {
  int error = 0;
  gmsh.ModelMeshClear(NULL, 0, &error);
  return error ? fem_mesh_gmsh_library_fail(&gmsh, "mesh it again") : STATUS_OK;
}

static Status measure(double *dihedral) {
  FemMeshSource source = {0};
  Status status = fem_mesh_gmsh_model_take(&gmsh, &source, false);
  if (status == STATUS_OK)
    *dihedral = fem_mesh_min_dihedral(&(FemMesh){.vertex_count = source.vertex_count,
                                                 .tet_count = source.tet_count,
                                                 .rest = source.positions,
                                                 .tets = source.tets});
  fem_mesh_source_destroy(&source);
  return status;
}

// gmsh now and then leaves a sliver: of six sizes of a slab three had an angle below 1°. Its HXT algorithm
// does not, but gives another mesh each time. Another seed is the remedy; the best of SEED_COUNT if none is
// good enough.
static Status generate_well(void) {
  enum { SEED_COUNT = 8 };
  const double good_degrees = 8;
  double best = -1, dihedral = 0;
  int best_seed = 0;
  for (int seed = 1; seed <= SEED_COUNT; seed++) {
    if (seed > 1) TRY(clear_mesh());
    TRY(generate(seed));
    TRY(measure(&dihedral));
    if (dihedral >= good_degrees) return STATUS_OK;
    if (dihedral > best) best = dihedral, best_seed = seed;
  }
  if (best_seed == SEED_COUNT) return STATUS_OK;
  TRY(clear_mesh());
  return generate(best_seed);
}

// Makes one volume of all surfaces of the model.
static Status add_volume(void) {
  int *pairs = NULL, error = 0;
  size_t count = 0;
  gmsh.ModelGetEntities(&pairs, &count, 2, &error);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "list the surfaces");
  for (size_t k = 0; k < count / 2; k++) pairs[k] = pairs[2 * k + 1];
  int loop = gmsh.ModelGeoAddSurfaceLoop(pairs, count / 2, -1, &error);
  gmsh.Free(pairs);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "close the surface");
  gmsh.ModelGeoAddVolume(&loop, 1, -1, &error);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "make a volume of the surface");
  gmsh.ModelGeoSynchronize(&error);
  return error ? fem_mesh_gmsh_library_fail(&gmsh, "make a volume of the surface") : STATUS_OK;
}

// Patches that bend by less than 40° become smooth surfaces that can be meshed anew.
static Status remesh_surface(size_t triangle_count) {
  int error = 0;
  // gmsh splits the surface in parts that can be laid flat, and never ends where there are too few triangles
  // to split (a tetrahedron has four): cut each into four, which changes no shape.
  enum { ENOUGH_TRIANGLES = 256 };
  for (size_t count = triangle_count; count < ENOUGH_TRIANGLES; count *= 4) {
    gmsh.ModelMeshRefine(&error);
    if (error) return fem_mesh_gmsh_library_fail(&gmsh, "refine the surface");
  }
  const double degree = acos(-1) / 180;
  gmsh.ModelMeshClassifySurfaces(40 * degree, 1, 1, 180 * degree, 1, &error);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "divide the surface into smooth patches");
  gmsh.ModelMeshCreateGeometry(NULL, 0, &error);
  return error ? fem_mesh_gmsh_library_fail(&gmsh, "parametrise the surface") : STATUS_OK;
}

static Status mesh_stl(double size) {
  size_t triangle_count;
  TRY(fem_mesh_gmsh_model_check_shell(&gmsh, &triangle_count));
  if (size > 0) {
    TRY(set_size(size));
    TRY(remesh_surface(triangle_count));
  }
  TRY(add_volume());
  // Without a geometry the triangles are all there is: nothing may be cleared.
  return size > 0 ? generate_well() : generate(1);
}

static Status mesh_geo(double size) {
  int *types = NULL, error = 0;
  size_t count = 0;
  gmsh.ModelMeshGetElementTypes(&types, &count, 3, -1, &error);
  gmsh.Free(types);
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, "list the types of elements");
  // The script has meshed itself.
  if (count > 0) return STATUS_OK;
  if (size > 0) TRY(set_size(size));
  return generate_well();
}

static bool ends_in(const char *path, const char *ending) {
  const char *dot = strrchr(path, '.');
  return dot && strcasecmp(dot, ending) == 0;
}

static Status read_all(FemMeshSource *source, const char *path, double size) {
  int error = 0;
  TRY(start());
  gmsh.Open(path, &error);
  bool is_stl = ends_in(path, ".stl"), is_geo = ends_in(path, ".geo");
  if (error) return fem_mesh_gmsh_library_fail(&gmsh, is_geo ? "run it" : "read it (is the file complete?)");
  if (is_stl) TRY(mesh_stl(size));
  if (is_geo) TRY(mesh_geo(size));
  return fem_mesh_gmsh_model_take(&gmsh, source, !is_stl);
}

Status fem_mesh_gmsh_read(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  *source = (FemMeshSource){0};
  TRY(fem_mesh_gmsh_library_load(&gmsh));
  Status status = read_all(source, path, options->size);
  int error = 0;
  gmsh.Finalize(&error);
  if (status != STATUS_OK) fem_mesh_source_destroy(source);
  return status;
}
