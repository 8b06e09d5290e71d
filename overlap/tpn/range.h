// SPDX-License-Identifier: Apache-2.0
// What pairs a network of model.h was trained on, in three measures of a normalised pair (normalise.h):
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
#ifndef TETLAP_OVERLAP_TPN_RANGE_H
#define TETLAP_OVERLAP_TPN_RANGE_H

#include <stdbool.h>

#include "overlap/tpn/jet.h"

enum { OVERLAP_TPN_RANGE_TEXT = 256 };

typedef struct OverlapTpnRange {
  double radius[2];    // least, most
  double volume[2][2]; // of the first and of the second tetrahedron: least, most
  double overlap;      // most
} OverlapTpnRange;

// The measures of one normalised pair.
typedef struct OverlapTpnMeasures {
  double radius, volume[2];
} OverlapTpnMeasures;

OverlapTpnMeasures overlap_tpn_range_measure(const double pair[24]);

// The share of pairs at each end of each measure that a range leaves out.
extern const double overlap_tpn_range_tail;

// The range of `count` > 0 pairs by their measures, and of their overlaps where these are > 0. Sorts `values`
// (count), which is scratch memory.
OverlapTpnRange overlap_tpn_range_of(int count, const OverlapTpnMeasures *measures, const double *overlaps,
                                     double *values);

// As a weights file's card has it.
void overlap_tpn_range_print(const OverlapTpnRange *range, char text[OVERLAP_TPN_RANGE_TEXT]);
bool overlap_tpn_range_parse(const char *text, OverlapTpnRange *range);

// 1 within the range, 0 beyond by the factor overlap_tpn_range_band in any measure, continuously
// differentiable in between; NaN: 0. `gradient` and `hessian` (24, 24) are by the normalised pair; the second
// or both may be NULL.
double overlap_tpn_range_weight(const OverlapTpnRange *range, const double pair[24], double *gradient,
                                double *hessian);
// The same of the overlap V' ≥ 0 alone, with its derivatives by it.
OverlapTpnBend overlap_tpn_range_overlap_weight(const OverlapTpnRange *range, double overlap);

extern const double overlap_tpn_range_band;

#endif
