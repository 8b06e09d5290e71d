// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/model.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/material/cofactor.h"
#include "fem/model/drive.h"
#include "fem/model/select.h"

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

// Reads or makes the mesh of a body or an obstacle and puts it in its place.
static Status load_mesh(FemMesh *mesh, const FemSceneDef *scene, const char *path, const double box_size[3],
                        const int box_cells[3], const FemMeshOptions *options, const FemPlacement *placement,
                        FemElementKind element, KeptMesh *kept) {
  TRY(path ? take_mesh(mesh, scene, path, options, kept) : fem_mesh_box(mesh, box_size, box_cells));
  TRY(fem_mesh_place(mesh, placement));
  if (element == FEM_ELEMENT_QUADRATIC) {
    Status status = fem_mesh_make_quadratic(mesh);
    return status && path ? status_prefix(status, "%s", path) : status;
  }
  return mesh->middles ? straighten(mesh, path) : STATUS_OK;
}

// The meshes of all bodies, then of the obstacles that have one. `meshes` has room for all, `kept` for one
// more.
static Status load_each(const FemSceneDef *scene, FemMesh *meshes, KeptMesh *kept) {
  for (int b = 0; b < scene->body_count; b++) {
    const FemBodyDef *def = &scene->bodies[b];
    Status status = load_mesh(&meshes[b], scene, def->mesh_path, def->box_size, def->box_cells,
                              &def->mesh_options, &def->placement, def->element, kept);
    if (status) return status_prefix(status, "body '%s'", def->name);
  }
  int next = scene->body_count;
  for (int o = 0; o < scene->obstacle_count; o++) {
    const FemObstacleDef *def = &scene->obstacles[o];
    if (def->kind != FEM_OBSTACLE_MESH) continue;
    Status status = load_mesh(&meshes[next++], scene, def->mesh_path, def->box_size, def->box_cells,
                              &def->mesh_options, &def->placement, FEM_ELEMENT_LINEAR, kept);
    if (status) return status_prefix(status, "obstacle '%s'", def->name);
  }
  return STATUS_OK;
}

static Status load_meshes(const FemSceneDef *scene, FemMesh *meshes) {
  KeptMesh *kept = memory_zeroed((size_t)(scene->body_count + scene->obstacle_count) + 1, sizeof *kept);
  if (!kept) return status_no_memory("the scene's meshes");
  Status status = load_each(scene, meshes, kept);
  for (KeptMesh *done = kept; done->path; done++) fem_mesh_destroy(&done->mesh);
  memory_free(kept);
  return status;
}

static Status allocate(FemModel *model, const FemMesh *meshes, int mesh_count) {
  long long vertices = 0, tets = 0, quadratics = 0;
  for (int m = 0; m < mesh_count; m++) {
    vertices += meshes[m].vertex_count, tets += meshes[m].tet_count;
    quadratics += meshes[m].quadratic_count;
  }
  if (vertices > 100000000 || tets > 300000000)
    return status_fail(STATUS_INPUT,
                       "the scene has %lld vertices and %lld tetrahedra; at most 1e8 and 3e8 are possible",
                       vertices, tets);
  size_t v = (size_t)vertices, t = (size_t)tets, q = (size_t)quadratics;
  model->vertex_count = (int)vertices, model->tet_count = (int)tets, model->body_count = mesh_count;
  model->quadratic_count = (int)quadratics;
  model->quadratics = memory_zeroed(q, sizeof *model->quadratics);
  model->quadratic_nodes = memory_zeroed(q, sizeof *model->quadratic_nodes);
  model->quadratic_body = memory_zeroed(q, sizeof *model->quadratic_body);
  model->rest = memory_zeroed(3 * v, sizeof *model->rest);
  model->tets = memory_zeroed(t, sizeof *model->tets);
  model->tet_body = memory_zeroed(t, sizeof *model->tet_body);
  model->elements = memory_zeroed(t, sizeof *model->elements);
  model->bodies = memory_zeroed((size_t)mesh_count, sizeof *model->bodies);
  model->mass = memory_zeroed(v, sizeof *model->mass);
  model->initial_velocity = memory_zeroed(3 * v, sizeof *model->initial_velocity);
  model->unknown_of_dof = memory_zeroed(3 * v, sizeof *model->unknown_of_dof);
  model->dof_of_unknown = memory_zeroed(3 * v, sizeof *model->dof_of_unknown);
  bool ok = model->quadratics && model->quadratic_nodes && model->quadratic_body;
  ok = ok && model->rest && model->tets && model->tet_body && model->elements && model->bodies &&
       model->mass && model->initial_velocity && model->unknown_of_dof && model->dof_of_unknown;
  return ok ? STATUS_OK : status_no_memory("the model");
}

