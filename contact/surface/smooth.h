// SPDX-License-Identifier: GPL-3.0-or-later
// A body's surface as smooth as the body is meant to be, of linear tetrahedra: for contact alone, edges and
// faces on a curved surface are divided, and the new points lie on a surface estimated from the mesh.
//
// An edge between two faces that make less than the crease angle is divided into 2^level parts at points that
// both rings of vertices round its ends carry (contact/surface/fit.h): exact for quadratics at rest and for
// whatever quadratic motion. A crease runs through its vertices as a polynomial curve and ends at corners.
// An edge that is straight stays whole, so a body of flat faces stays as it is. A point keeps within a
// quarter of the height of the tetrahedra at the surface; further in where a cell would be inside out.
//
// So carried, an even pressure would load vertices unevenly where the mesh is irregular or ends: the mean way
// off the chords, μ_i = Σ_f ∫_f (x − chord) dA / Σ_f A_f over the faces f round vertex i, linear in the
// vertices, is taken from the vertex and from its share of the points round it, and its value at rest,
// carried by the tetrahedra at these faces, is added. Nothing moves at rest or under an affine motion, and
// what an even pressure puts on a vertex is a third of the area of its faces.
//
// A tetrahedron with a divided edge is cut into cells: from a corner that is on none of them, where it has no
// face on the curved surface; else from a point o inside, at λ_f = δ/height_f for the faces on the surface, ¼
// for the others, δ as in contact/surface/mesh.h. Which triangles a face is cut into depends on the face
// alone, so neighbours fit.
#ifndef TETLAP_CONTACT_SMOOTH_H
#define TETLAP_CONTACT_SMOOTH_H

#include "contact/def.h"
#include "contact/surface/skin.h"

enum {
  CONTACT_SMOOTH_ROW_COUNT = 512, // vertices that carry one, at most
  CONTACT_SMOOTH_MOST_LEVEL = 2,
  CONTACT_SMOOTH_MOST_CELLS = 1 << (2 * CONTACT_SMOOTH_MOST_LEVEL + 2), // of four faces
  CONTACT_SMOOTH_INSIDE = -1,                                           // o
};

typedef struct ContactSmooth {
  const ContactSystemDef *def; // borrowed
  ContactSkin skin;
  int parts;        // of a divided edge
  double crease;    // [rad]
  int curved_count; // divided edges
  bool *is_curved;  //                                                    (edge_count)
  double *shares;   // how much of its way off the chord a point of an edge goes    (edge_count)
  double *bulges;   // how far an edge's middle would go [m]                        (edge_count)
  int *edge_points; // the first of an edge's parts − 1 points                      (edge_count)
  int *face_points; // the first of a face's three; −1: none                        (face_count)
  bool *is_near;    // the vertex ends a divided edge; from the body's first on     (vertex_count)
  // A point's vertices and weights: begin[p] … begin[p + 1], the corners of its edge or face first.
  int point_count;
  int *begin, *nodes;
  double *weights;
  int *owns;           // how many corners: 2 or 3                                       (point_count)
  double (*priors)[3]; // their weights on the chord                                  (point_count)
  double *chosen;      // share of the way off the chord                                 (point_count)
  size_t begin_capacity, node_capacity, weight_capacity, own_capacity, prior_capacity, chosen_capacity;
} ContactSmooth;

// A tetrahedron in cells. Vertices below def->vertex_count are the body's, those from there on the points.
typedef struct ContactSmoothCut {
  int count;
  int cells[CONTACT_SMOOTH_MOST_CELLS][4];
  bool has_inside;
  double inside[4]; // weights of the corners for o
  double depth;     // of o below the surface [m]; INFINITY: to be measured
} ContactSmoothCut;

// Of a body of linear tetrahedra, 1 ≤ level ≤ CONTACT_SMOOTH_MOST_LEVEL. A zeroed one can be destroyed.
Status contact_smooth_create(ContactSmooth *smooth, const ContactSystemDef *def, const ContactBody *body,
                             int level, double crease);
void contact_smooth_destroy(ContactSmooth *smooth);

// False: it stays whole.
bool contact_smooth_cut(const ContactSmooth *smooth, int tet, ContactSmoothCut *cut);

// How far the points' way off the chords takes a vertex itself: a row of vertices and weights, whose sum is 0
// at rest and under every affine motion. `row` has room for CONTACT_SMOOTH_ROW_COUNT. See above.
typedef struct ContactSmoothRow {
  int count;
  int nodes[CONTACT_SMOOTH_ROW_COUNT];
  double weights[CONTACT_SMOOTH_ROW_COUNT];
} ContactSmoothRow;
void contact_smooth_settle(const ContactSmooth *smooth, int vertex, double share, ContactSmoothRow *row);

// Adds a weight of a vertex; to the first one's where there is no room.
void contact_smooth_row_add(ContactSmoothRow *row, int vertex, double weight);

// How many vertices carry a point, which, the corners first, and by which weights (CONTACT_FIT_MOST_COUNT).
int contact_smooth_carry(const ContactSmooth *smooth, int point, const int **nodes, double *weights);

#endif
