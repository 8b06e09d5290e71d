// SPDX-License-Identifier: GPL-3.0-or-later
// A body's surface as smooth as the body is meant to be, of linear tetrahedra. For contact alone, edges and
// faces on a curved surface are divided, and the new points lie on a surface estimated from the mesh.
//
// An edge between two faces that make less than the crease angle is divided into 2^level parts at points that
// both rings of vertices round its ends carry (contact/surface/smooth/fit.h): exact for quadratics at rest
// and for whatever quadratic motion. A crease runs through its vertices as a polynomial curve and ends at
// corners. An edge that is straight stays whole, so a body of flat faces stays as it is. A point keeps within
// a quarter of the height of the tetrahedra at the surface; further in where a cell would be inside out.
//
// So carried, an even pressure would load vertices unevenly where the mesh is irregular or ends. The mean
// way off the chords round vertex i is μ_i = Σ_f ∫_f (x − chord) dA / Σ_f A_f over the faces f there, linear
// in the vertices. It is taken from the vertex and from its share of the points round it. Its value at rest,
// carried by the tetrahedra at these faces, is added. Nothing moves at rest or under an affine motion, and
// what an even pressure puts on a vertex is a third of the area of its faces.
//
// A tetrahedron with a divided edge is cut into cells: from a corner that is on none of them, where it has no
// face on the curved surface; else from a point o inside, at λ_f = δ/height_f for the faces on the surface, ¼
// for the others, δ as in contact/surface/mesh.h. Which triangles a face is cut into depends on the face
// alone, so neighbours fit.
#ifndef TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_H
#define TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_H

#include "contact/surface/smooth/smooth_points.h"

enum {
  CONTACT_SMOOTH_MOST_CELLS = 1 << (2 * CONTACT_SMOOTH_MOST_LEVEL + 2), // of four faces
  CONTACT_SMOOTH_INSIDE = -1,                                           // o
};

// A tetrahedron in cells. Vertices below def->vertex_count are the body's, those from there on the points.
typedef struct ContactSmoothCut {
  int count;
  int cells[CONTACT_SMOOTH_MOST_CELLS][4];
  bool has_inside;
  double inside[4]; // weights of the corners for o
  double depth;     // of o below the surface [m]; INFINITY: to be measured
} ContactSmoothCut;

// Points and cells of a body of linear tetrahedra, 1 ≤ level ≤ CONTACT_SMOOTH_MOST_LEVEL. Destroyed as its
// points are (contact_smooth_points_destroy).
Status contact_smooth_create(ContactSmooth *smooth, const ContactSystemDef *def, const ContactBody *body,
                             int level, double crease);

// False: it stays whole.
bool contact_smooth_cut(const ContactSmooth *smooth, int tet, ContactSmoothCut *cut);

#endif
