// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap model `cgal`: the seed paper's ground truth, by CGAL alone. do_intersect decides whether the
// closed tetrahedra meet; a Boolean intersection of two Nef_polyhedron_3 over exact rational coordinates
// gives the polyhedron, PMP::volume its volume. A common part without interior is V = 0, DISJOINT.
//
// The gradient is added by us. Each facet of the intersection is attributed to the input face whose plane it
// lies in, found exactly, and N_a is integrated over it in rational numbers. Facets that lie in faces of both
// count half for each, the convention of overlap/exact/exact.h. V and ∇V are correctly rounded to within 1
// ulp.
//
// A thousand times slower than `clip`: about 1000 pairs a second, 400 with the gradient. Meant for audits and
// tests. Every call builds objects of its own, so threads do not meet (ThreadSanitizer agrees). CGAL's
// intervals need directed rounding, which valgrind does not emulate: look for leaks with AddressSanitizer.
#ifndef TETLAP_OVERLAP_EXACT_CGAL_H
#define TETLAP_OVERLAP_EXACT_CGAL_H

#include "overlap/ops.h"

extern const OverlapOps overlap_cgal_ops;

#endif
