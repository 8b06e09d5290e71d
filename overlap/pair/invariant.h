// SPDX-License-Identifier: Apache-2.0
// Invariants of the overlap volume V of two tetrahedra and its gradient, whatever the model. By how much a
// result violates each is relative to the pair's own size, so that each model can have its own tolerance. A
// NaN stays a NaN. Pairs x (2, 4, 3) [m].
#ifndef TETLAP_OVERLAP_PAIR_INVARIANT_H
#define TETLAP_OVERLAP_PAIR_INVARIANT_H

double overlap_invariant_tet_volume(const double tet[12]);

double overlap_invariant_smaller_volume(const double x[24]);

// The longest distance between two of the eight vertices: the length that residuals are relative to.
double overlap_invariant_extent(const double x[24]);

// How far V leaves [0, smaller volume], relative to the smaller volume, but for the rounding of that.
double overlap_invariant_bounds(const double x[24], double volume);

// |Σ ∇V| / L²: a translation of both changes nothing.
double overlap_invariant_translation(const double x[24], const double gradient[24]);

// |Σ x × ∇V| / L³: nor does a rotation. Positions are taken from the first vertex.
double overlap_invariant_rotation(const double x[24], const double gradient[24]);

// |Σ x·∇V − 3V| / L³: V is homogeneous of degree three.
double overlap_invariant_scaling(const double x[24], double volume, const double gradient[24]);

// How far from the true V a double-precision model may be: 1e-9 of V above a millionth of the smaller volume,
// else 1e-12 of the smaller volume.
double overlap_invariant_allowed(const double x[24], double reference);

#endif
