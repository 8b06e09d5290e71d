// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/elements/volume.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

// λ − λ_e ≥ 0.
static double stiffness_of(const FemModelPart *part) {
  return fmax(fem_material_lame(&part->material).lambda - fem_material_lame(&part->local).lambda, 0);
}

// Of a tetrahedron of the model.
static const FemModelPart *part_of(const FemVolume *volume, int tet) {
  return &volume->model->parts[volume->model->tet_part[tet]];
}

static bool is_nodal(const FemModelBody *body) {
  return body->element == FEM_ELEMENT_NODAL && !body->is_obstacle;
}

static size_t count_tets(const FemModel *model) {
  int count = 0;
  for (int b = 0; b < model->body_count; b++)
    if (is_nodal(&model->bodies[b])) count += model->bodies[b].tet_end - model->bodies[b].tet_begin;
  return (size_t)count;
}

static Status list_elements(FemVolume *volume) {
  const FemModel *model = volume->model;
  size_t tets = count_tets(model);
  volume->tets = memory_zeroed(tets, sizeof *volume->tets);
  volume->elements = memory_zeroed(tets, sizeof *volume->elements);
  volume->index = memory_zeroed((size_t)model->tet_count, sizeof *volume->index);
  volume->corners = memory_zeroed(tets, sizeof *volume->corners);
  volume->place = memory_zeroed((size_t)model->vertex_count, sizeof *volume->place);
  if (!volume->tets || !volume->elements || !volume->index || !volume->corners || !volume->place)
    return status_no_memory("the vertices' volumes");
  for (int b = 0; b < model->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    for (int e = body->tet_begin; e < body->tet_end && is_nodal(body); e++) {
      volume->elements[volume->tet_count] = fem_model_element(model, e);
      volume->index[e] = volume->tet_count;
      volume->tets[volume->tet_count++] = e;
    }
  }
  return STATUS_OK;
}

// Numbers the vertices of one part in their order; `place` is −1 at the others.
static void number_vertices(FemVolume *volume, int part) {
  const FemModel *model = volume->model;
  const FemModelBody *body = &model->bodies[model->parts[part].body];
  for (int a = body->vertex_begin; a < body->vertex_end; a++) volume->place[a] = -1;
  for (int e = body->tet_begin; e < body->tet_end; e++)
    for (int k = 0; k < 4 && model->tet_part[e] == part; k++) volume->place[model->tets[e][k]] = 0;
  for (int a = body->vertex_begin; a < body->vertex_end; a++)
    if (volume->place[a] == 0) volume->place[a] = volume->vertex_count++;
  for (int e = body->tet_begin; e < body->tet_end; e++)
    for (int k = 0; k < 4 && model->tet_part[e] == part; k++)
      volume->corners[volume->index[e]][k] = volume->place[model->tets[e][k]];
}

static Status list_vertices(FemVolume *volume) {
  const FemModel *model = volume->model;
  for (int p = 0; p < model->part_count; p++)
    if (is_nodal(&model->bodies[model->parts[p].body])) number_vertices(volume, p);
  size_t vertices = (size_t)volume->vertex_count;
  volume->parts = memory_zeroed(vertices, sizeof *volume->parts);
  volume->vertex_volume = memory_zeroed(vertices, sizeof *volume->vertex_volume);
  volume->vertex_theta = memory_zeroed(vertices, sizeof *volume->vertex_theta);
  if (!volume->parts || !volume->vertex_volume || !volume->vertex_theta)
    return status_no_memory("the vertices' volumes");
  for (int i = 0; i < volume->tet_count; i++)
    for (int k = 0; k < 4; k++) {
      volume->vertex_volume[volume->corners[i][k]] += 0.25 * model->volumes[volume->tets[i]];
      volume->parts[volume->corners[i][k]] = model->tet_part[volume->tets[i]];
    }
  return STATUS_OK;
}

// Which tetrahedra are around each vertex.
static Status list_tets(FemVolume *volume) {
  size_t count = (size_t)volume->vertex_count;
  int *begin = volume->tet_begin = memory_zeroed(count + 1, sizeof *begin);
  volume->tet_list = memory_zeroed(4 * (size_t)volume->tet_count, sizeof *volume->tet_list);
  int *filled = memory_zeroed(count, sizeof *filled);
  bool is_ok = begin && volume->tet_list && filled;
  for (int i = 0; is_ok && i < volume->tet_count; i++)
    for (int k = 0; k < 4; k++) begin[volume->corners[i][k] + 1]++;
  for (size_t i = 0; is_ok && i < count; i++) begin[i + 1] += begin[i];
  for (int i = 0; is_ok && i < volume->tet_count; i++)
    for (int k = 0; k < 4; k++) {
      int a = volume->corners[i][k];
      volume->tet_list[begin[a] + filled[a]++] = i;
    }
  memory_free(filled);
  return is_ok ? STATUS_OK : status_no_memory("the vertices' volumes");
}

