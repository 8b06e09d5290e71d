// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a preconditioner that was made from earlier matrix entries still serves: the iterations that it
// needs for a digit of the residual, compared with those when it was new. Per digit, solutions of different
// accuracy can be compared.
#ifndef TETLAP_FEM_SPARSE_WEAR_H
#define TETLAP_FEM_SPARSE_WEAR_H

#include <math.h>
#include <stdbool.h>

// The largest relative residual that is allowed, even where Newton's method would accept a larger one: the
// rate at which Newton's method converges must stay visible.
static const double FEM_WEAR_LOOSEST = 0.03;

typedef struct FemWear {
  bool is_worn;     // to be made anew at the next factorise
  bool is_fresh;    // has not solved yet
  double new_count; // iterations a digit of its first solve
} FemWear;

// The relative residual of the next solution, of a solver whose own is `tolerance` (FemSolverOps.aim).
static inline double fem_wear_aim(double tolerance, double aim) {
  return fmin(fmax(aim, tolerance), FEM_WEAR_LOOSEST);
}

// Made anew.
static inline void fem_wear_renew(FemWear *wear) {
  *wear = (FemWear){.is_fresh = true, .new_count = wear->new_count};
}

// After a solution to the relative residual `tolerance`. Worn: iterations are more than half beyond those of
// when it was new, and some.
static inline void fem_wear_note(FemWear *wear, long long iterations, double tolerance) {
  const double SHARE = 1.5, MORE = 2;
  double digits = -log10(tolerance);
  if (wear->is_fresh) wear->new_count = (double)iterations / digits;
  wear->is_fresh = false;
  wear->is_worn = (double)iterations > SHARE * wear->new_count * digits + MORE;
}

#endif
