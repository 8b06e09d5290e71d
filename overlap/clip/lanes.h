// SPDX-License-Identifier: Apache-2.0
// Clipping of several pairs at once, one a lane of the processor's vectors, without a branch that depends on
// a pair: how `clip` and `clip32` evaluate batches.
//
// The intersection P is bounded by eight polygons. Each is made of segments that are either part of an own
// edge of its tetrahedron or lie where a face of the one crosses a face of the other:
//
//   1. sides      barycentric coordinates of either tetrahedron's vertices in the other (32)
//   2. crossings  of each of the 12 edges with the other's planes (48), and what of the edge is inside: from
//                 the last plane that it enters by to the first that it leaves by (Liang and Barsky 1984)
//   3. segments   of face f of A and face g of B (16): both its ends are ends of edges found in 2, of one of
//                 the three edges of f that crosses g or one of the three of g that crosses f. What enters
//                 on the one side of the segment leaves on the other, which gives it a direction. An end
//                 is found in the parameters of the face whose edge it is on, and carried to the other's
//   4. each segment p q adds p × q to the areas of the two polygons that it bounds, and (p × q)(p + q) to
//                 their first moments; then clip.h's formulas for V, ∇V and x̄
//
// Every number of a corner is a convex combination with the same weights, so a wrong decision where rounding
// decides moves the corner by no more than rounding does. It may leave a polygon open, which is detected: a
// segment must have one start and one end, or neither. (Where an edge of A meets one of B, rounding may put a
// part of each inside the other, though by the orientation of the faces only one can be. Then a start is
// found twice, once on either edge.) A lane is doubtful, and left to careful clipping, where a segment has
// another number of ends; where a vertex is closer to a plane of the other than about 1e-9 (identical
// tetrahedra would each count as inside the other); where edges meet and V is not positive; where rounding
// may spoil V (clip.h); where a tetrahedron is too flat.
//
// A lane's result depends on its pair alone, and is the same for every instruction set.
#ifndef TETLAP_OVERLAP_CLIP_LANES_H
#define TETLAP_OVERLAP_CLIP_LANES_H

#include <stdint.h>

enum { OVERLAP_CLIP_MAX_LANES = 16 };

// The outcome of each lane: bit k is lane k.
typedef struct OverlapClipLanesOutcome {
  uint32_t doubtful; // ask a more careful method; the numbers mean nothing
  uint32_t disjoint; // V = 0, ∇V = 0
  uint32_t waiting;  // not answered, see below; nothing is written then
  uint32_t enclosed; // one tetrahedron lies wholly inside the other
} OverlapClipLanesOutcome;

typedef struct OverlapClipLanes {
  const char *name;
  int width; // pairs at once
  // Lanes whose two tetrahedra certainly have volume and no common interior: a face plane of one has all of
  // the other beyond it by more than rounding. The cheap first part of the two below.
  uint32_t (*separate)(const double *pairs);
  // pairs (width, 2, 4, 3) [m], volume (width) [m³], gradient (width, 2, 4, 3) [m²]. Where fewer lanes than
  // `least` are left after the first part, only `disjoint` is answered and the others are `waiting`.
  OverlapClipLanesOutcome (*measure)(const double *pairs, int least, double *volume);
  OverlapClipLanesOutcome (*differentiate)(const double *pairs, int least, double *volume, double *gradient);
  // Also x̄ (width, 3) [m], zero where there is no common interior; `gradient` may be NULL.
  OverlapClipLanesOutcome (*locate)(const double *pairs, int least, double *volume, double *gradient,
                                    double *centroid);
} OverlapClipLanes;

// The widest that this processor has in double precision and in single; NULL: none.
const OverlapClipLanes *overlap_clip_lanes(void);
const OverlapClipLanes *overlap_clip_lanes_single(void);

// All that it has, in double precision then in single; an array of `*count`.
const OverlapClipLanes *const *overlap_clip_lanes_list(int *count);

#if defined(__x86_64__)
extern const OverlapClipLanes overlap_clip_lanes_avx2, overlap_clip_lanes_avx512;
extern const OverlapClipLanes overlap_clip_lanes_avx2_single, overlap_clip_lanes_avx512_single;
#endif

#endif
