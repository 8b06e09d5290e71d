// SPDX-License-Identifier: Apache-2.0
// Constants of `geo` that processors and devices share: its text is also part of what a device compiles, so
// it includes nothing.
#ifndef TETLAP_OVERLAP_GEO_CONSTANTS_H
#define TETLAP_OVERLAP_GEO_CONSTANTS_H

#ifndef CONSTANT
#define CONSTANT static const
#endif

// --- The gate.
// A tetrahedron with det < OVERLAP_GEO_FLATTEST · (longest edge)³ is left to the exact model.
#define OVERLAP_GEO_FLATTEST 1e-5
#define OVERLAP_GEO_LEAST_DET 1e-280 // [m³]; below it dividing may overflow
// Barycentric coordinates carry errors of some ε L³/det, L the tetrahedron's longest edge: the products of
// three lengths that they are quotients of are rounded, and det is small beside them if it is flat. What is
// no farther out than OVERLAP_GEO_ROUNDING L³/det, and OVERLAP_GEO_NOISE at least, counts as on the plane.
#define OVERLAP_GEO_NOISE 1e-13
#define OVERLAP_GEO_ROUNDING 0x1p-48 // 16 ε: about ten roundings in a height
// A point this close to a plane is on it.
#define OVERLAP_GEO_LEAST_SLACK 1e-15

// --- The centre.
enum { OVERLAP_GEO_MAX_STEPS = 40 };
// Newton's decrement δ = (gᵀ H⁻¹ g)^½: up to FULL_STEP the whole step is taken, and the step from a point
// with δ < CONVERGED ends at δ² or so.
#define OVERLAP_GEO_FULL_STEP 0.2
#define OVERLAP_GEO_CONVERGED 1e-7
// Of the way to the nearest plane.
#define OVERLAP_GEO_LONGEST_STEP 0.99

// --- The frame.
// How far tr P, which is 3, may be off.
#define OVERLAP_GEO_TRACE_TOLERANCE 1e-6
// An overlap this small beside a tetrahedron, 1e-12 wide all around, is the rounding of its coordinates.
#define OVERLAP_GEO_LEAST_SHARE 1e-36

// --- Coplanar faces.
// r₀ of faces that look the same way, and of faces that look at each other. For the first the network's error
// grows below r ≈ 0.4. For the second it is small, and only the begin of the overlap needs the exact volume.
#define OVERLAP_GEO_REACH_SAME 0.3
#define OVERLAP_GEO_REACH_FACING 0.03

// --- The centroid.
// The centroid is inside: no slack becomes less than 1 − this of what it is at the centre.
#define OVERLAP_GEO_LONGEST_SHIFT 0.99

#endif
