// SPDX-License-Identifier: GPL-3.0-or-later
// Where mass dominates in S = K + c² M. In Jacobi's scaling all eigenvalues of S lie within 1 ± e, e the
// largest sum of the absolute values of a row beside its diagonal over that (Gershgorin). c is large in short
// steps. With e ≤ 0.3 each iteration of conjugate gradients, or of GMRES, leaves at most 0.16 of the error,
// for one product, which costs a fraction of a solution by the factor; at its worst the error of 1e-12 takes
// 15 products, as much as six solutions by a factor of an earlier step.
#ifndef TETLAP_FEM_GRADIENT_PATH_DOMINANCE_H
#define TETLAP_FEM_GRADIENT_PATH_DOMINANCE_H

#include "fem/effect/system.h"

// The least c with which that is so. K: `stiffness`, of which the unknown i is places[i]; NULL: i. `rows`:
// scratch (stiffness->size).
double fem_dominance_least(const FemSystem *system, const FemMatrix *stiffness, const int *places,
                           double *rows);

#endif
