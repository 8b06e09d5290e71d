// SPDX-License-Identifier: Apache-2.0
// How large two tetrahedra are, in double precision.
#ifndef TETLAP_OVERLAP_PAIR_SIZES_H
#define TETLAP_OVERLAP_PAIR_SIZES_H

// The volume of the smaller of a pair (2, 4, 3) [m] [m³].
double overlap_sizes_smaller(const double pair[24]);

#endif
