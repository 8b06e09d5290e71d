// SPDX-License-Identifier: GPL-3.0-or-later
// What the matrix lacks of contact by an overlap model that does not clip, or with a pressure law: the matrix
// has the forces of clipping's polyhedra and of a law's energy, the forces as they are are differentiated
// exactly (contact_system_turn). The difference is
// kept as blocks over the vertices of two elements, for products with it and with its transpose.
#ifndef TETLAP_FEM_GRADIENT_LEARNED_H
#define TETLAP_FEM_GRADIENT_LEARNED_H

#include "contact/system.h"
#include "fem/model/model.h"

typedef struct FemLearned {
  int block_count;
  int *begins;    // in `vertices`                                                   (block_count + 1)
  size_t *starts; // in `values`                                                     (block_count + 1)
  int *vertices;  // of the blocks
  double *values; // −∂f/∂x of the model less that of clipping, 9 times the square of a block's vertices
  size_t begin_capacity, start_capacity, vertex_capacity, value_capacity;
} FemLearned;

// What a function has by V and x̄ of the pairs of meshes of an evaluation: on the way to the weights of the
// network that gave them.
typedef struct FemAnswers {
  double *by; // ∂g/∂V, ∂g/∂x̄                                                       (mesh_pair_count, 4)
  size_t capacity;
} FemAnswers;

// All 0, at an evaluation of the system's.
Status fem_answers_begin(FemAnswers *answers, const ContactEvaluation *evaluation);
void fem_answers_destroy(FemAnswers *answers); // also of a zeroed one
// Adds what follows by the weights (overlap/ops.h, OverlapTraining).
Status fem_answers_train(const FemAnswers *answers, const ContactSystem *contact,
                         const ContactEvaluation *evaluation, double *slope);

// Whether contact's matrix is not that of its forces.
bool fem_learned_is_there(const FemModel *model);
// STATUS_INPUT: the scene's overlap model has no derivatives, or there are none of what is asked with it.
Status fem_learned_check(const FemModel *model);
// The same of the weights of its network; how many there are.
Status fem_learned_count_weights(const FemModel *model, size_t *count);

// At an evaluation of the system's. Destroy it also after a failure.
Status fem_learned_find(FemLearned *learned, ContactSystem *contact, const ContactEvaluation *evaluation);
void fem_learned_destroy(FemLearned *learned); // also of a zeroed one

// y += A x or, `back`, Aᵀ x, all (vertex_count, 3).
void fem_learned_add_product(const FemLearned *learned, bool back, const double *x, double *y);

#endif