// Copies one mesh behind the others.
static void append_mesh(FemModel *model, FemModelBody *body, const FemMesh *mesh, int body_number) {
  memcpy(model->rest + 3 * body->vertex_begin, mesh->rest,
         3 * (size_t)mesh->vertex_count * sizeof *mesh->rest);
  for (int e = 0; e < mesh->tet_count; e++) {
    double corners[12];
    int global = body->tet_begin + e;
    for (int k = 0; k < 4; k++) {
      model->tets[global][k] = mesh->tets[e][k] + body->vertex_begin;
      memcpy(corners + 3 * k, mesh->rest + 3 * mesh->tets[e][k], 3 * sizeof *corners);
    }
    model->tet_body[global] = body_number;
    fem_element_create(&model->elements[global], corners);
  }
  for (int e = 0; e < mesh->quadratic_count; e++) {
    double nodes[3 * FEM_QUADRATIC_NODES];
    int global = body->quadratic_begin + e;
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++) {
      model->quadratic_nodes[global][k] = mesh->quadratic[e][k] + body->vertex_begin;
      memcpy(nodes + 3 * k, mesh->rest + 3 * mesh->quadratic[e][k], 3 * sizeof *nodes);
    }
    model->quadratic_body[global] = body_number;
    fem_quadratic_create_curved(&model->quadratics[global], nodes);
  }
}

static void lump_quadratic_mass(FemModel *model, FemModelBody *body) {
  for (int e = body->quadratic_begin; e < body->quadratic_end; e++) {
    double mass = body->material.density * model->quadratics[e].volume;
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++)
      model->mass[model->quadratic_nodes[e][k]] += fem_quadratic_mass_share(k) * mass;
    body->mass += mass;
  }
}

static void lump_mass(FemModel *model, FemModelBody *body) {
  if (body->element == FEM_ELEMENT_QUADRATIC) {
    lump_quadratic_mass(model, body);
    return;
  }
  for (int e = body->tet_begin; e < body->tet_end; e++) {
    double share = 0.25 * body->material.density * model->elements[e].volume;
    for (int k = 0; k < 4; k++) model->mass[model->tets[e][k]] += share;
    body->mass += 4 * share;
  }
}

// v = velocity + spin × (x − centre of mass).
static void set_velocity(FemModel *model, const FemModelBody *body, const FemBodyDef *def) {
  Vec3 centre = {0, 0, 0};
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    centre = vec3_add(centre, vec3_scale(model->mass[a] / body->mass, vec3_at(model->rest + 3 * a)));
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * a), centre);
    vec3_store(model->initial_velocity + 3 * a,
               vec3_add(vec3_at(def->velocity), vec3_cross(vec3_at(def->spin), arm)));
  }
}

// λ_e / μ at most (fem/element/quadratic.h): that of ν = 1/3, so that materials up to there are integrated
// pointwise, which converges with the third order. Measured, a cantilever with two elements through its
// thickness at ν = 0.499, over the converged deflection: 0.94 with all of λ, 0.97 with 10, 0.98 with 4, 0.992
// with 2, 1.001 with 1.
static const double LARGEST_POINTWISE_RATIO = 2;

static void split_volume(FemModelBody *body) {
  FemLame lame = fem_material_lame(&body->material);
  double most = LARGEST_POINTWISE_RATIO * lame.mu;
  if (!(lame.lambda > most)) return;
  body->local = fem_material_with_lambda(&body->material, most);
  body->bulk = lame.lambda - fem_material_lame(&body->local).lambda;
}

