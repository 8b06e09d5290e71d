// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/effect/assembly.h"

#include <stddef.h>

#include "base/memory.h"

// Elements whose scalars are added one after another by one thread; fixed, so that sums do not depend on how
// many threads share the work.
enum { CHUNK = 256 };
// Below this many elements one thread does it all: a colour is a barrier, and some thirty of them, on a
// machine that others use too, take longer than the millisecond of work that a second thread would save.
enum { FEW_SCALARS = 20000, FEW_FORCES = 60000, FEW_MATRICES = 16000 };
// A quadratic element is as much work as so many linear ones.
enum { QUADRATIC_FORCES = 6, QUADRATIC_MATRICES = 16 };

static int chunk_count(const FemAssemblyList *list) {
  return (list->count + CHUNK - 1) / CHUNK;
}

static const int *nodes_of(const FemAssemblyList *list, int i) {
  return list->nodes + (size_t)list->node_count * (size_t)list->colouring.tets[i];
}

static Status select_elements(FemAssemblyList *list, const FemModel *model, const FemColouring *all,
                              bool is_quadratic, bool (*takes)(const FemModelBody *body)) {
  FemColouring *own = &list->colouring;
  size_t most = all->colour_count > 0 ? (size_t)all->begin[all->colour_count] : 0;
  own->begin = memory_zeroed((size_t)all->colour_count + 1, sizeof *own->begin);
  own->tets = memory_zeroed(most, sizeof *own->tets);
  if (!own->begin || !own->tets) return status_no_memory("the list of elements");
  for (int colour = 0; colour < all->colour_count; colour++) {
    own->begin[colour] = list->count;
    for (int i = all->begin[colour]; i < all->begin[colour + 1]; i++) {
      const FemModelBody *body = &model->bodies[list->body[all->tets[i]]];
      const int *nodes = list->nodes + (size_t)list->node_count * (size_t)all->tets[i];
      if ((takes && !takes(body)) || (body->element == FEM_ELEMENT_QUADRATIC) != is_quadratic) continue;
      if (!fem_share_has(model->share, list->node_count, nodes)) continue;
      own->tets[list->count++] = all->tets[i];
    }
  }
  own->colour_count = all->colour_count;
  own->begin[own->colour_count] = list->count;
  list->partial = memory_zeroed((size_t)chunk_count(list), sizeof *list->partial);
  return list->partial ? STATUS_OK : status_no_memory("partial sums over elements");
}

Status fem_assembly_create(FemAssembly *assembly, const FemModel *model,
                           bool (*takes)(const FemModelBody *body)) {
  *assembly = (FemAssembly){.model = model};
  for (int k = 0; k < 2; k++) TRY(fem_packs_create(&assembly->packs[k], model, k == 1, takes));
  assembly->lists[0] =
      (FemAssemblyList){.node_count = 4, .nodes = (const int *)model->tets, .body = model->tet_body};
  TRY(select_elements(&assembly->lists[0], model, &model->colouring, false, takes));
  assembly->lists[1] = (FemAssemblyList){.node_count = FEM_QUADRATIC_NODES,
                                         .nodes = (const int *)model->quadratic_nodes,
                                         .body = model->quadratic_body};
  return select_elements(&assembly->lists[1], model, &model->quadratic_colouring, true, takes);
}

void fem_assembly_destroy(FemAssembly *assembly) {
  for (int k = 0; k < 2; k++) {
    fem_packs_destroy(&assembly->packs[k]);
    FemAssemblyList *list = &assembly->lists[k];
    memory_free(list->colouring.begin);
    memory_free(list->colouring.tets);
    memory_free(list->partial);
  }
  *assembly = (FemAssembly){0};
}

size_t fem_assembly_bytes(const FemAssembly *assembly) {
  size_t bytes = 0;
  for (int k = 0; k < 2; k++) {
    const FemAssemblyList *list = &assembly->lists[k];
    bytes += fem_packs_bytes(&assembly->packs[k]) + memory_held(list->colouring.begin) +
             memory_held(list->colouring.tets) + memory_held(list->partial);
  }
  return bytes;
}

