// SPDX-License-Identifier: Apache-2.0
// The overlap model `exact`: the volume of two tetrahedra's intersection and its gradient by exact rational
// arithmetic. The referee of the other models.
//
// What is exact. The coordinates are taken as the rational numbers that they are. Every decision is the sign
// of an integer. The four corners' brackets [w x y z] = det(x − w, y − w, z − w) over the pair's vertices
// are enough to build the intersection (pair.h). So coplanar, touching, nested, identical, sliver-shaped or
// far-scattered input takes the same path as any other, and the flags are always right.
//
// What is rounded, and how far. V and each face's part of ∇V are sums of non-negative rationals, each an
// integer quotient rounded to long double once or twice: nothing cancels. Where long double has 64 bits or
// more, V is within 1 ulp of the true volume, however small; a component of ∇V is within 1 ulp of the
// component's largest term (three faces meet at a vertex and their parts may cancel). Overflow gives
// infinity, underflow a subnormal or 0, as everywhere. x̄ is a mean of the vertices, relative to the first,
// with non-negative weights of which each has 60 digits right: within 1 ulp of its component, or 2^-58 of the
// longest difference of coordinates where that is more, however small V is.
//
// The convention for coinciding faces. If a face of A and a face of B lie in one plane with the same outward
// normal, V has one-sided derivatives only. Their common polygon counts half for the face of A and half for
// the face of B: the mean of the two sides, symmetric under exchange, and Σ ∇V = 0, Σ x × ∇V = 0,
// Σ x·∇V = 3V stay true. With opposite normals the tetrahedra have no common interior: V = 0, ∇V = 0.
//
// Flags: FLAT alone if one has no volume (exactly coplanar vertices), else DISJOINT if no common interior,
// else ENCLOSED if every vertex of one is in the other (its boundary included).
//
// How it is fast. A face that separates the two beyond doubt in double precision ends it at once. Numbers of
// few limbs, which ordinary coordinates give, are added and multiplied without GMP (integer.h), and a
// triangle's area is taken to 127 bits where that is certain to suffice (fixed.h), else to all digits.
//
// Cost: 6 to 9 µs a pair that overlaps, 0.1 µs one that a face separates; 208 kB of stack, of which ordinary
// pairs touch a few; no other memory, no state: threads share nothing.
#ifndef TETLAP_OVERLAP_EXACT_EXACT_H
#define TETLAP_OVERLAP_EXACT_EXACT_H

#include "overlap/ops.h"

extern const OverlapOps overlap_exact_ops;

#endif
