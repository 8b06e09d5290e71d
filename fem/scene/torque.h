// SPDX-License-Identifier: GPL-3.0-or-later
// The nodal forces of a moment T on weighted points x_i: those that would accelerate them as a rigid body of
// masses w_i,
//
//   f_i = w_i ω × (x_i − c),   J ω = T,   c the weighted centroid, J the points' inertia about it.
//
// They have no resultant, and the moment T about any point, wherever the points are: T keeps its direction in
// space, and the forces turn with the points. Their power is T · Ω, Ω the mean angular velocity J⁻¹ Σ w r ×
// v.
#ifndef TETLAP_FEM_SCENE_TORQUE_H
#define TETLAP_FEM_SCENE_TORQUE_H

// det J over the cube of the mean moment of inertia, in [0, 1]; about 0 where the points lie on a line, which
// bears no moment along it.
double fem_torque_breadth(int count, const int *vertices, const double *weights, const double *positions);

// Adds the forces of the moment [N m] to `force` (vertex_count, 3) [N]. `positions` (vertex_count, 3);
// vertices, weights (count).
void fem_torque_add_force(const double moment[3], int count, const int *vertices, const double *weights,
                          const double *positions, double *force);

#endif
