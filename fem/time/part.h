// SPDX-License-Identifier: GPL-3.0-or-later
// What a rank has of the integrator's vectors: the unknowns of its vertices, ascending. Positions and
// velocities of all are joined for an evaluation of forces. One process has all unknowns, and nothing is
// copied.
#ifndef TETLAP_FEM_TIME_PART_H
#define TETLAP_FEM_TIME_PART_H

#include "fem/effect/numbering.h"

typedef struct FemPart {
  const FemNumbering *numbering; // borrowed
  int n;                         // unknowns of all ranks
  int count;                     // of this one: vectors have 2·count numbers, displacements and velocities
  int *order;                    // unknowns by ranks; NULL: one process                     (n)
  int *begin;                    // of each rank's in `order`                                (ranks + 1)
  const int *own;                // this rank's in `order`                                   (count)
  double *joined;                // by ranks: scratch                                        (n, 2)
  double *whole;                 // by unknowns: what fem_part_join gives                    (2·n)
} FemPart;

// A zeroed one, and one whose creation failed, can be destroyed.
Status fem_part_create(FemPart *part, const FemModel *model, const FemNumbering *numbering);
void fem_part_destroy(FemPart *part);

// The number among all unknowns of this rank's i-th.
static inline int fem_part_unknown(const FemPart *part, int i) {
  return part->order ? part->own[i] : i;
}

// The coordinate of this rank's i-th unknown: 3·vertex + component.
static inline int fem_part_dof(const FemPart *part, int i) {
  return part->numbering->dof_of_unknown[fem_part_unknown(part, i)];
}

// All displacements and velocities (2·n) from each rank's (2·count): its own array in one process, else
// borrowed until the next call. By all ranks.
const double *fem_part_join(const FemPart *part, const double *own);
// own (count) from values of all unknowns (n), and back: others' are left as they are.
void fem_part_take(const FemPart *part, const double *all, double *own);
void fem_part_give(const FemPart *part, const double *own, double *all);

// Of this rank's numbers the sum and the largest over ranks; by all ranks.
double fem_part_sum(double own);
double fem_part_most(double own);
// The largest of the values `begin` … `end` − 1 of all ranks' 2·count, each times its weight (NULL: 1): its
// number among the 2·n. NaN counts as the largest. By all ranks.
int fem_part_worst(const FemPart *part, const double *values, const double *weights, int begin, int end);

#endif
