// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/elements/assembly.h"

#include <stddef.h>

#include "base/memory.h"

// Below this many elements one thread does it all: a colour is a barrier, and some ten of them take as long
// as the work that a second thread would save.
enum { FEW_FORCES = 8000, FEW_MATRICES = 2000 };
// A quadratic element is as much work as so many linear ones.
enum { QUADRATIC_FORCES = 6, QUADRATIC_MATRICES = 16 };

Status fem_assembly_create(FemAssembly *assembly, const FemModel *model,
                           bool (*takes)(const FemModelPart *part)) {
  *assembly = (FemAssembly){.model = model, .packs = assembly->own};
  for (int k = 0; k < 2; k++) {
    TRY(fem_packs_create(&assembly->own[k], model, k == 1, takes));
    assembly->partial[k] =
        memory_zeroed((size_t)assembly->packs[k].chunk_count, sizeof *assembly->partial[k]);
    if (!assembly->partial[k]) return status_no_memory("partial sums over elements");
  }
  return STATUS_OK;
}

// Both have elements of the same parts where they have as many: one takes all that there are.
void fem_assembly_borrow(FemAssembly *assembly, FemAssembly *from) {
  for (int k = 0; k < 2; k++)
    if (assembly->own[k].element_count != from->packs[k].element_count) return;
  for (int k = 0; k < 2; k++) fem_packs_destroy(&assembly->own[k]);
  assembly->packs = from->packs;
}

void fem_assembly_destroy(FemAssembly *assembly) {
  for (int k = 0; k < 2; k++) {
    fem_packs_destroy(&assembly->own[k]);
    memory_free(assembly->partial[k]);
  }
  *assembly = (FemAssembly){0};
}

size_t fem_assembly_bytes(const FemAssembly *assembly) {
  size_t bytes = 0;
  for (int k = 0; k < 2; k++) bytes += fem_packs_bytes(&assembly->own[k]) + memory_held(assembly->partial[k]);
  return bytes;
}

static Status couple_lane(const FemPacks *packs, int p, int lane, FemPattern *pattern, int *has_grown) {
  int nodes[FEM_QUADRATIC_NODES], count = packs->is_quadratic ? FEM_QUADRATIC_NODES : 4;
  for (int a = 0; a < count; a++)
    nodes[a] = packs->is_quadratic ? packs->quadratics[p].node[a][lane] : packs->packs[p].node[a][lane];
  return fem_pattern_add_clique(pattern, count, nodes, has_grown);
}

static int lanes_of(const FemPacks *packs, int p) {
  return packs->is_quadratic ? packs->quadratics[p].count : packs->packs[p].count;
}

// Each element couples its nodes.
static Status couple(const FemAssembly *assembly, FemPattern *pattern, int *has_grown) {
  for (int k = 0; k < 2; k++)
    for (int p = 0; p < assembly->packs[k].pack_count; p++)
      for (int l = 0; l < lanes_of(&assembly->packs[k], p); l++)
        TRY(couple_lane(&assembly->packs[k], p, l, pattern, has_grown));
  return STATUS_OK;
}

static FemAssemblyPack pack_of(const FemAssembly *assembly, const FemState *state, int part) {
  return (FemAssemblyPack){.lanes = fem_lanes(),
                           .part = &assembly->model->parts[part],
                           .positions = state->positions,
                           .velocities = state->velocities};
}

static void add_pack_force(const FemPacks *packs, int p, FemAssemblyPack *pack,
                           const FemAssemblyKernels *kernels, double *force) {
  FemLanesRow own[3 * FEM_QUADRATIC_NODES];
  if (packs->is_quadratic) {
    pack->quadratics = &packs->quadratics[p];
    kernels->quadratic_force(pack, own);
    pack->lanes->scatter_quadratic_force(pack->quadratics, own, force);
    return;
  }
  pack->elements = &packs->packs[p];
  kernels->force(pack, own);
  pack->lanes->scatter_force(pack->elements, own, force);
}