static void append_bodies(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  int vertex = 0, tet = 0, quadratic = 0, obstacle = 0;
  for (int b = 0; b < model->body_count; b++) {
    FemModelBody *body = &model->bodies[b];
    body->vertex_begin = vertex, body->vertex_end = vertex += meshes[b].vertex_count;
    body->tet_begin = tet, body->tet_end = tet += meshes[b].tet_count;
    body->quadratic_begin = quadratic, body->quadratic_end = quadratic += meshes[b].quadratic_count;
    append_mesh(model, body, &meshes[b], b);
    if (b < scene->body_count) {
      const FemBodyDef *def = &scene->bodies[b];
      body->name = def->name;
      body->material = body->local = def->material;
      body->element = def->element;
      if (def->element == FEM_ELEMENT_NODAL) body->local = fem_material_local(&def->material);
      if (def->element == FEM_ELEMENT_QUADRATIC) split_volume(body);
      body->damping = def->material.damping >= 0 ? def->material.damping : scene->stiffness_damping;
      lump_mass(model, body);
      set_velocity(model, body, def);
    } else {
      while (scene->obstacles[obstacle].kind != FEM_OBSTACLE_MESH) obstacle++;
      body->name = scene->obstacles[obstacle++].name;
      body->is_obstacle = true;
    }
  }
}

// Makes the driver of one constraint and marks its coordinates by the driver's number + 1 in `owner`.
static Status add_driver(FemModel *model, const FemConstraintDef *def, const FemMesh *mesh,
                         const FemModelBody *body, int *owner) {
  int *vertices, count;
  TRY(fem_select_vertices(&def->select, mesh, &vertices, &count));
  FemModelDriver *driver = &model->drivers[model->driver_count++];
  *driver = (FemModelDriver){.def = def, .is_fixed = fem_drive_is_still(def)};
  driver->dofs = memory_zeroed(3 * (size_t)count, sizeof *driver->dofs);
  Status status = driver->dofs ? STATUS_OK : status_no_memory("the prescribed vertices");
  for (int i = 0; i < count && !status; i++)
    for (int c = 0; c < 3 && !status; c++) {
      if (!def->components[c]) continue;
      int dof = 3 * (body->vertex_begin + vertices[i]) + c;
      const FemModelDriver *other = owner[dof] ? &model->drivers[owner[dof] - 1] : NULL;
      if (other && !(other->is_fixed && driver->is_fixed && other->def->release == def->release)) {
        const double *p = model->rest + (dof - c);
        status =
            status_fail(STATUS_INPUT,
                        "vertex %d at (%g, %g, %g) is prescribed twice in %c, by two selections that differ; "
                        "make the selections disjoint or name their components",
                        vertices[i], p[0], p[1], p[2], "xyz"[c]);
        break;
      }
      owner[dof] = model->driver_count;
      if (!other) driver->dofs[driver->dof_count++] = dof;
    }
  memory_free(vertices);
  return status;
}

static Status add_drivers_of_body(FemModel *model, int b, const FemMesh *mesh, int *owner) {
  const FemBodyDef *def = &model->scene->bodies[b];
  for (int kind = 0; kind < 2; kind++) {
    const FemConstraintDef *list = kind == 0 ? def->fixed : def->driven;
    int count = kind == 0 ? def->fixed_count : def->driven_count;
    for (int i = 0; i < count; i++) {
      Status status = add_driver(model, &list[i], mesh, &model->bodies[b], owner);
      if (status)
        return status_prefix(status, "%s:%d:%d: body '%s', %s[%d]",
                             model->scene->path ? model->scene->path : "scene", list[i].select.place.line,
                             list[i].select.place.column, def->name, kind == 0 ? "fixed" : "driven", i);
    }
  }
  return STATUS_OK;
}