// The distinct vertices of the tetrahedra around each vertex.
static Status list_patches(FemVolume *volume) {
  const FemModel *model = volume->model;
  size_t capacity = 0;
  int total = 0, largest = 0;
  volume->patch_begin = memory_zeroed((size_t)volume->vertex_count + 1, sizeof *volume->patch_begin);
  if (!volume->patch_begin) return status_no_memory("the vertices' volumes");
  for (int a = 0; a < model->vertex_count; a++) volume->place[a] = -1; // the patch that had it last
  for (int i = 0; i < volume->vertex_count; i++) {
    int around = volume->tet_begin[i + 1] - volume->tet_begin[i];
    if (!memory_reserve((void **)&volume->patch_list, &capacity, (size_t)total + 4 * (size_t)around,
                        sizeof *volume->patch_list))
      return status_no_memory("the vertices' volumes");
    for (int t = volume->tet_begin[i]; t < volume->tet_begin[i + 1]; t++)
      for (int k = 0; k < 4; k++) {
        int a = model->tets[volume->tets[volume->tet_list[t]]][k];
        if (volume->place[a] == i) continue;
        volume->place[a] = i;
        volume->patch_list[total++] = a;
      }
    volume->patch_begin[i + 1] = total;
    int size = total - volume->patch_begin[i];
    largest = size > largest ? size : largest;
  }
  volume->row = memory_zeroed(3 * (size_t)largest, sizeof *volume->row);
  volume->tet_theta = memory_zeroed((size_t)volume->tet_count, sizeof *volume->tet_theta);
  volume->tet_gradient = memory_zeroed((size_t)volume->tet_count, 12 * sizeof *volume->tet_gradient);
  bool is_ok = volume->row && volume->tet_theta && volume->tet_gradient;
  return is_ok ? STATUS_OK : status_no_memory("the vertices' volumes");
}

static Status create(FemVolume *volume) {
  TRY(list_elements(volume));
  TRY(list_vertices(volume));
  TRY(list_tets(volume));
  return list_patches(volume);
}

Status fem_volume_create(FemVolume *volume, const FemModel *model) {
  *volume = (FemVolume){.model = model};
  Status status = create(volume);
  if (status) fem_volume_destroy(volume);
  return status;
}

void fem_volume_destroy(FemVolume *volume) {
  void *arrays[] = {volume->tets,         volume->elements,      volume->index,     volume->parts,
                    volume->corners,      volume->tet_begin,     volume->tet_list,  volume->patch_begin,
                    volume->patch_list,   volume->vertex_volume, volume->tet_theta, volume->vertex_theta,
                    volume->tet_gradient, volume->row,           volume->place};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *volume = (FemVolume){0};
}

