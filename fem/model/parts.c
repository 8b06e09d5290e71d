// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/parts.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/mesh/faces.h"
#include "fem/scene/select.h"

// ---- Which element is in which.

static void split_volume(FemModelPart *part) {
  FemLame lame = fem_material_lame(&part->material);
  double most = FEM_QUADRATIC_LARGEST_RATIO * lame.mu;
  if (!(lame.lambda > most)) return;
  part->local = fem_material_with_lambda(&part->material, most);
  part->bulk = lame.lambda - fem_material_lame(&part->local).lambda;
}

static FemModelPart part_of(const FemModel *model, int body, int item) {
  const FemBodyDef *def = &model->scene->bodies[body];
  const FemMaterial *material = fem_scene_material(def, item + 1);
  FemModelPart part = {.body = body, .item = item, .material = *material, .local = *material};
  if (def->element == FEM_ELEMENT_NODAL) part.local = fem_material_local(material);
  if (def->element == FEM_ELEMENT_QUADRATIC) split_volume(&part);
  part.damping = material->damping >= 0 ? material->damping : model->scene->stiffness_damping;
  return part;
}

static int element_count_of(const FemMesh *mesh) {
  return mesh->quadratic ? mesh->quadratic_count : mesh->tet_count;
}

// Marks the elements of an entry; `items` by element, −1: of none so far.
static Status mark_item(const FemModel *model, const FemBodyDef *def, int item, const FemMesh *mesh,
                        int *items) {
  const FemSelectDef *select = &def->parts[item].select;
  int *elements, count, twice = -1;
  Status status = fem_select_elements(select, mesh, &elements, &count);
  for (int k = 0; k < count && !status; k++) {
    if (items[elements[k]] >= 0 && twice < 0) twice = elements[k];
    if (twice < 0) items[elements[k]] = item;
  }
  memory_free(elements);
  if (twice >= 0)
    status = status_fail(STATUS_INPUT, "tetrahedron %d is in materials[%d], too: let selections not overlap",
                         twice, items[twice]);
  return status ? status_prefix(status, "%s: body '%s', materials[%d]",
                                fem_scene_where(model->scene, &select->place).text, def->name, item)
                : STATUS_OK;
}

static Status check_rest(const FemModel *model, const FemBodyDef *def, const FemMesh *mesh, const int *items,
                         bool *has_rest) {
  int rest = 0, all = element_count_of(mesh);
  for (int e = 0; e < all; e++) rest += items[e] < 0;
  *has_rest = rest > 0;
  if (rest == 0 || def->material.young > 0) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "%s: body '%s': %d of %d tetrahedra are in none of its materials; give it a `material`, "
                     "which is that of the rest",
                     fem_scene_where(model->scene, &def->place).text, def->name, rest, all);
}

// `part_of_item` by item + 1.
static void take_parts(FemModel *model, int body, const int *items, const int *part_of_item) {
  const FemModelBody *own = &model->bodies[body];
  for (int e = own->quadratic_begin; e < own->quadratic_end; e++)
    model->quadratic_part[e] = part_of_item[items[e - own->quadratic_begin] + 1];
  bool is_quadratic = own->quadratic_end > own->quadratic_begin;
  for (int e = own->tet_begin; e < own->tet_end; e++) {
    int element = (e - own->tet_begin) / (is_quadratic ? FEM_QUADRATIC_PARTS : 1);
    model->tet_part[e] = part_of_item[items[element] + 1];
  }
}

static Status list_parts(FemModel *model, int body, const FemMesh *mesh, int *items, int *part_of_item) {
  const FemBodyDef *def = &model->scene->bodies[body];
  bool has_rest;
  for (int e = 0; e < element_count_of(mesh); e++) items[e] = -1;
  for (int i = 0; i < def->part_count; i++) TRY(mark_item(model, def, i, mesh, items));
  TRY(check_rest(model, def, mesh, items, &has_rest));
  model->bodies[body].part_begin = model->part_count;
  for (int item = has_rest ? -1 : 0; item < def->part_count; item++) {
    part_of_item[item + 1] = model->part_count;
    model->parts[model->part_count++] = part_of(model, body, item);
  }
  model->bodies[body].part_end = model->part_count;
  take_parts(model, body, items, part_of_item);
  return STATUS_OK;
}

