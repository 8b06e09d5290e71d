// SPDX-License-Identifier: GPL-3.0-or-later
// An approximate inverse of S = K + c D + c² M, with K and D of an earlier step, that serves many steps.
// Where mass dominates (fem/gradient/path/dominance.h), conjugate gradients with the c of the step; else a
// factor with the c of the earlier step.
#ifndef TETLAP_FEM_GRADIENT_PATH_INVERSE_H
#define TETLAP_FEM_GRADIENT_PATH_INVERSE_H

#include "fem/sparse/cg.h"
#include "fem/statics/equilibrium.h"

typedef struct FemInverse {
  FemEquilibrium equilibrium;
  FemCg cg;
  double *diagonal;       // of S, where mass dominates                  (n)
  bool is_made, is_light; // is_light: mass dominates; S is the system's matrix
  double c;               // of S or of the factor [1/s]
  double least;           // c down to which S serves
} FemInverse;

// Of no state yet. `system` and `state` are borrowed. Destroy it also after a failure.
Status fem_inverse_create(FemInverse *inverse, FemSystem *system, FemState *state);
void fem_inverse_destroy(FemInverse *inverse); // also of a zeroed one
// Forgets what was made, with all that the next one could depend on.
Status fem_inverse_forget(FemInverse *inverse);

// At time, u and v; the system's matrix must then stay as it is. RETRY: not positive definite.
Status fem_inverse_make(FemInverse *inverse, double time, const double *u, const double *v, double c);
// Whether what was made serves a step with this c.
bool fem_inverse_serves(const FemInverse *inverse, double c);
// x ≈ S⁻¹ b; by conjugate gradients to `tolerance` of b. b and x must not overlap.
Status fem_inverse_solve(FemInverse *inverse, double c, double tolerance, const double *b, double *x);

#endif
