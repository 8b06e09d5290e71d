// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a body at rest: the faces that only one of its tetrahedra has, how far points are from them,
// and where rays meet them. Both are found in a tree of boxes over the triangles.
#ifndef TETLAP_CONTACT_SURFACE_SURFACE_H
#define TETLAP_CONTACT_SURFACE_SURFACE_H

#include <stddef.h>

#include "base/status.h"
#include "base/vec3.h"

typedef struct ContactSurfaceFace {
  int vertices[3]; // increasing
  int tet, corner; // whose face it is, and the vertex of it that lies opposite: 0 … 3
} ContactSurfaceFace;

typedef struct ContactSurface {
  int count;
  ContactSurfaceFace *faces; // (count)
  // Of the tree; made by contact_surface_index.
  const double *rest; // borrowed [m]                         (vertex, 3)
  double (*boxes)[6]; // of the tree's nodes                  (node_count)
  int (*ranges)[2];   // faces that a node holds              (node_count)
  int (*children)[2]; // −1: a leaf                           (node_count)
  int node_count;
} ContactSurface;

// The faces of tets[begin … end] that are no other's. A zeroed one can be destroyed.
Status contact_surface_find(ContactSurface *surface, const int (*tets)[4], int begin, int end);
void contact_surface_destroy(ContactSurface *surface);

// Builds the tree at these positions, which must stay; the faces are put into its order.
Status contact_surface_index(ContactSurface *surface, const double *rest);

// How far x is from the nearest face [m]; INFINITY without faces.
double contact_surface_distance(const ContactSurface *surface, Vec3 x);

// The least t > 0 at which the ray x + t d meets a face other than `besides`, d of length 1; INFINITY: it
// meets none. What meets an edge, to rounding, meets its faces.
double contact_surface_meet(const ContactSurface *surface, const ContactSurfaceFace *besides, Vec3 x, Vec3 d);

#endif
