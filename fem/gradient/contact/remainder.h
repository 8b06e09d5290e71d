// SPDX-License-Identifier: GPL-3.0-or-later
// What the matrix lacks of contact's exact stiffness, by an overlap model that does not clip, or with a
// pressure law. The matrix has the stiffness of clipping's polyhedra and that of a law's energy. The forces
// themselves are differentiated exactly by contact_system_turn. The difference is kept as blocks over the
// vertices of two elements, for products with it and with its transpose.
#ifndef TETLAP_FEM_GRADIENT_CONTACT_REMAINDER_H
#define TETLAP_FEM_GRADIENT_CONTACT_REMAINDER_H

#include "contact/system.h"
#include "fem/model/model.h"

typedef struct FemRemainder {
  int block_count;
  int *begins;    // in `vertices`                                                   (block_count + 1)
  size_t *starts; // in `values`                                                     (block_count + 1)
  int *vertices;  // of the blocks
  double *values; // exact −∂f/∂x less the matrix's; 9 times the square of a block's number of vertices
  size_t begin_capacity, start_capacity, vertex_capacity, value_capacity;
} FemRemainder;

// Whether contact's matrix is not that of its forces.
bool fem_remainder_is_there(const FemModel *model);
// STATUS_INPUT: the scene's overlap model has no derivatives, or its pressure law has none with that model.
Status fem_remainder_check(const FemModel *model);

// At an evaluation of the system's. Destroy it also after a failure.
Status fem_remainder_find(FemRemainder *remainder, ContactSystem *contact,
                          const ContactEvaluation *evaluation);
void fem_remainder_destroy(FemRemainder *remainder); // also of a zeroed one

// y += A x or, `back`, Aᵀ x, A the difference; both (vertex_count, 3).
void fem_remainder_add_product(const FemRemainder *remainder, bool back, const double *x, double *y);

#endif
