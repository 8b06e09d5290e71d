// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/assembly.h"

#include <stddef.h>

#include "base/memory.h"

// Elements whose scalars are added one after another by one thread; fixed, so that sums do not depend on how
// many threads share the work.
enum { CHUNK = 256 };
// Entries of a symmetric (12 × 12) matrix.
enum { HALF = 78 };
// Below this many elements one thread does it all: a colour is a barrier, and some thirty of them, on a
// machine that others use too, take longer than the millisecond of work that a second thread would save.
enum { FEW_FORCES = 20000, FEW_MATRICES = 4000 };

static int chunk_count(const FemAssembly *assembly) {
  return (assembly->tet_count + CHUNK - 1) / CHUNK;
}

static void select_tets(FemAssembly *assembly, bool (*takes)(const FemModelBody *body)) {
  const FemModel *model = assembly->model;
  const FemColouring *all = &model->colouring;
  FemColouring *own = &assembly->colouring;
  for (int colour = 0; colour < all->colour_count; colour++) {
    own->begin[colour] = assembly->tet_count;
    for (int i = all->begin[colour]; i < all->begin[colour + 1]; i++) {
      const FemModelBody *body = &model->bodies[model->tet_body[all->tets[i]]];
      if (takes && !takes(body)) continue;
      assembly->elements[assembly->tet_count] = model->elements[all->tets[i]];
      own->tets[assembly->tet_count++] = all->tets[i];
    }
  }
  own->colour_count = all->colour_count;
  own->begin[own->colour_count] = assembly->tet_count;
}

Status fem_assembly_create(FemAssembly *assembly, const FemModel *model,
                           bool (*takes)(const FemModelBody *body)) {
  *assembly = (FemAssembly){.model = model};
  const FemColouring *all = &model->colouring;
  FemColouring *own = &assembly->colouring;
  own->begin = memory_zeroed((size_t)all->colour_count + 1, sizeof *own->begin);
  own->tets = memory_zeroed((size_t)model->tet_count, sizeof *own->tets);
  assembly->elements = memory_zeroed((size_t)model->tet_count, sizeof *assembly->elements);
  if (!own->begin || !own->tets || !assembly->elements) return status_no_memory("the list of elements");
  select_tets(assembly, takes);
  assembly->partial = memory_zeroed((size_t)chunk_count(assembly), sizeof *assembly->partial);
  if (!assembly->partial) return status_no_memory("partial sums over elements");
  return STATUS_OK;
}

void fem_assembly_destroy(FemAssembly *assembly) {
  memory_free(assembly->colouring.begin);
  memory_free(assembly->colouring.tets);
  memory_free(assembly->elements);
  memory_free(assembly->partial);
  memory_free(assembly->slots);
  *assembly = (FemAssembly){0};
}

size_t fem_assembly_bytes(const FemAssembly *assembly) {
  return memory_held(assembly->colouring.begin) + memory_held(assembly->colouring.tets) +
         memory_held(assembly->elements) + memory_held(assembly->partial) + memory_held(assembly->slots);
}

Status fem_assembly_couple(const FemAssembly *assembly, FemPattern *pattern, int *has_grown) {
  for (int i = 0; i < assembly->tet_count; i++)
    TRY(fem_pattern_add_clique(pattern, 4, assembly->model->tets[assembly->colouring.tets[i]], has_grown));
  return STATUS_OK;
}

// The i-th element of the colouring.
static inline void gather(const FemAssembly *assembly, const FemState *state, int i, FemAssemblyElement *e) {
  const FemModel *model = assembly->model;
  int tet = assembly->colouring.tets[i];
  e->element = &assembly->elements[i];
  e->body = &model->bodies[model->tet_body[tet]];
  for (int a = 0; a < 4; a++) {
    size_t dof = 3 * (size_t)model->tets[tet][a];
    for (int c = 0; c < 3; c++) {
      e->x[3 * a + c] = state->positions[dof + (size_t)c];
      e->v[3 * a + c] = state->velocities[dof + (size_t)c];
    }
  }
}