static void add_chunk_forces(const FemAssembly *assembly, const FemPacks *packs, const FemState *state,
                             const FemAssemblyKernels *kernels, int chunk, double *force) {
  FemAssemblyPack pack = pack_of(assembly, state, packs->chunk_part[chunk]);
  if (state->is_held && state->is_held[pack.part->body]) return;
  for (int p = packs->chunk_begin[chunk]; p < packs->chunk_begin[chunk + 1]; p++)
    add_pack_force(packs, p, &pack, kernels, force);
}

// As many linear elements.
static int work_of(const FemPacks *packs, int quadratic) {
  return packs->is_quadratic ? quadratic * packs->element_count : packs->element_count;
}

void fem_assembly_add_forces(const FemAssembly *assembly, const FemState *state,
                             const FemAssemblyKernels *kernels, double *force) {
  for (int k = 0; k < 2; k++) {
    const FemPacks *packs = &assembly->packs[k];
#pragma omp parallel if (work_of(packs, QUADRATIC_FORCES) > FEW_FORCES)
    for (int colour = 0; colour < packs->colour_count; colour++) {
#pragma omp for schedule(dynamic)
      for (int chunk = packs->colour_begin[colour]; chunk < packs->colour_begin[colour + 1]; chunk++)
        add_chunk_forces(assembly, packs, state, kernels, chunk, force);
    }
  }
}

// Elements of which a coordinate is prescribed have no whole blocks.
static void add_partial_matrices(const FemLanesElements *elements, const int slots[FEM_LANES],
                                 FemLanesRow own[FEM_LANES_ENTRIES], FemMatrix *matrix) {
  for (int l = 0; l < elements->count; l++) {
    if (slots[l] >= 0) continue;
    double dense[144];
    int vertices[4];
    for (int a = 0; a < 4; a++) vertices[a] = elements->node[a][l];
    fem_lanes_unpack(own, l, dense);
    fem_matrix_add(matrix, 4, vertices, dense, 1);
  }
}

// What a matrix is scaled by.
typedef struct Scales {
  double stiffness, damping;
} Scales;

static void add_pack_matrix(const FemPacks *packs, int p, FemAssemblyPack *pack,
                            const FemAssemblyKernels *kernels, Scales scales, FemMatrix *matrix) {
  FemLanesRow own[FEM_LANES_ENTRIES];
  pack->elements = &packs->packs[p];
  kernels->matrix(pack, scales.stiffness, scales.damping, own);
  pack->lanes->scatter_matrix(pack->elements, packs->slots[p], own, matrix->value);
  add_partial_matrices(pack->elements, packs->slots[p][0], own, matrix);
}

static void add_quadratic_matrix(const FemPacks *packs, int p, FemAssemblyPack *pack,
                                 const FemAssemblyKernels *kernels, Scales scales, FemMatrix *matrix) {
  FemLanesRow own[FEM_LANES_HALF];
  pack->quadratics = &packs->quadratics[p];
  kernels->quadratic_matrix(pack, scales.stiffness, scales.damping, own);
  pack->lanes->scatter_quadratic_matrix(pack->quadratics, packs->half_slots[p], own, matrix->value);
}

static void add_chunk_matrices(const FemAssembly *assembly, const FemPacks *packs, const FemState *state,
                               const FemAssemblyKernels *kernels, Scales scales, int chunk,
                               FemMatrix *matrix) {
  FemAssemblyPack pack = pack_of(assembly, state, packs->chunk_part[chunk]);
  if (state->is_held && state->is_held[pack.part->body]) return;
  for (int p = packs->chunk_begin[chunk]; p < packs->chunk_begin[chunk + 1]; p++) {
    if (packs->is_quadratic)
      add_quadratic_matrix(packs, p, &pack, kernels, scales, matrix);
    else
      add_pack_matrix(packs, p, &pack, kernels, scales, matrix);
  }
}

