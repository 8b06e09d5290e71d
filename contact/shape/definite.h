// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric matrices of a tetrahedron's twelve coordinates: derivatives of a gradient by central differences,
// positive semidefinite but for rounding.
#ifndef TETLAP_CONTACT_DEFINITE_H
#define TETLAP_CONTACT_DEFINITE_H

enum { CONTACT_DEFINITE_SIZE = 12 };

// What differences may leave of a negative eigenvalue, as a share of the largest diagonal entry. In a flat
// cell rounding leaves more, for the gradient's own is divided by the step and grows with rest volume over
// volume.
#define CONTACT_DEFINITE_ROUGH 1e-4

// The gradient (12) at a tetrahedron (4, 3).
typedef void ContactDefiniteGradient(const void *self, const double tet[12], double gradient[12]);

// Its derivative (12, 12), made symmetric, by central differences over a share of the longest edge.
void contact_definite_differentiate(ContactDefiniteGradient *gradient, const void *self, const double tet[12],
                                    double matrix[144]);

// Where `matrix` (12, 12), symmetric, has an eigenvalue below about −`tolerance` times its largest diagonal
// entry, all negative ones become 0: the nearest positive semidefinite matrix in Frobenius' norm (Higham
// 1988).
void contact_definite_mend(double matrix[144], double tolerance);

#endif
