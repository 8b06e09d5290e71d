// SPDX-License-Identifier: GPL-3.0-or-later
// The area of contact of a patch: what of each one's surface lies in the other. With the potential `field`
// every outer face of a cell is cut by the other's cells, so that an overlap counts up to its very rim:
//
//   A = Σ over faces f of A's surface Σ over cells j of B |S_f ∩ j| (n_f · ĝ_B)₊,   or of B's surface in A
//
// if that is more, n_f the outward normal of the face, ĝ the direction in which the other's depth grows: a
// side of a body that has sunk in counts nothing. Along an edge of B, where depths grow from its side, A's
// surface counts less than B's. Of a shape without elements, A = Σ |S_f ∩ shape| (n_f · ĝ)₊, by triangles
// that are quartered where its surface passes. With the potential `nodal`, which knows no surface, it
// is Σ of contact_field_area.
#ifndef TETLAP_CONTACT_PRESSURE_PATCH_AREA_H
#define TETLAP_CONTACT_PRESSURE_PATCH_AREA_H

#include "contact/evaluation.h"

// [m²], of a patch of the evaluation.
double contact_area_find(const ContactLayout *layout, const ContactEvaluation *evaluation,
                         const ContactPatch *patch);

#endif
