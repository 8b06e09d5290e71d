// SPDX-License-Identifier: Apache-2.0
// How far apart two tetrahedra are along the best of the 44 axes of the separating axis theorem (the 8 face
// normals, the 36 cross products of edges; Gottschalk, Lin, Manocha 1996): positive if they are disjoint,
// 0 if they touch, minus the smallest overlap of the projections if they have a common interior. Never more
// than the distance, and equal to it where a face is one of the nearest features, or two edges are.
#ifndef TETLAP_OVERLAP_SEPARATION_H
#define TETLAP_OVERLAP_SEPARATION_H

#include <stdbool.h>

// Separation of a pair (2, 4, 3) [m]. The search ends early once it exceeds `enough`: the answer is then a
// lower bound that is itself > enough. INFINITY: all axes.
double overlap_separation_pair(const double pair[24], double enough);

// The lowest height of a tetrahedron above a half-space [m]; negative: some of it lies below.
double overlap_separation_halfspace(const double tet[12], const double point[3], const double normal[3]);

// Whether both certainly have volume and a face certainly separates them: all of one lies beyond a face plane
// of the other by more than rounding. Cheaper than any overlap model; false: not known.
bool overlap_separation_is_certain(const double pair[24]);

// The same of `count` pairs (count, 2, 4, 3), several at once where the processor can: is_apart (count). What
// is beyond doubt may differ in the last places.
void overlap_separation_find(int count, const double *pairs, bool *is_apart);

#endif
