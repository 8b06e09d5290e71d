// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss's linking integral of two open lines, by which a passage of one through the other shows: it changes
// steadily while they move around one another, and jumps by one where they pass.
#ifndef TETLAP_APP_STRESS_LINKING_H
#define TETLAP_APP_STRESS_LINKING_H

// Of two polygons of points a (a_count, 3), b (b_count, 3) that do not touch, in turns. Exact for polygons
// (Klenin and Langowski 2000, Biopolymers 54, eq. 13–16).
double app_stress_linking(const double *a, int a_count, const double *b, int b_count);

#endif
