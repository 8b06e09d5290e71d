// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a function g by the answers of the overlap model: V and x̄ of each pair of meshes of an
// evaluation. From there by the weights of the network that gave them.
#ifndef TETLAP_FEM_GRADIENT_CONTACT_ANSWERS_H
#define TETLAP_FEM_GRADIENT_CONTACT_ANSWERS_H

#include "contact/system.h"
#include "fem/model/model.h"

typedef struct FemAnswers {
  double *by; // ∂g/∂V, ∂g/∂x̄                                                       (mesh_pair_count, 4)
  size_t capacity;
} FemAnswers;

// How many weights the scene's overlap model has. STATUS_INPUT: there are none with derivatives; the message
// says which models have.
Status fem_answers_count_weights(const FemModel *model, size_t *count);

// All 0, for the pairs of an evaluation.
Status fem_answers_begin(FemAnswers *answers, const ContactEvaluation *evaluation);
void fem_answers_destroy(FemAnswers *answers); // also of a zeroed one
// Adds ∂g/∂w to `slope`, in the network's order (overlap/ops.h, OverlapTraining).
Status fem_answers_train(const FemAnswers *answers, const ContactSystem *contact,
                         const ContactEvaluation *evaluation, double *slope);

#endif
