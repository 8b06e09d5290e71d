// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/meshes.h"

#include <string.h>

#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "fem/mesh/curve.h"

// Tells what a mesh of second-order tetrahedra loses as one of linear ones.
static Status straighten(FemMesh *mesh, const char *path) {
  FemMeshCurvature curvature;
  TRY(fem_mesh_curvature(mesh, &curvature));
  log_info("%s: second-order tetrahedra, taken by their corners; the other nodes lie up to %.2g of an edge's "
           "length from the middles of their edges (element: quadratic keeps them)",
           path, curvature.deviation);
  fem_mesh_make_linear(mesh);
  return STATUS_OK;
}

// A mesh as its file has it, kept for the bodies and obstacles that are made of it, too: it is read, and
// meshed, once.
typedef struct KeptMesh {
  const char *path; // as the scene has it, borrowed
  double size;
  FemMesh mesh;
} KeptMesh;

// How many bodies and obstacles are made of that file.
static int count_users(const FemSceneDef *scene, const char *path, double size) {
  int count = 0;
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *def = &scene->bodies[b];
    count += def->mesh_path && strcmp(def->mesh_path, path) == 0 && def->mesh_options.size == size;
  }
  for (int o = 0; o < scene->obstacle_count; o++) {
    const FemObstacleDef *def = &scene->obstacles[o];
    count += def->kind == FEM_OBSTACLE_MESH && def->mesh_path && strcmp(def->mesh_path, path) == 0 &&
             def->mesh_options.size == size;
  }
  return count;
}

static Status read_mesh(FemMesh *mesh, const FemSceneDef *scene, const char *path,
                        const FemMeshOptions *options) {
  char *directory = file_directory_of(scene->path ? scene->path : ".");
  char *full = directory ? file_join(directory, path) : NULL;
  Status status = full ? fem_mesh_read(mesh, full, options, NULL) : status_no_memory("a file name");
  memory_free(directory);
  memory_free(full);
  return status;
}

// Reads a file, or copies what was read of it before. `kept` has room for one more.
static Status take_mesh(FemMesh *mesh, const FemSceneDef *scene, const char *path,
                        const FemMeshOptions *options, KeptMesh *kept) {
  for (; kept->path; kept++)
    if (strcmp(kept->path, path) == 0 && kept->size == options->size) return fem_mesh_copy(mesh, &kept->mesh);
  TRY(read_mesh(mesh, scene, path, options));
  if (count_users(scene, path, options->size) == 1) return STATUS_OK;
  TRY(fem_mesh_copy(&kept->mesh, mesh));
  kept->path = path, kept->size = options->size;
  return STATUS_OK;
}

// What the mesh of a body or an obstacle is made of; all is borrowed.
typedef struct MeshSource {
  const char *path; // NULL: a box
  const double *box_size;
  const int *box_cells;
  const FemMeshOptions *options;
  const FemPlacement *placement;
  FemElementKind element;
} MeshSource;

// Reads or makes a mesh and puts it in its place.
static Status load_mesh(FemMesh *mesh, const FemSceneDef *scene, const MeshSource *source, KeptMesh *kept) {
  const char *path = source->path;
  const FemMeshOptions *options = source->options;
  TRY(path ? take_mesh(mesh, scene, path, options, kept)
           : fem_mesh_box(mesh, source->box_size, source->box_cells));
  TRY(fem_mesh_place(mesh, source->placement));
  if (options->is_curved && source->element != FEM_ELEMENT_QUADRATIC)
    return status_fail(STATUS_INPUT, "'mesh.curved': only quadratic elements have edges that can be curved; "
                                     "write 'element: quadratic', or leave 'curved' out");
  if (source->element == FEM_ELEMENT_QUADRATIC) {
    Status status = options->is_curved ? fem_mesh_curve(mesh, scene->contact.crease) : STATUS_OK;
    if (!status) status = fem_mesh_make_quadratic(mesh);
    return status && path ? status_prefix(status, "%s", path) : status;
  }
  return mesh->middles ? straighten(mesh, path) : STATUS_OK;
}

// With the mesh's place in the scene.
static Status fail_at(Status status, const FemSceneDef *scene, const FemScenePlace *place, const char *what,
                      const char *name) {
  return status_prefix(status, "%s: %s '%s'", fem_scene_where(scene, place).text, what, name);
}

// The meshes of all bodies, then of the obstacles that have one. `meshes` has room for all, `kept` for one
// more.
static Status load_each(const FemSceneDef *scene, FemMesh *meshes, KeptMesh *kept) {
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *def = &scene->bodies[b];
    MeshSource source = {def->mesh_path,     def->box_size,   def->box_cells,
                         &def->mesh_options, &def->placement, def->element};
    Status status = load_mesh(&meshes[b], scene, &source, kept);
    if (status) return fail_at(status, scene, &def->mesh_place, "body", def->name);
  }
  int next = scene->body_count;
  for (int o = 0; o < scene->obstacle_count; o++) {
    const FemObstacleDef *def = &scene->obstacles[o];
    if (def->kind != FEM_OBSTACLE_MESH) continue;
    MeshSource source = {def->mesh_path,     def->box_size,   def->box_cells,
                         &def->mesh_options, &def->placement, FEM_ELEMENT_LINEAR};
    Status status = load_mesh(&meshes[next++], scene, &source, kept);
    if (status) return fail_at(status, scene, &def->mesh_place, "obstacle", def->name);
  }
  return STATUS_OK;
}

Status fem_scene_meshes_load(const FemSceneDef *scene, FemMesh *meshes) {
  KeptMesh *kept = memory_zeroed((size_t)(scene->body_count + scene->obstacle_count) + 1, sizeof *kept);
  if (!kept) return status_no_memory("the scene's meshes");
  Status status = load_each(scene, meshes, kept);
  for (KeptMesh *done = kept; done->path; done++) fem_mesh_destroy(&done->mesh);
  memory_free(kept);
  return status;
}