static Status add_drivers(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  size_t most = (size_t)scene->obstacle_count;
  for (int b = 0; b < scene->body_count; b++)
    most += (size_t)scene->bodies[b].fixed_count + (size_t)scene->bodies[b].driven_count;
  int *owner = memory_zeroed(3 * (size_t)model->vertex_count, sizeof *owner);
  model->drivers = memory_zeroed(most, sizeof *model->drivers);
  Status status = owner && model->drivers ? STATUS_OK : status_no_memory("the prescribed vertices");
  for (int b = 0; b < scene->body_count && !status; b++)
    status = add_drivers_of_body(model, b, &meshes[b], owner);
  int body = scene->body_count;
  for (int o = 0; o < scene->obstacle_count && !status; o++) {
    if (scene->obstacles[o].kind != FEM_OBSTACLE_MESH) continue;
    status = add_driver(model, &scene->obstacles[o].motion, &meshes[body], &model->bodies[body], owner);
    body++;
  }
  memory_free(owner);
  return status;
}

static Status add_loads(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  size_t most = 0;
  for (int b = 0; b < scene->body_count; b++) most += (size_t)scene->bodies[b].load_count;
  model->loads = memory_zeroed(most, sizeof *model->loads);
  if (!model->loads) return status_no_memory("the loads");
  for (int b = 0; b < scene->body_count; b++)
    for (int i = 0; i < scene->bodies[b].load_count; i++) {
      const FemLoadDef *def = &scene->bodies[b].loads[i];
      Status status =
          fem_load_create(&model->loads[model->load_count], def, &meshes[b], model->bodies[b].vertex_begin);
      if (status)
        return status_prefix(status, "%s:%d:%d: body '%s', loads[%d]", scene->path ? scene->path : "scene",
                             def->select.place.line, def->select.place.column, scene->bodies[b].name, i);
      model->load_count++;
    }
  return STATUS_OK;
}

static Status mark_inner(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  model->inner = memory_zeroed((size_t)model->vertex_count, 1);
  if (!model->inner) return status_no_memory("the inner faces");
  for (int b = 0; b < scene->body_count; b++)
    for (int i = 0; i < scene->bodies[b].inner_count; i++) {
      const FemSelectDef *select = &scene->bodies[b].inner[i].select;
      int *vertices, count;
      Status status = i < FEM_MAX_INNER
                          ? fem_select_vertices(select, &meshes[b], &vertices, &count)
                          : status_fail(STATUS_INPUT, "one too many; %d at most", FEM_MAX_INNER);
      if (status)
        return status_prefix(status, "%s:%d:%d: body '%s', inner_faces[%d]",
                             scene->path ? scene->path : "scene", select->place.line, select->place.column,
                             scene->bodies[b].name, i);
      for (int v = 0; v < count; v++)
        model->inner[model->bodies[b].vertex_begin + vertices[v]] |= (unsigned char)(1 << i);
      memory_free(vertices);
    }
  return STATUS_OK;
}

void fem_model_number(FemModel *model) {
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) model->unknown_of_dof[dof] = 0;
  for (int d = 0; d < model->driver_count; d++)
    for (int i = 0; i < model->drivers[d].dof_count && !model->drivers[d].is_released; i++)
      model->unknown_of_dof[model->drivers[d].dofs[i]] = -1;
  for (int b = 0; b < model->body_count; b++)
    for (int v = model->bodies[b].vertex_begin; v < model->bodies[b].vertex_end && model->bodies[b].is_held;
         v++)
      for (int c = 0; c < 3; c++) model->unknown_of_dof[3 * v + c] = -1;
  int n = 0;
  for (int dof = 0; dof < 3 * model->vertex_count; dof++) {
    if (model->unknown_of_dof[dof] < 0) continue;
    model->unknown_of_dof[dof] = n;
    model->dof_of_unknown[n++] = dof;
  }
  model->unknown_count = n;
}

static Status measure(FemModel *model, const FemMesh *meshes) {
  model->length = model->edge = INFINITY;
  for (int b = 0; b < model->scene->body_count; b++) {
    FemMeshQuality quality;
    TRY(fem_mesh_quality(&meshes[b], &quality));
    double diagonal = vec3_length(vec3_sub(vec3_at(quality.box_max), vec3_at(quality.box_min)));
    model->length = fmin(model->length, diagonal);
    model->edge = fmin(model->edge, quality.mean_edge);
  }
  return STATUS_OK;
}

