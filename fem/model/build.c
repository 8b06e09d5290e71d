// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/build.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/model/division.h"
#include "fem/model/drivers.h"
#include "fem/model/floating.h"
#include "fem/model/parts.h"
#include "fem/model/work.h"
#include "fem/scene/meshes.h"
#include "fem/scene/obstacle.h"
#include "fem/scene/select.h"

static size_t count_materials(const FemSceneDef *scene) {
  size_t count = (size_t)scene->body_count;
  for (int b = 0; b < scene->body_count; b++) count += (size_t)scene->bodies[b].part_count;
  return count;
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
  model->quadratic_part = memory_zeroed(q, sizeof *model->quadratic_part);
  model->rest = memory_zeroed(3 * v, sizeof *model->rest);
  model->tets = memory_zeroed(t, sizeof *model->tets);
  model->tet_body = memory_zeroed(t, sizeof *model->tet_body);
  model->tet_part = memory_zeroed(t, sizeof *model->tet_part);
  model->volumes = memory_zeroed(t, sizeof *model->volumes);
  model->bodies = memory_zeroed((size_t)mesh_count, sizeof *model->bodies);
  model->parts = memory_zeroed(count_materials(model->scene), sizeof *model->parts);
  model->mass = memory_zeroed(v, sizeof *model->mass);
  model->initial_velocity = memory_zeroed(3 * v, sizeof *model->initial_velocity);
  model->is_prescribed = memory_zeroed(3 * v, sizeof *model->is_prescribed);
  bool ok = model->quadratics && model->quadratic_nodes && model->quadratic_part;
  ok = ok && model->rest && model->tets && model->tet_body && model->tet_part && model->volumes &&
       model->bodies && model->parts && model->mass && model->initial_velocity && model->is_prescribed;
  return ok ? STATUS_OK : status_no_memory("the model");
}

// Copies one mesh behind the others.
static void append_mesh(FemModel *model, FemModelBody *body, const FemMesh *mesh, int body_number) {
  memcpy(model->rest + 3 * body->vertex_begin, mesh->rest,
         3 * (size_t)mesh->vertex_count * sizeof *mesh->rest);
  for (int e = 0; e < mesh->tet_count; e++) {
    int global = body->tet_begin + e;
    for (int k = 0; k < 4; k++) model->tets[global][k] = mesh->tets[e][k] + body->vertex_begin;
    model->tet_body[global] = body_number;
    model->tet_part[global] = -1;
    model->volumes[global] = fem_model_element(model, global).volume;
  }
  for (int e = 0; e < mesh->quadratic_count; e++) {
    double nodes[3 * FEM_QUADRATIC_NODES];
    int global = body->quadratic_begin + e;
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++) {
      model->quadratic_nodes[global][k] = mesh->quadratic[e][k] + body->vertex_begin;
      memcpy(nodes + 3 * k, mesh->rest + 3 * mesh->quadratic[e][k], 3 * sizeof *nodes);
    }
    fem_quadratic_create_curved(&model->quadratics[global], nodes);
  }
}

void fem_model_lump(FemModel *model, const FemModelBody *body) {
  for (int e = body->quadratic_begin; e < body->quadratic_end; e++) {
    double mass = model->parts[model->quadratic_part[e]].material.density * model->quadratics[e].volume;
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++)
      model->mass[model->quadratic_nodes[e][k]] += fem_quadratic_mass_share(k) * mass;
  }
  if (body->element == FEM_ELEMENT_QUADRATIC) return;
  for (int e = body->tet_begin; e < body->tet_end; e++) {
    double share = 0.25 * model->parts[model->tet_part[e]].material.density * model->volumes[e];
    for (int k = 0; k < 4; k++) model->mass[model->tets[e][k]] += share;
  }
}