Status fem_model_parts_append(FemModel *model, int body, const FemMesh *mesh) {
  int *items = memory_zeroed((size_t)element_count_of(mesh), sizeof *items);
  int *part_of_item = memory_zeroed((size_t)model->scene->bodies[body].part_count + 1, sizeof *part_of_item);
  Status status = items && part_of_item ? list_parts(model, body, mesh, items, part_of_item)
                                        : status_no_memory("a body's materials");
  memory_free(items), memory_free(part_of_item);
  return status;
}

// ---- How much of the surface they are.

static double area_of(const FemModel *model, const FemMeshFace *face) {
  const int *v = face->vertices;
  if (model->inner[v[0]] & model->inner[v[1]] & model->inner[v[2]]) return 0;
  Vec3 a = vec3_at(model->rest + 3 * (size_t)v[0]);
  return 0.5 * vec3_length(vec3_cross(vec3_sub(vec3_at(model->rest + 3 * (size_t)v[1]), a),
                                      vec3_sub(vec3_at(model->rest + 3 * (size_t)v[2]), a)));
}

static Status measure_skin(FemModel *model, const FemModelBody *body) {
  FemMeshFace *faces;
  int count = 4 * (body->tet_end - body->tet_begin);
  TRY(fem_mesh_faces_list(&faces, model->vertex_count, count / 4,
                          (const int(*)[4])(model->tets + body->tet_begin)));
  for (int begin = 0, end; begin < count; begin = end) {
    end = fem_mesh_faces_end(faces, count, begin);
    if (end == begin + 1)
      model->parts[model->tet_part[body->tet_begin + faces[begin].tet]].skin += area_of(model, &faces[begin]);
  }
  memory_free(faces);
  return STATUS_OK;
}

Status fem_model_parts_measure(FemModel *model) {
  for (int b = 0; b < model->body_count; b++)
    if (model->bodies[b].part_end > model->bodies[b].part_begin + 1)
      TRY(measure_skin(model, &model->bodies[b]));
  return STATUS_OK;
}

// ---- What they are together.

static double volume_of(const FemModelPart *part) {
  return part->mass / part->material.density;
}

double fem_model_parts_volume(const FemModel *model, int body) {
  double sum = 0;
  for (int p = model->bodies[body].part_begin; p < model->bodies[body].part_end; p++)
    sum += volume_of(&model->parts[p]);
  return sum;
}

void fem_model_parts_spread(const FemModel *model, int part, double *volumes) {
  const FemModelBody *body = &model->bodies[model->parts[part].body];
  memset(volumes, 0, (size_t)model->vertex_count * sizeof *volumes);
  for (int e = body->quadratic_begin; e < body->quadratic_end; e++)
    for (int k = 0; k < FEM_QUADRATIC_NODES && model->quadratic_part[e] == part; k++)
      volumes[model->quadratic_nodes[e][k]] += fem_quadratic_mass_share(k) * model->quadratics[e].volume;
  if (body->element == FEM_ELEMENT_QUADRATIC) return;
  for (int e = body->tet_begin; e < body->tet_end; e++)
    for (int k = 0; k < 4 && model->tet_part[e] == part; k++)
      volumes[model->tets[e][k]] += 0.25 * model->volumes[e];
}

// Of one part it is that part's, to the last bit.
static double mean_of(const FemModel *model, int body, FemModelPartValue *value, bool of_surface) {
  int begin = model->bodies[body].part_begin, end = model->bodies[body].part_end;
  double sum = 0, all = 0;
  if (end == begin + 1) return value(&model->parts[begin].material);
  for (int p = begin; p < end; p++) {
    double weight = of_surface ? model->parts[p].skin : volume_of(&model->parts[p]);
    sum += weight * value(&model->parts[p].material);
    all += weight;
  }
  return all > 0 ? sum / all : mean_of(model, body, value, false);
}

double fem_model_parts_mean(const FemModel *model, int body, FemModelPartValue *value) {
  return mean_of(model, body, value, false);
}

double fem_model_parts_surface_mean(const FemModel *model, int body, FemModelPartValue *value) {
  return mean_of(model, body, value, true);
}

double fem_model_parts_least(const FemModel *model, int body, FemModelPartValue *value) {
  double least = INFINITY;
  for (int p = model->bodies[body].part_begin; p < model->bodies[body].part_end; p++)
    least = fmin(least, value(&model->parts[p].material));
  return least;
}
