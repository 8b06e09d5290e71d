// SPDX-License-Identifier: Apache-2.0
// The analytic centre of eight half-spaces, c = argmax Σ_k log s_k, by Newton's method.
//
// With m_k = ∇s_k / s_k the gradient is Σ m_k and the Hessian −Σ m_k m_kᵀ. A step moves slack k to
// s_k (1 + α r_k), r = P 1 with P the projector onto the columns of m: slacks are scaled, never subtracted,
// and the point itself is not needed.
//
// Where the overlap is a slice between planes 1e-9 apart, m has rows 1e9 times larger than others. Their
// rounding errors enter the other slacks and add up: the four slacks of a tetrahedron sum to 1 + 1e-8. The
// pair would have a net force of that size. So at the end the sum is made 1 by the least relative changes,
// each slack's in proportion to itself; the small slacks of the slice, which determine the volume, hardly
// change.
#ifndef TETLAP_OVERLAP_GEO_CENTRE_H
#define TETLAP_OVERLAP_GEO_CENTRE_H

#include <stdbool.h>

#include "overlap/geo/constants.h"
#include "overlap/geo/lanes.h"

// Moves `slack`, all positive at the start, to the centre. Returns the number of steps, 0 if it did not
// converge.
int overlap_geo_centre(const GeoColumns *normal, double slack[GEO_LANES]);

// The columns of m are replaced by an orthonormal basis of their span (Gram–Schmidt, each column
// orthogonalised `passes` times); `length` gets the diagonal of R in m = Q R.
void overlap_geo_centre_orthonormalise(GeoColumns *m, int passes, double length[3]);

#endif