// Those that share a middle share its edge's ends: their corners tell.
static Status colour_quadratics(FemModel *model) {
  int(*corners)[4] = memory_zeroed((size_t)model->quadratic_count, sizeof *corners);
  if (!corners) return status_no_memory("the colouring of the mesh");
  for (int e = 0; e < model->quadratic_count; e++)
    memcpy(corners[e], model->quadratic_nodes[e], sizeof corners[e]);
  Status status = fem_colouring_create(&model->quadratic_colouring, model->vertex_count,
                                       (const int(*)[4])corners, model->quadratic_count);
  memory_free(corners);
  return status;
}

static Status build(FemModel *model, const FemMesh *meshes, int mesh_count) {
  TRY(allocate(model, meshes, mesh_count));
  append_bodies(model, meshes);
  TRY(add_drivers(model, meshes));
  TRY(add_loads(model, meshes));
  TRY(mark_inner(model, meshes));
  fem_model_number(model);
  int elastic_tets = model->bodies[model->scene->body_count - 1].tet_end;
  TRY(fem_colouring_create(&model->colouring, model->vertex_count, (const int(*)[4])model->tets,
                           elastic_tets));
  TRY(colour_quadratics(model));
  return measure(model, meshes);
}

Status fem_model_create(FemModel *model, const FemSceneDef *scene) {
  *model = (FemModel){.scene = scene};
  if (scene->body_count < 1) return status_fail(STATUS_INPUT, "the scene has no bodies; give at least one");
  int mesh_count = scene->body_count;
  for (int o = 0; o < scene->obstacle_count; o++) mesh_count += scene->obstacles[o].kind == FEM_OBSTACLE_MESH;
  FemMesh *meshes = memory_zeroed((size_t)mesh_count, sizeof *meshes);
  if (!meshes) return status_no_memory("the meshes");
  Status status = load_meshes(scene, meshes);
  if (!status) status = build(model, meshes, mesh_count);
  for (int m = 0; m < mesh_count; m++) fem_mesh_destroy(&meshes[m]);
  memory_free(meshes);
  if (status) fem_model_destroy(model);
  return status;
}

void fem_model_destroy(FemModel *model) {
  for (int d = 0; d < model->driver_count; d++) memory_free(model->drivers[d].dofs);
  memory_free(model->drivers);
  for (int i = 0; i < model->load_count; i++) fem_load_destroy(&model->loads[i]);
  memory_free(model->loads);
  memory_free(model->rest);
  memory_free(model->tets);
  memory_free(model->tet_body);
  memory_free(model->elements);
  memory_free(model->quadratics);
  memory_free(model->quadratic_nodes);
  memory_free(model->quadratic_body);
  fem_colouring_destroy(&model->quadratic_colouring);
  memory_free(model->bodies);
  memory_free(model->mass);
  memory_free(model->initial_velocity);
  memory_free(model->inner);
  memory_free(model->unknown_of_dof);
  memory_free(model->dof_of_unknown);
  fem_colouring_destroy(&model->colouring);
  *model = (FemModel){0};
}

Status fem_model_copy_numbering(FemModel *copy, const FemModel *model) {
  size_t dofs = 3 * (size_t)model->vertex_count;
  *copy = *model;
  copy->bodies = memory_copy(model->bodies, (size_t)model->body_count, sizeof *model->bodies);
  copy->drivers = memory_copy(model->drivers, (size_t)model->driver_count, sizeof *model->drivers);
  copy->unknown_of_dof = memory_copy(model->unknown_of_dof, dofs, sizeof *model->unknown_of_dof);
  copy->dof_of_unknown = memory_copy(model->dof_of_unknown, dofs, sizeof *model->dof_of_unknown);
  if (copy->bodies && copy->drivers && copy->unknown_of_dof && copy->dof_of_unknown) return STATUS_OK;
  fem_model_destroy_copy(copy);
  return status_no_memory("the numbering of the unknowns");
}

void fem_model_destroy_copy(FemModel *copy) {
  memory_free(copy->bodies);
  memory_free(copy->drivers);
  memory_free(copy->unknown_of_dof);
  memory_free(copy->dof_of_unknown);
  *copy = (FemModel){0};
}

