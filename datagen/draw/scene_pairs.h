// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs as contact of two bodies makes them: elements of the boundary layers of two jittered meshes that are
// pressed together.
//
// A mesh is a lattice of cubes over all of space, six tetrahedra a cube (Kuhn's: the paths along edges from
// one corner to the opposite), every vertex moved by up to 0.15 edges in each coordinate. The lower one fills
// z < 0 with edge 1; the upper one has an edge log-uniform in [1/2, 2], is turned about z by any angle and
// tilted by up to 0.2 rad, and is pressed in to a depth log-uniform in [1e-3, 0.6] of the smaller edge. Two
// cells are taken that lie over each other and a tetrahedron of each, with overlapping boxes: what a broad
// phase would hand on. The pair is then turned at random and scaled and moved so that its bounding cube is
// the unit cube: V is that of the scaled pair.
#ifndef TETLAP_DATAGEN_DRAW_SCENE_PAIRS_H
#define TETLAP_DATAGEN_DRAW_SCENE_PAIRS_H

#include <stdbool.h>

#include "base/random.h"

// One attempt; false: the boxes do not overlap, try again.
bool datagen_scene_pairs_try(Random *random, double pair[24]);

#endif