static void weigh(FemModel *model, FemModelBody *body) {
  const bool is_quadratic = body->element == FEM_ELEMENT_QUADRATIC;
  int begin = is_quadratic ? body->quadratic_begin : body->tet_begin;
  int end = is_quadratic ? body->quadratic_end : body->tet_end;
  for (int e = begin; e < end; e++) {
    FemModelPart *part = &model->parts[is_quadratic ? model->quadratic_part[e] : model->tet_part[e]];
    double volume = is_quadratic ? model->quadratics[e].volume : model->volumes[e];
    part->mass += part->material.density * volume;
    body->mass += part->material.density * volume;
  }
  fem_model_lump(model, body);
}

// v = velocity + spin × (x − centre of mass).
static void set_velocity(FemModel *model, const FemModelBody *body, const FemBodyDef *def) {
  Vec3 centre = fem_model_centre(model, body);
  for (int a = body->vertex_begin; a < body->vertex_end; a++) {
    Vec3 arm = vec3_sub(vec3_at(model->rest + 3 * a), centre);
    vec3_store(model->initial_velocity + 3 * a,
               vec3_add(vec3_at(def->velocity), vec3_cross(vec3_at(def->spin), arm)));
  }
}

static Status append_body(FemModel *model, FemModelBody *body, const FemMesh *mesh) {
  const FemBodyDef *def = &model->scene->bodies[body - model->bodies];
  body->name = def->name;
  body->element = def->element;
  TRY(fem_model_parts_append(model, (int)(body - model->bodies), mesh));
  weigh(model, body);
  set_velocity(model, body, def);
  return STATUS_OK;
}

static Status append_bodies(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  int vertex = 0, tet = 0, quadratic = 0, obstacle = 0;
  for (int b = 0; b < model->body_count; b++) {
    FemModelBody *body = &model->bodies[b];
    body->vertex_begin = vertex, body->vertex_end = vertex += meshes[b].vertex_count;
    body->tet_begin = tet, body->tet_end = tet += meshes[b].tet_count;
    body->quadratic_begin = quadratic, body->quadratic_end = quadratic += meshes[b].quadratic_count;
    append_mesh(model, body, &meshes[b], b);
    if (b < scene->body_count) {
      TRY(append_body(model, body, &meshes[b]));
    } else {
      while (scene->obstacles[obstacle].kind != FEM_OBSTACLE_MESH) obstacle++;
      body->name = scene->obstacles[obstacle++].name;
      body->is_obstacle = true;
    }
  }
  return STATUS_OK;
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
        return status_prefix(status, "%s: body '%s', loads[%d]",
                             fem_scene_where(scene, &def->select.place).text, scene->bodies[b].name, i);
      model->load_count++;
    }
  return STATUS_OK;
}

static Status add_probes(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  size_t most = 0;
  for (int b = 0; b < scene->body_count; b++) most += (size_t)scene->bodies[b].probe_count;
  model->probes = memory_zeroed(most, sizeof *model->probes);
  if (!model->probes) return status_no_memory("the probes");
  for (int b = 0; b < scene->body_count; b++)
    for (int i = 0; i < scene->bodies[b].probe_count; i++) {
      const FemProbeDef *def = &scene->bodies[b].probes[i];
      Status status = fem_probe_create(&model->probes[model->probe_count], def, &meshes[b], b,
                                       model->bodies[b].vertex_begin);
      if (status)
        return status_prefix(status, "%s: body '%s', probe '%s'",
                             fem_scene_where(scene, &def->select.place).text, scene->bodies[b].name,
                             def->name);
      model->probe_count++;
    }
  return STATUS_OK;
}

static Status check_name(const FemModel *model, const FemLineDef *def) {
  for (int l = 0; l < model->line_count; l++)
    if (strcmp(model->lines[l].def->name, def->name) == 0)
      return status_fail(STATUS_INPUT, "there is another line of that name; give it one of its own");
  return STATUS_OK;
}