void fem_assembly_add_forces(const FemAssembly *assembly, const FemState *state, FemAssemblyForce *kernel,
                             double *force) {
  const FemColouring *colouring = &assembly->colouring;
#pragma omp parallel if (assembly->tet_count > FEW_FORCES)
  for (int colour = 0; colour < colouring->colour_count; colour++) {
#pragma omp for schedule(static)
    for (int i = colouring->begin[colour]; i < colouring->begin[colour + 1]; i++) {
      FemAssemblyElement e;
      double own[12];
      gather(assembly, state, i, &e);
      kernel(&e, own);
      const int *vertices = assembly->model->tets[colouring->tets[i]];
      for (int r = 0; r < 12; r++) force[3 * (size_t)vertices[r / 3] + (size_t)(r % 3)] += own[r];
    }
  }
}

// An entry and its mirror image are one number, and at most one of the two has a place in the matrix.
static void pack_slots(const int slots[144], int packed[HALF]) {
  for (int r = 0, k = 0; r < 12; r++)
    for (int c = 0; c <= r; c++, k++)
      packed[k] = slots[12 * r + c] >= 0 ? slots[12 * r + c] : slots[12 * c + r];
}

static Status find_slots(FemAssembly *assembly, const FemMatrix *matrix) {
  if (assembly->layout == matrix->layout) return STATUS_OK;
  if (!assembly->slots)
    assembly->slots = memory_zeroed((size_t)assembly->tet_count, HALF * sizeof *assembly->slots);
  if (!assembly->slots) return status_no_memory("the elements' places in the matrix");
#pragma omp parallel for schedule(static) if (assembly->tet_count > FEW_MATRICES)
  for (int i = 0; i < assembly->tet_count; i++) {
    int slots[144];
    fem_matrix_slots(matrix, assembly->model->tets[assembly->colouring.tets[i]], slots);
    pack_slots(slots, assembly->slots + HALF * (size_t)i);
  }
  assembly->layout = matrix->layout;
  return STATUS_OK;
}

static inline void scatter_matrix(const double own[144], const int slots[HALF], double *value) {
  for (int r = 0, k = 0; r < 12; r++)
    for (int c = 0; c <= r; c++, k++)
      if (slots[k] >= 0) value[slots[k]] += own[12 * r + c];
}

Status fem_assembly_add_matrices(FemAssembly *assembly, const FemState *state, FemAssemblyMatrix *kernel,
                                 double stiffness_scale, double damping_scale, FemMatrix *matrix) {
  TRY(find_slots(assembly, matrix));
  const FemColouring *colouring = &assembly->colouring;
#pragma omp parallel if (assembly->tet_count > FEW_MATRICES)
  for (int colour = 0; colour < colouring->colour_count; colour++) {
#pragma omp for schedule(static)
    for (int i = colouring->begin[colour]; i < colouring->begin[colour + 1]; i++) {
      FemAssemblyElement e;
      double own[144];
      gather(assembly, state, i, &e);
      kernel(&e, stiffness_scale, damping_scale, own);
      scatter_matrix(own, assembly->slots + HALF * (size_t)i, matrix->value);
    }
  }
  return STATUS_OK;
}

double fem_assembly_sum(FemAssembly *assembly, const FemState *state, FemAssemblyScalar *kernel) {
  int chunks = chunk_count(assembly);
#pragma omp parallel for schedule(static) if (assembly->tet_count > FEW_FORCES)
  for (int chunk = 0; chunk < chunks; chunk++) {
    int begin = chunk * CHUNK;
    int end = begin + CHUNK < assembly->tet_count ? begin + CHUNK : assembly->tet_count;
    double sum = 0;
    for (int i = begin; i < end; i++) {
      FemAssemblyElement e;
      gather(assembly, state, i, &e);
      sum += kernel(&e);
    }
    assembly->partial[chunk] = sum;
  }
  double sum = 0;
  for (int chunk = 0; chunk < chunks; chunk++) sum += assembly->partial[chunk];
  return sum;
}
