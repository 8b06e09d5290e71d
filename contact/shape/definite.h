// SPDX-License-Identifier: GPL-3.0-or-later
// Symmetric matrices of a tetrahedron's twelve coordinates: derivatives of a gradient by central differences,
// positive semidefinite but for rounding.
#ifndef TETLAP_CONTACT_SHAPE_DEFINITE_H
#define TETLAP_CONTACT_SHAPE_DEFINITE_H

enum { CONTACT_DEFINITE_SIZE = 12 };

// The gradient (12) at a tetrahedron (4, 3).
typedef void ContactDefiniteGradient(const void *self, const double tet[12], double gradient[12]);

// Its derivative (12, 12), made symmetric, by central differences over a share of the longest edge.
void contact_definite_differentiate(ContactDefiniteGradient *gradient, const void *self, const double tet[12],
                                    double matrix[144]);

// Where `matrix` (12, 12), symmetric, has an eigenvalue below about −CONTACT_FLAT times its largest diagonal
// entry, all negative ones become 0: the nearest positive semidefinite matrix in Frobenius' norm (Higham
// 1988). Less is what differences leave.
void contact_definite_mend(double matrix[144]);

#endif
