// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric matrices of a tetrahedron's twelve coordinates that are positive semidefinite but for rounding.
#ifndef TETLAP_CONTACT_DEFINITE_H
#define TETLAP_CONTACT_DEFINITE_H

enum { CONTACT_DEFINITE_SIZE = 12 };

// What differences may leave of a negative eigenvalue, as a share of the largest diagonal entry. In a flat
// cell rounding leaves more, for the gradient's own is divided by the step and grows with rest volume over
// volume.
#define CONTACT_DEFINITE_ROUGH 1e-4

// Where `matrix` (12, 12), symmetric, has an eigenvalue below about −`tolerance` times its largest diagonal
// entry, all negative ones become 0: the nearest positive semidefinite matrix in Frobenius' norm (Higham
// 1988).
void contact_definite_mend(double matrix[144], double tolerance);

#endif
