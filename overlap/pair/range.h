// SPDX-License-Identifier: Apache-2.0
// What pairs a model was made for, in three measures of a pair. For a TetrahedronPairNet it is a normalised
// one (overlap/tpn/normalise.h), for a model of the user's the pair as it stands.
//
//   radius   root mean square distance of the eight vertices from the first tetrahedron's centroid
//   volume   of each of the two tetrahedra (with Unit the first is 1/6 always)
//   overlap  V'
//
// Each measure's range leaves out the rarest pairs at either end: the normalised coordinates of random pairs
// have heavy tails, and a box around all of them would refuse nothing. The measures do not depend on the
// order of vertices, and have derivatives wherever a tetrahedron has a volume. Of `axis` they are those of
// the coordinates that the network is shown, where two edges separate best not of the second tetrahedron
// itself.
#ifndef TETLAP_OVERLAP_PAIR_RANGE_H
#define TETLAP_OVERLAP_PAIR_RANGE_H

#include <stdbool.h>

#include "overlap/pair/bend.h"

enum { OVERLAP_RANGE_TEXT = 256 };

typedef struct OverlapRange {
  double radius[2];    // least, most
  double volume[2][2]; // of the first and of the second tetrahedron: least, most
  double overlap;      // most
} OverlapRange;

// The measures of one normalised pair.
typedef struct OverlapRangeMeasures {
  double radius, volume[2];
} OverlapRangeMeasures;

OverlapRangeMeasures overlap_range_measure(const double pair[24]);

// The range of `count` > 0 pairs by their measures, and of their overlaps where these are > 0. Sorts `values`
// (count), which is scratch memory.
OverlapRange overlap_range_of(int count, const OverlapRangeMeasures *measures, const double *overlaps,
                              double *values);

// As a weights file's card has it.
void overlap_range_print(const OverlapRange *range, char text[OVERLAP_RANGE_TEXT]);
bool overlap_range_parse(const char *text, OverlapRange *range);

// 1 within the range, 0 beyond by the factor 1.5 in any measure, continuously
// differentiable in between; NaN: 0. `gradient` and `hessian` (24, 24) are by the normalised pair; the second
// or both may be NULL.
double overlap_range_weight(const OverlapRange *range, const double pair[24], double *gradient,
                            double *hessian);
// The same of the overlap V' ≥ 0 alone, with its derivatives by it.
OverlapBend overlap_range_overlap_weight(const OverlapRange *range, double overlap);

#endif
