// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs that come in other units, brought into the unit cube that data sets are made in.
#ifndef TETLAP_DATAGEN_DRAW_CUBE_H
#define TETLAP_DATAGEN_DRAW_CUBE_H

// The bounding box of `count` points (count, 3).
void datagen_cube_box(const double *points, int count, double low[3], double high[3]);

// Scales and moves the pair so that its box's longest side is 1 and lies in the unit cube; where along the
// shorter sides, `place` says, 0 … 1. Returns the factor of lengths; volumes have its cube. 0: all vertices
// coincide, nothing was done.
double datagen_cube_fit(double pair[24], const double place[3]);

#endif