double fem_model_next_release(const FemModel *model, double time) {
  double next = INFINITY;
  for (int d = 0; d < model->driver_count; d++) {
    double release = model->drivers[d].def->release;
    if (release > time) next = fmin(next, release);
  }
  return next;
}

void fem_model_release(FemModel *model, double time) {
  for (int d = 0; d < model->driver_count; d++) {
    double release = model->drivers[d].def->release;
    if (release > 0 && release <= time) model->drivers[d].is_released = true;
  }
  fem_model_number(model);
}

void fem_model_drive(const FemModel *model, double time, double *positions, double *velocities) {
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count && !driver->is_released; i++) {
      int dof = driver->dofs[i];
      double position[3], velocity[3];
      if (driver->is_fixed) {
        positions[dof] = model->rest[dof];
        velocities[dof] = 0;
        continue;
      }
      fem_drive_point(driver->def, time, model->rest + (dof - dof % 3), position, velocity);
      positions[dof] = position[dof % 3];
      velocities[dof] = velocity[dof % 3];
    }
  }
}

const char *fem_model_body_name(const FemModel *model, int vertex) {
  for (int b = 0; b < model->body_count; b++)
    if (vertex < model->bodies[b].vertex_end) return model->bodies[b].name ? model->bodies[b].name : "?";
  return "?";
}

double fem_model_contact_stiffness(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  if (contact->stiffness > 0) return contact->stiffness;
  double softest = INFINITY, smallest_element = INFINITY;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    softest = fmin(softest, body->material.young);
    double volume = body->mass / body->material.density;
    smallest_element = fmin(smallest_element, volume / (body->tet_end - body->tet_begin));
  }
  return contact->potential == CONTACT_POTENTIAL_BODY ? softest / smallest_element : softest;
}

bool fem_model_has_linear_materials(const FemModel *model) {
  for (int b = 0; b < model->scene->body_count; b++)
    if (!fem_material_is_linear(&model->bodies[b].material)) return false;
  return true;
}

// What sticks moves by less than ε, which an integrator that tolerates more than a few ε does not see.
// Measured on a block that slides on a block: at 1, 2 and 7 ε as good, at 23 ε four times the steps.
static const double FRICTION_RESOLUTION = 5;

// Of the slowest wave's speed. An impact's waves carry the speed of the impact, hundredths of that: at 1 a
// ball at 0.5 m/s loses 13 % of its energy in a contact, at 0.1 0.3 %, at 0.03 0.1 % (docs/time.md).
static const double VELOCITY_SHARE = 0.03;
// Where a body rubs on itself normals jump from step to step, and a fine tolerance follows every jump: a fold
// of 180 tetrahedra stalls at 0.3 and below.
static const double VELOCITY_SHARE_OF_SELF_FRICTION = 1;

// How far what sticks may creep in a whole run, as a share of the smallest body.
static const double CREEP = 1e-3;

double fem_model_slip_speed(const FemModel *model) {
  double given = model->scene->contact.slip_speed;
  return given > 0 ? given : CREEP * model->length / model->scene->end;
}

static bool has_self_friction(const FemSceneDef *scene) {
  bool is_wanted = false;
  for (int b = 0; b < scene->body_count; b++) is_wanted = is_wanted || scene->bodies[b].self_contact;
  return is_wanted && scene->contact.friction > 0;
}

double fem_model_velocity_tolerance(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  if (scene->velocity_tolerance > 0) return scene->velocity_tolerance;
  double slowest = INFINITY;
  for (int b = 0; b < scene->body_count; b++)
    slowest = fmin(slowest, sqrt(scene->bodies[b].material.young / scene->bodies[b].material.density));
  double share = has_self_friction(scene) ? VELOCITY_SHARE_OF_SELF_FRICTION : VELOCITY_SHARE;
  double chosen = share * scene->tolerance * slowest;
  bool creeps = fem_scene_most_friction(&scene->contact) > 0 &&
                fem_scene_friction_law(&scene->contact) == FEM_FRICTION_VELOCITY;
  return creeps ? fmin(chosen, FRICTION_RESOLUTION * fem_model_slip_speed(model)) : chosen;
}

static const FemModelBody *body_of(const FemModel *model, int tet) {
  return &model->bodies[model->tet_body[tet]];
}

