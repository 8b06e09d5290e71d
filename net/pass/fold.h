// SPDX-License-Identifier: Apache-2.0
// A tpn that always meets the same first tetrahedron, as the normalisations that make it the unit simplex do:
// what the network makes of that tetrahedron is computed once. Vertex and tetrahedron layers then run over
// the second one only.
//
//   first ──► vertices, pool, tetrahedron layers ──► features, a constant of the pool over tetrahedra
//         ──► the combiner's skip ──► its bias
//
// The folded network takes the second tetrahedron's 12 coordinates and gives the same outputs, up to the
// order in which the skip is summed, and their derivatives by those 12. It is evaluated like any other
// (forward.h, tangent.h); it is neither trained nor written to a file.
#ifndef NET_FOLD_H
#define NET_FOLD_H

#include "net/model/model.h"

#include "net/real_f32.h"

#include "net/pass/fold_template.h"

#include "net/real_f64.h"

#include "net/pass/fold_template.h"

#endif