Status fem_assembly_add_matrices(FemAssembly *assembly, const FemState *state,
                                 const FemAssemblyKernels *kernels, double stiffness_scale,
                                 double damping_scale, FemMatrix *matrix) {
  Scales scales = {stiffness_scale, damping_scale};
  for (int k = 0; k < 2; k++) TRY(fem_packs_find_slots(&assembly->packs[k], matrix));
  for (int k = 0; k < 2; k++) {
    const FemPacks *packs = &assembly->packs[k];
#pragma omp parallel if (work_of(packs, QUADRATIC_MATRICES) > FEW_MATRICES)
    for (int colour = 0; colour < packs->colour_count; colour++) {
#pragma omp for schedule(dynamic)
      for (int chunk = packs->colour_begin[colour]; chunk < packs->colour_begin[colour + 1]; chunk++)
        add_chunk_matrices(assembly, packs, state, kernels, scales, chunk, matrix);
    }
  }
  return STATUS_OK;
}

static double sum_chunk(const FemAssembly *assembly, const FemPacks *packs, const FemState *state,
                        const FemAssemblyKernels *kernels, int chunk) {
  FemAssemblyPack pack = pack_of(assembly, state, packs->chunk_part[chunk]);
  double sum = 0;
  for (int p = packs->chunk_begin[chunk]; p < packs->chunk_begin[chunk + 1]; p++) {
    FemLanesRow own;
    if (packs->is_quadratic)
      pack.quadratics = &packs->quadratics[p];
    else
      pack.elements = &packs->packs[p];
    (packs->is_quadratic ? kernels->quadratic_scalar : kernels->scalar)(&pack, own);
    for (int l = 0; l < lanes_of(packs, p); l++) sum += own[l];
  }
  return sum;
}

static void sum_chunks(FemAssembly *assembly, const FemPacks *packs, const FemState *state,
                       const FemAssemblyKernels *kernels, double *sums) {
#pragma omp parallel for schedule(dynamic) if (work_of(packs, QUADRATIC_FORCES) > FEW_FORCES)
  for (int chunk = 0; chunk < packs->chunk_count; chunk++)
    sums[chunk] = sum_chunk(assembly, packs, state, kernels, chunk);
}

double fem_assembly_sum(FemAssembly *assembly, const FemState *state, const FemAssemblyKernels *kernels) {
  double sum = 0;
  for (int k = 0; k < 2; k++) {
    const FemPacks *packs = &assembly->packs[k];
    sum_chunks(assembly, packs, state, kernels, assembly->partial[k]);
    for (int chunk = 0; chunk < packs->chunk_count; chunk++) sum += assembly->partial[k][chunk];
  }
  return sum;
}

void fem_assembly_sum_bodies(FemAssembly *assembly, const FemState *state, const FemAssemblyKernels *kernels,
                             double *sums) {
  const FemModel *model = assembly->model;
  for (int b = 0; b < model->body_count; b++) sums[b] = 0;
  for (int k = 0; k < 2; k++) {
    const FemPacks *packs = &assembly->packs[k];
    sum_chunks(assembly, packs, state, kernels, assembly->partial[k]);
    for (int chunk = 0; chunk < packs->chunk_count; chunk++)
      sums[model->parts[packs->chunk_part[chunk]].body] += assembly->partial[k][chunk];
  }
}

// ---- Operations of an effect.

Status fem_assembly_effect_create(void **self, const FemModel *model,
                                  bool (*takes)(const FemModelPart *part)) {
  FemAssembly *assembly = memory_zeroed(1, sizeof *assembly);
  if (!assembly) return status_no_memory("the elements");
  Status status = fem_assembly_create(assembly, model, takes);
  if (status) {
    fem_assembly_effect_destroy(assembly);
    return status;
  }
  *self = assembly;
  return STATUS_OK;
}

Status fem_assembly_effect_keep(void **self, void **old) {
  *self = *old;
  *old = NULL;
  return STATUS_OK;
}

Status fem_assembly_effect_couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown) {
  (void)state;
  return couple(self, pattern, has_grown);
}

bool fem_assembly_effect_is_linear(void *self) {
  return fem_model_has_linear_materials(((const FemAssembly *)self)->model);
}

size_t fem_assembly_effect_bytes(const void *self) {
  return memory_held(self) + fem_assembly_bytes(self);
}

void fem_assembly_effect_destroy(void *self) {
  fem_assembly_destroy(self);
  memory_free(self);
}
