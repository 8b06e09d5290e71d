// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over elements, shared by the effects on tetrahedra (elasticity, damping). An effect gives kernels;
// this file gathers vertices, adds by colours, and finds the entries of the matrix. Forces and matrices go
// through vector lanes, eight elements at a time (fem/effect/elements/packs.h). Every sum has a fixed order:
// results are the same to the last bit for any number of threads.
#ifndef TETLAP_FEM_EFFECT_ELEMENTS_ASSEMBLY_H
#define TETLAP_FEM_EFFECT_ELEMENTS_ASSEMBLY_H

#include <stdbool.h>
#include <stddef.h>

#include "fem/effect/effect.h"
#include "fem/effect/elements/packs.h"

// Eight elements of a part of a body, of one kind.
typedef struct FemAssemblyPack {
  const FemLanes *lanes; // the kernels of this processor
  const FemLanesElements *elements;
  const FemLanesQuadratics *quadratics;
  const FemModelPart *part;
  const double *positions, *velocities; // of all vertices
} FemAssemblyPack;

typedef void FemAssemblyScalar(const FemAssemblyPack *pack, FemLanesRow scalar);
typedef void FemAssemblyForce(const FemAssemblyPack *pack, FemLanesRow *force); // (12), (30)
// matrix = stiffness_scale · (−∂f/∂x) + damping_scale · (−∂f/∂v), symmetric, as in fem/lanes/lanes.h.
typedef void FemAssemblyMatrix(const FemAssemblyPack *pack, double stiffness_scale, double damping_scale,
                               FemLanesRow *matrix);

// An effect's kernels, of linear elements and of quadratic ones.
typedef struct FemAssemblyKernels {
  FemAssemblyForce *force, *quadratic_force;
  FemAssemblyMatrix *matrix, *quadratic_matrix;
  FemAssemblyScalar *scalar, *quadratic_scalar; // what fem_assembly_sum adds up
} FemAssemblyKernels;

typedef struct FemAssembly {
  const FemModel *model; // borrowed
  FemPacks own[2];       // linear, quadratic; empty where they are borrowed
  FemPacks *packs;       // (2) these, or another assembly's
  double *partial[2];    // sums of chunks of them                   (chunk_count)
} FemAssembly;

// All elements of bodies, which obstacles are not, that this rank has and whose part `takes` accepts (NULL:
// all). A zeroed assembly, and one whose creation failed, can be destroyed.
// Must not be moved once it is created.
Status fem_assembly_create(FemAssembly *assembly, const FemModel *model,
                           bool (*takes)(const FemModelPart *part));
// Takes the packs of another assembly of the same model, which lives as long, if it has the same elements.
void fem_assembly_borrow(FemAssembly *assembly, FemAssembly *from);
void fem_assembly_destroy(FemAssembly *assembly);
size_t fem_assembly_bytes(const FemAssembly *assembly); // on the heap

void fem_assembly_add_forces(const FemAssembly *assembly, const FemState *state,
                             const FemAssemblyKernels *kernels, double *force);
// Looks up the slots first if the matrix has been laid out anew (the first time allocates them).
Status fem_assembly_add_matrices(FemAssembly *assembly, const FemState *state,
                                 const FemAssemblyKernels *kernels, double stiffness_scale,
                                 double damping_scale, FemMatrix *matrix);
double fem_assembly_sum(FemAssembly *assembly, const FemState *state, const FemAssemblyKernels *kernels);
// The same of each body apart (body_count).
void fem_assembly_sum_bodies(FemAssembly *assembly, const FemState *state, const FemAssemblyKernels *kernels,
                             double *sums);

// Operations of an effect that is an assembly, as FemEffectOps has them: nothing of it depends on former
// states, and the matrix couples the nodes of each element.
Status fem_assembly_effect_create(void **self, const FemModel *model,
                                  bool (*takes)(const FemModelPart *part));
Status fem_assembly_effect_keep(void **self, void **old); // create_again
Status fem_assembly_effect_couple(void *self, const FemState *state, FemPattern *pattern, int *has_grown);
bool fem_assembly_effect_is_linear(void *self); // its materials are
size_t fem_assembly_effect_bytes(const void *self);
void fem_assembly_effect_destroy(void *self);

#endif
