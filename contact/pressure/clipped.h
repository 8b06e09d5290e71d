// SPDX-License-Identifier: GPL-3.0-or-later
// The intersection P of two cells as a polyhedron (overlap/clip/polytope.h), cut into triangles on its faces
// and pyramids over them, with barycentric coordinates of the tetrahedra that the cells are part of.
#ifndef TETLAP_CONTACT_PRESSURE_CLIPPED_H
#define TETLAP_CONTACT_PRESSURE_CLIPPED_H

#include <stdbool.h>

#include "contact/search/layout.h"
#include "overlap/clip/polytope.h"

// A triangle of P's boundary on face `face` of one of the cells, 0–3 of A, 4–7 of B.
typedef struct ContactTriangle {
  unsigned char face, vertex[3];
  double share; // its area over that of the whole face
} ContactTriangle;

enum { CONTACT_TRIANGLES = 2 * OVERLAP_CLIP_EDGES };

typedef struct ContactClipped {
  const ContactLayout *layout; // borrowed
  const ContactPair *pair;     // borrowed
  OverlapClipPolytope polytope;
  int triangle_count;
  ContactTriangle triangles[CONTACT_TRIANGLES];
  double lanes[OVERLAP_CLIP_VERTICES][8]; // of the polytope's vertices, folded to the tetrahedra's
  bool is_folded[OVERLAP_CLIP_VERTICES];
} ContactClipped;

// False: the two have no volume in common, or double precision cannot tell.
bool contact_clipped_make(ContactClipped *clipped, const ContactLayout *layout, const ContactPair *pair,
                          const double coordinates[24]);

// λ of the two tetrahedra's eight vertices at a vertex of P.
const double *contact_clipped_lanes(ContactClipped *clipped, int vertex);

// The apex of all pyramids, a vertex of P; and the volume of the one over a triangle [m³].
static inline int contact_clipped_apex(const ContactClipped *clipped) {
  return clipped->polytope.edge[0].from;
}
double contact_clipped_pyramid(const ContactClipped *clipped, const ContactTriangle *triangle);

#endif
