// SPDX-License-Identifier: GPL-3.0-or-later
// How the faces of a body's surface hang together: edges, creases, and the smooth part of the surface about a
// vertex.
//
// An edge is a crease where its faces' normals make more than a given angle. It is one, too, where it has no
// two faces (at a part of the boundary that is no surface) and where more than two meet. The sector of a
// vertex and a face is what is reached from that face about the vertex without crossing a crease.
#ifndef TETLAP_CONTACT_SURFACE_SKIN_H
#define TETLAP_CONTACT_SURFACE_SKIN_H

#include "base/vec3.h"
#include "contact/def.h"

typedef struct ContactSkinFace {
  int vertices[3]; // counter-clockwise from outside
  int edges[3];    // edge k is between vertices k and k + 1
  int tet, corner; // whose face it is, and the vertex of it that lies opposite
  double area;     // [m²]
  double height;   // of that tetrahedron over the face [m]
} ContactSkinFace;

typedef struct ContactSkinEdge {
  int vertices[2]; // ascending
  int faces[2];    // −1: none
  bool is_crease;
} ContactSkinEdge;

typedef struct ContactSkin {
  const double *rest; // borrowed [m]                                  (vertex, 3)
  int vertex_begin;   // of the body
  int vertex_count;
  int face_count;
  ContactSkinFace *faces; //                                            (face_count)
  int edge_count;
  ContactSkinEdge *edges; // ordered by vertices                        (edge_count)
  // Faces about vertex vertex_begin + v: begin[v] … begin[v + 1] of `list`.
  int *begin;   //                                                        (vertex_count + 1)
  int *list;    //                                                        (3 face_count)
  int *creases; // of a vertex: how many of its edges are creases       (vertex_count)
} ContactSkin;

// Of the faces of a body that are surface (`inner` in contact/def.h). `crease` [rad]. A zeroed one can be
// destroyed.
Status contact_skin_create(ContactSkin *skin, const ContactSystemDef *def, const ContactBody *body,
                           double crease);
void contact_skin_destroy(ContactSkin *skin);

// The edge between two vertices; −1: there is none.
int contact_skin_edge(const ContactSkin *skin, int a, int b);

// Lists the faces of a sector, the given one first; at most `most`, how many in all.
int contact_skin_sector(const ContactSkin *skin, int vertex, int face, int most, int *faces);

// The normal at a vertex over the faces of its sector, any length. Each face gives the cross product of its
// two edges there over the squares of their lengths (Max 1999, exact on spheres).
Vec3 contact_skin_normal(const ContactSkin *skin, int vertex, int count, const int *faces);

// The crease edge other than `edge` at a vertex where two meet and turn by less than the angle; −1: the
// vertex is a corner.
int contact_skin_next(const ContactSkin *skin, int vertex, int edge, double crease);

#endif
