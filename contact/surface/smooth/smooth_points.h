// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a smooth surface (contact/surface/smooth/smooth.h): which edges are divided, where the new
// points lie, and which vertices carry them.
#ifndef TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_POINTS_H
#define TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_POINTS_H

#include "base/vec3.h"
#include "contact/def.h"
#include "contact/surface/skin.h"

enum { CONTACT_SMOOTH_MOST_LEVEL = 2 };

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

// Of a body of linear tetrahedra, 1 ≤ level ≤ CONTACT_SMOOTH_MOST_LEVEL. A zeroed one can be destroyed.
Status contact_smooth_points_create(ContactSmooth *smooth, const ContactSystemDef *def,
                                    const ContactBody *body, int level, double crease);
void contact_smooth_points_destroy(ContactSmooth *smooth);

// How many vertices carry a point, which, the corners first, and by which weights (CONTACT_FIT_MOST_COUNT).
int contact_smooth_points_carry(const ContactSmooth *smooth, int point, const int **nodes, double *weights);

// Where a vertex or a point lies at rest: vertices are numbers below def->vertex_count, points those from
// there.
Vec3 contact_smooth_points_place(const ContactSmooth *smooth, int vertex);

// Lets the points of an edge go no farther off the chord than this share of their way.
void contact_smooth_points_draw(ContactSmooth *smooth, int edge, double share);

// Lets the points within faces go no farther than those of their edges.
void contact_smooth_points_follow(ContactSmooth *smooth);

#endif