size_t fem_volume_bytes(const FemVolume *volume) {
  const void *const arrays[] = {volume->tets,          volume->elements,    volume->index,
                                volume->parts,         volume->corners,     volume->tet_begin,
                                volume->tet_list,      volume->patch_begin, volume->patch_list,
                                volume->vertex_volume, volume->tet_theta,   volume->vertex_theta,
                                volume->tet_gradient,  volume->row,         volume->place};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

Status fem_volume_couple(const FemVolume *volume, FemPattern *pattern, int *has_grown) {
  for (int i = 0; i < volume->vertex_count; i++) {
    int begin = volume->patch_begin[i], end = volume->patch_begin[i + 1];
    TRY(fem_pattern_add_clique(pattern, end - begin, volume->patch_list + begin, has_grown));
  }
  return STATUS_OK;
}

static void gather(const FemVolume *volume, int tet, const double *positions, double x[12]) {
  for (int k = 0; k < 4; k++)
    memcpy(x + 3 * k, positions + 3 * (size_t)volume->model->tets[tet][k], 3 * sizeof *x);
}

static void evaluate_tet(FemVolume *volume, int i, const double *positions) {
  int tet = volume->tets[i];
  const FemElement *element = &volume->elements[i];
  double x[12], F[9], gradient[9], *out = volume->tet_gradient + 12 * (size_t)i;
  gather(volume, tet, positions, x);
  fem_element_deformation(element, x, F);
  volume->tet_theta[i] = fem_material_volume(part_of(volume, tet)->material.law, F, gradient);
  for (int a = 0; a < 4; a++)
    for (int c = 0; c < 3; c++) {
      const double *g = element->gradient[a], *row = gradient + 3 * c;
      out[3 * a + c] = 0.25 * element->volume * (row[0] * g[0] + row[1] * g[1] + row[2] * g[2]);
    }
}

void fem_volume_evaluate(FemVolume *volume, const double *positions) {
  for (int a = 0; a < volume->vertex_count; a++) volume->vertex_theta[a] = 0;
  for (int i = 0; i < volume->tet_count; i++) {
    evaluate_tet(volume, i, positions);
    double share = 0.25 * volume->elements[i].volume * volume->tet_theta[i];
    for (int k = 0; k < 4; k++) {
      int a = volume->corners[i][k];
      volume->vertex_theta[a] += share / volume->vertex_volume[a];
    }
  }
}

double fem_volume_energy(const FemVolume *volume) {
  double sum = 0;
  for (int i = 0; i < volume->tet_count; i++) { // a quarter of each vertex' share by tetrahedra: parts differ
    double squares = 0;
    for (int k = 0; k < 4; k++) {
      double theta = volume->vertex_theta[volume->corners[i][k]];
      squares += theta * theta;
    }
    sum += 0.5 * stiffness_of(part_of(volume, volume->tets[i])) * 0.25 * volume->elements[i].volume * squares;
  }
  return sum;
}

static double sum_of_thetas(const FemVolume *volume, int i) {
  const int *corners = volume->corners[i];
  return volume->vertex_theta[corners[0]] + volume->vertex_theta[corners[1]] +
         volume->vertex_theta[corners[2]] + volume->vertex_theta[corners[3]];
}

double fem_volume_pressure(const FemVolume *volume, int tet) {
  return 0.25 * stiffness_of(part_of(volume, tet)) * sum_of_thetas(volume, volume->index[tet]);
}

// f = −Σ_a k θ_a V_a ∂θ_a/∂x = −Σ_e k (Σ_{a∈e} θ_a) ¼ V_e ∂θ_e/∂x.
void fem_volume_add_force(const FemVolume *volume, double *force) {
  for (int i = 0; i < volume->tet_count; i++) {
    int tet = volume->tets[i];
    const int *vertices = volume->model->tets[tet];
    const double *gradient = volume->tet_gradient + 12 * (size_t)i;
    double weight = stiffness_of(part_of(volume, tet)) * sum_of_thetas(volume, i);
    for (int r = 0; r < 12; r++) force[3 * (size_t)vertices[r / 3] + (size_t)(r % 3)] -= weight * gradient[r];
  }
}

// k/V_a (V_a ∂θ_a)(V_a ∂θ_a)ᵀ over the patch of one vertex.
static void add_patch(FemVolume *volume, int i, double scale, FemMatrix *matrix) {
  const FemModel *model = volume->model;
  int begin = volume->patch_begin[i], count = volume->patch_begin[i + 1] - begin;
  const int *patch = volume->patch_list + begin;
  for (int k = 0; k < count; k++) volume->place[patch[k]] = k;
  memset(volume->row, 0, 3 * (size_t)count * sizeof *volume->row);
  for (int t = volume->tet_begin[i]; t < volume->tet_begin[i + 1]; t++) {
    int local = volume->tet_list[t];
    const int *tet = model->tets[volume->tets[local]];
    const double *gradient = volume->tet_gradient + 12 * (size_t)local;
    for (int r = 0; r < 12; r++) volume->row[3 * volume->place[tet[r / 3]] + r % 3] += gradient[r];
  }
  double stiffness = stiffness_of(&model->parts[volume->parts[i]]);
  fem_matrix_add_outer(matrix, count, patch, volume->row, scale * stiffness / volume->vertex_volume[i]);
}

// k (Σ_{a∈e} θ_a) ¼ V_e ∂²θ_e/∂x²: an element's own, like that of a stress.
static void add_curvature(const FemVolume *volume, int i, const double *positions, double scale,
                          FemMatrix *matrix) {
  int tet = volume->tets[i];
  const FemElement *element = &volume->elements[i];
  double x[12], F[9], curvature[81], dense[144];
  gather(volume, tet, positions, x);
  fem_element_deformation(element, x, F);
  fem_material_volume_curvature(part_of(volume, tet)->material.law, F, curvature);
  fem_element_spread_tangent(element, curvature, dense);
  fem_matrix_add(matrix, 4, volume->model->tets[tet], dense, scale * fem_volume_pressure(volume, tet));
}

void fem_volume_add_stiffness(FemVolume *volume, const double *positions, double scale, FemMatrix *matrix) {
  for (int i = 0; i < volume->vertex_count; i++) add_patch(volume, i, scale, matrix);
  for (int i = 0; i < volume->tet_count; i++) add_curvature(volume, i, positions, scale, matrix);
}