Status fem_assembly_couple(const FemAssembly *assembly, FemPattern *pattern, int *has_grown) {
  for (int k = 0; k < 2; k++) {
    const FemAssemblyList *list = &assembly->lists[k];
    for (int i = 0; i < list->count; i++)
      TRY(fem_pattern_add_clique(pattern, list->node_count, nodes_of(list, i), has_grown));
  }
  return STATUS_OK;
}

// The i-th element of the list.
static inline void gather(const FemAssembly *assembly, const FemAssemblyList *list, const FemState *state,
                          int i, FemAssemblyElement *e) {
  const FemModel *model = assembly->model;
  int number = list->colouring.tets[i];
  bool is_linear = list->node_count == 4;
  const int *nodes = list->nodes + (size_t)list->node_count * (size_t)number;
  e->element = is_linear ? &model->elements[number] : NULL;
  e->quadratic = is_linear ? NULL : &model->quadratics[number];
  e->body = &model->bodies[list->body[number]];
  for (int a = 0; a < list->node_count; a++) {
    size_t dof = 3 * (size_t)nodes[a];
    for (int c = 0; c < 3; c++) {
      e->x[3 * a + c] = state->positions[dof + (size_t)c];
      e->v[3 * a + c] = state->velocities[dof + (size_t)c];
    }
  }
}

static FemAssemblyPack pack_of(const FemAssembly *assembly, const FemState *state, int body) {
  return (FemAssemblyPack){.lanes = fem_lanes(),
                           .body = &assembly->model->bodies[body],
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
  FemAssemblyPack pack = pack_of(assembly, state, packs->chunk_body[chunk]);
  if (pack.body->is_held) return;
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
#pragma omp for schedule(static)
      for (int chunk = packs->colour_begin[colour]; chunk < packs->colour_begin[colour + 1]; chunk++)
        add_chunk_forces(assembly, packs, state, kernels, chunk, force);
    }
  }
}

static Status find_slots(FemAssembly *assembly, const FemMatrix *matrix) {
  if (assembly->layout == matrix->layout) return STATUS_OK;
  for (int k = 0; k < 2; k++) TRY(fem_packs_find_slots(&assembly->packs[k], matrix));
  assembly->layout = matrix->layout;
  return STATUS_OK;
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
  FemAssemblyPack pack = pack_of(assembly, state, packs->chunk_body[chunk]);
  if (pack.body->is_held) return;
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
  TRY(find_slots(assembly, matrix));
  for (int k = 0; k < 2; k++) {
    const FemPacks *packs = &assembly->packs[k];
#pragma omp parallel if (work_of(packs, QUADRATIC_MATRICES) > FEW_MATRICES)
    for (int colour = 0; colour < packs->colour_count; colour++) {
#pragma omp for schedule(static)
      for (int chunk = packs->colour_begin[colour]; chunk < packs->colour_begin[colour + 1]; chunk++)
        add_chunk_matrices(assembly, packs, state, kernels, scales, chunk, matrix);
    }
  }
  return STATUS_OK;
}

static double sum_list(const FemAssembly *assembly, const FemAssemblyList *list, const FemState *state,
                       FemAssemblyScalar *kernel) {
  int chunks = chunk_count(list);
#pragma omp parallel for schedule(static) if (list->count > FEW_SCALARS)
  for (int chunk = 0; chunk < chunks; chunk++) {
    int begin = chunk * CHUNK;
    int end = begin + CHUNK < list->count ? begin + CHUNK : list->count;
    double sum = 0;
    for (int i = begin; i < end; i++) {
      FemAssemblyElement e;
      gather(assembly, list, state, i, &e);
      sum += kernel(&e);
    }
    list->partial[chunk] = sum;
  }
  double sum = 0;
  for (int chunk = 0; chunk < chunks; chunk++) sum += list->partial[chunk];
  return sum;
}

double fem_assembly_sum(FemAssembly *assembly, const FemState *state, FemAssemblyScalar *kernel) {
  return sum_list(assembly, &assembly->lists[0], state, kernel) +
         sum_list(assembly, &assembly->lists[1], state, kernel);
}
