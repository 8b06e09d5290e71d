// SPDX-License-Identifier: GPL-3.0-or-later
// How deep the middle of a body lies below its surface, at a place: half of its thickness there.
//
// From a vertex of the surface the way goes to the deepest vertex of the contact mesh beside it. Then it
// goes inwards along the steepest edge while the depth φ rises by at least half of that edge's length.
// Straight inwards φ rises by all of it, along the middle of a wedge by the sine of half of its angle. So
// the way ends in the middle, and not in a thicker part of the body. A cell has the largest depth that the
// ways from its tetrahedron's vertices, and its own virtual vertex, lead to.
#ifndef TETLAP_CONTACT_SURFACE_MIDDLE_H
#define TETLAP_CONTACT_SURFACE_MIDDLE_H

#include "contact/surface/mesh.h"

// Of each cell [m], into a new array, the caller's (cell_count). `tets` (tet_count, 4) and `rest`
// (position_count, 3) are those of the layout. STATUS_MEMORY.
Status contact_middle_find(const ContactMesh *mesh, const int (*tets)[4], const double *rest,
                           double **middles);

#endif
