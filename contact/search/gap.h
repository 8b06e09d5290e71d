// SPDX-License-Identifier: GPL-3.0-or-later
// How far the vertices of a surface are from what they may touch: from the triangles of another body's
// surface, or the surface of an obstacle without elements. Potential `field` only.
#ifndef TETLAP_CONTACT_SEARCH_GAP_H
#define TETLAP_CONTACT_SEARCH_GAP_H

#include "contact/search/candidates.h"
#include "contact/surface/stars.h"

// Lowers `gaps` [m] (given vertex_count) to the distance of each given vertex from the nearest of its
// candidates, of those that the lists are sure to hold at this time and these positions (position_count, 3):
// no more than what is left of the interface's margin. Inside of another body 0. Others are left as they are.
void contact_gap_find(ContactCandidates *candidates, const ContactLayout *layout, const ContactStars *stars,
                      double time, const double *positions, double *gaps);

#endif