static void gather(const int *nodes, int count, const double *positions, double *x) {
  for (int k = 0; k < count; k++) memcpy(x + 3 * k, positions + 3 * (size_t)nodes[k], 3 * sizeof *x);
}

// The quadratic tetrahedron of which `tet` is a part.
static int quadratic_of(const FemModel *model, int tet) {
  const FemModelBody *body = body_of(model, tet);
  return body->quadratic_begin + (tet - body->tet_begin) / FEM_QUADRATIC_PARTS;
}

double fem_model_det(const FemModel *model, int tet, const double *positions) {
  const FemModelBody *body = body_of(model, tet);
  int part = (tet - body->tet_begin) % FEM_QUADRATIC_PARTS;
  double x[30], F[9];
  gather(model->tets[tet], 4, positions, x);
  fem_element_deformation(&model->elements[tet], x, F);
  double own = fem_cofactor_det(F);
  if (body->element != FEM_ELEMENT_QUADRATIC || part >= FEM_QUADRATIC_POINTS) return own;
  int quadratic = quadratic_of(model, tet);
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  double at_point = fem_quadratic_det(&model->quadratics[quadratic], part, x);
  return at_point < own ? at_point : own;
}

void fem_model_stress(const FemModel *model, int tet, const double *positions, double stress[6]) {
  const FemModelBody *body = body_of(model, tet);
  double x[30];
  if (body->element != FEM_ELEMENT_QUADRATIC) {
    gather(model->tets[tet], 4, positions, x);
    fem_element_cauchy(&model->elements[tet], &body->local, x, stress);
    return;
  }
  int quadratic = quadratic_of(model, tet);
  FemQuadraticLaw law = {&body->local, body->bulk};
  gather(model->quadratic_nodes[quadratic], FEM_QUADRATIC_NODES, positions, x);
  fem_quadratic_cauchy(&model->quadratics[quadratic], law, x, (tet - body->tet_begin) % FEM_QUADRATIC_PARTS,
                       stress);
}

// A body rings with periods of the time that a wave takes through it and back; some periods, and calm is no
// turning point.
static const double REST_CROSSINGS = 20;

double fem_model_rest_time(const FemModel *model) {
  double given = model->scene->contact.rest_time, longest = 0;
  if (given > 0) return given;
  for (int b = 0; b < model->scene->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    double diagonal = sqrt(3) * cbrt(body->mass / body->material.density);
    longest = fmax(longest, diagonal / sqrt(body->material.young / body->material.density));
  }
  return REST_CROSSINGS * longest;
}

// A body that is wrong by the tolerance after a wave has run through it.
double fem_model_rest_speed(const FemModel *model) {
  double given = model->scene->contact.rest_speed;
  double slowest = INFINITY;
  if (given > 0) return given;
  for (int b = 0; b < model->scene->body_count; b++)
    slowest = fmin(slowest, sqrt(model->bodies[b].material.young / model->bodies[b].material.density));
  return model->scene->tolerance * slowest;
}

// Less would be asked in vain: the integrator's own errors accelerate a body that lies still by some
// hundredths of a tolerance's speed in the time of a crossing.
static const double REST_ACCELERATION = 5; // speeds in the time it is watched

double fem_model_rest_acceleration(const FemModel *model) {
  double given = model->scene->contact.rest_acceleration;
  return given > 0 ? given : REST_ACCELERATION * fem_model_rest_speed(model) / fem_model_rest_time(model);
}

double fem_model_memory_estimate(const FemModel *model) {
  double vertices = model->vertex_count, tets = model->tet_count, unknowns = model->unknown_count;
  double arrays = vertices * 30 * sizeof(double) + tets * (sizeof(FemElement) + 600);
  arrays += model->quadratic_count * (double)(sizeof(FemQuadratic) + 465 * sizeof(int));
  double matrix = unknowns * 23 * (sizeof(double) + sizeof(int));
  // Nested dissection in three dimensions: O(n^{4/3}) factor entries (George 1973); the constant is measured.
  double factor = 12 * pow(unknowns, 4.0 / 3.0) * sizeof(double);
  return 3e7 + arrays + matrix + factor;
}
