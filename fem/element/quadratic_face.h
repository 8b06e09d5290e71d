// SPDX-License-Identifier: GPL-3.0-or-later
// A face of a quadratic tetrahedron: six nodes, the corners 0, 1, 2, outward, and the middles 3, 4, 5 of the
// edges 01, 12, 20. Under load it is curved. A pressure p does the work −p dV of the volume that faces bound.
// So its nodal forces are f_a = −p ∂V/∂x_a = −p ∫ N_a x,ξ × x,η dξ dη. That is a polynomial of the fourth
// degree, which six points integrate exactly (Cowper 1973).
#ifndef TETLAP_FEM_ELEMENT_QUADRATIC_FACE_H
#define TETLAP_FEM_ELEMENT_QUADRATIC_FACE_H

enum { FEM_QUADRATIC_FACE_NODES = 6 };

// What each node takes of a uniform traction [m²]: ∫ N_a over the area; of a straight face 0 at corners and a
// third of the area at middles. Nodes' positions x (6, 3).
void fem_quadratic_face_share(const double x[18], double share[6]);

// ∂V/∂x at the nodes' positions x (6, 3); the areas' sum where p is 1 [m²].
void fem_quadratic_face_area(const double x[18], double area[18]);

// p ∂²V/∂x², the symmetric part, (18, 18): over a surface that is closed or held at its rim the parts left
// out cancel.
void fem_quadratic_face_stiffness(double pressure, const double x[18], double stiffness[324]);

#endif