static Status add_lines(FemModel *model, const FemMesh *meshes) {
  const FemSceneDef *scene = model->scene;
  size_t most = 0;
  for (int b = 0; b < scene->body_count; b++) most += (size_t)scene->bodies[b].line_count;
  model->lines = memory_zeroed(most, sizeof *model->lines);
  if (!model->lines) return status_no_memory("the lines");
  for (int b = 0; b < scene->body_count; b++)
    for (int i = 0; i < scene->bodies[b].line_count; i++) {
      const FemLineDef *def = &scene->bodies[b].lines[i];
      Status status = check_name(model, def);
      if (!status)
        status =
            fem_line_create(&model->lines[model->line_count], def, &meshes[b], model->bodies[b].tet_begin);
      if (status)
        return status_prefix(status, "%s: body '%s', line '%s'", fem_scene_where(scene, &def->place).text,
                             scene->bodies[b].name, def->name);
      model->line_count++;
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
        return status_prefix(status, "%s: body '%s', inner_faces[%d]",
                             fem_scene_where(scene, &select->place).text, scene->bodies[b].name, i);
      for (int v = 0; v < count; v++)
        model->inner[model->bodies[b].vertex_begin + vertices[v]] |= (unsigned char)(1 << i);
      memory_free(vertices);
    }
  return STATUS_OK;
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

static Status check_obstacles(const FemModel *model) {
  const FemSceneDef *scene = model->scene;
  for (int o = 0; o < scene->obstacle_count; o++) {
    const FemObstacleDef *def = &scene->obstacles[o];
    Status status = fem_obstacle_check(def, model->edge);
    if (status)
      return status_prefix(status, "%s: obstacle '%s'", fem_scene_where(scene, &def->place).text, def->name);
  }
  return STATUS_OK;
}

static Status build(FemModel *model, const FemMesh *meshes, int mesh_count) {
  TRY(allocate(model, meshes, mesh_count));
  TRY(append_bodies(model, meshes));
  TRY(fem_model_drivers_create(model, meshes));
  TRY(add_loads(model, meshes));
  TRY(mark_inner(model, meshes));
  TRY(fem_model_parts_measure(model));
  TRY(add_probes(model, meshes));
  TRY(add_lines(model, meshes));
  TRY(fem_model_divide(model));
  if (!model->share) TRY(fem_model_work_count(model));
  TRY(measure(model, meshes));
  return check_obstacles(model);
}

Status fem_model_create(FemModel *model, const FemSceneDef *scene) {
  *model = (FemModel){.scene = scene};
  if (scene->body_count < 1) return status_fail(STATUS_INPUT, "the scene has no bodies; give at least one");
  int mesh_count = scene->body_count;
  for (int o = 0; o < scene->obstacle_count; o++) mesh_count += scene->obstacles[o].kind == FEM_OBSTACLE_MESH;
  FemMesh *meshes = memory_zeroed((size_t)mesh_count, sizeof *meshes);
  if (!meshes) return status_no_memory("the meshes");
  Status status = fem_scene_meshes_load(scene, meshes);
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
  for (int i = 0; i < model->probe_count; i++) fem_probe_destroy(&model->probes[i]);
  memory_free(model->probes);
  for (int i = 0; i < model->line_count; i++) fem_line_destroy(&model->lines[i]);
  memory_free(model->lines);
  memory_free(model->rest);
  memory_free(model->tets);
  memory_free(model->tet_body);
  memory_free(model->tet_part);
  memory_free(model->volumes);
  memory_free(model->quadratics);
  memory_free(model->quadratic_nodes);
  memory_free(model->quadratic_part);
  memory_free(model->bodies);
  memory_free(model->parts);
  memory_free(model->mass);
  memory_free(model->initial_velocity);
  fem_model_start_destroy(model->start);
  memory_free(model->inner);
  memory_free(model->is_prescribed);
  fem_model_division_destroy(model);
  *model = (FemModel){0};
}
