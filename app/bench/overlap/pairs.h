// SPDX-License-Identifier: GPL-3.0-or-later
// The sets of pairs that overlap models are measured on. The same numbers give the same pairs, everywhere.
//
//   uniform   vertices uniform in the unit cube, kept if the two intersect
//   disjoint  the same, kept if the two do not intersect although their boxes do
//   near      shallow contact of two meshes of unit and of 0.77 edges: lattices of six tetrahedra a cell, the
//             second turned by 0.4 rad about the common normal, every vertex moved by up to 0.15 edges in
//             each coordinate, pressed together by 0.1; a tetrahedron of each boundary layer, kept if they
//             intersect
#ifndef TETLAP_APP_BENCH_OVERLAP_PAIRS_H
#define TETLAP_APP_BENCH_OVERLAP_PAIRS_H

#include <stdint.h>

#include "base/status.h"

enum { APP_BENCH_NEAR, APP_BENCH_UNIFORM, APP_BENCH_DISJOINT, APP_BENCH_SET_COUNT };
extern const char *const app_bench_sets[APP_BENCH_SET_COUNT]; // "near", "uniform", "disjoint"

// Fills `pairs` (count, 2, 4, 3), the caller's. STATUS_USAGE: no set has that name.
Status app_bench_pairs_make(const char *set, int count, uint64_t seed, double *pairs);

// The same, but only the first APP_BENCH_DIFFERENT_PAIRS are made, and repeated: for sizes that no other way
// would be ready in time, and still more different pairs than a processor remembers.
enum { APP_BENCH_DIFFERENT_PAIRS = 1 << 16 };
Status app_bench_pairs_fill(const char *set, int count, uint64_t seed, double *pairs);

#endif
