// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh that contact works on, and on it how deep each point of a body lies below its surface.
//
// For the potential `field` that mesh is not quite the body's own. Let φ be the distance of a vertex to the
// surface, linear in between. Tetrahedra along a body's edges have four vertices on the surface, and so no
// depth at all. Elsewhere near edges the slope of φ on outer faces, which is the pressure, is off. So a
// tetrahedron with an outer face f where
//
//   |φ(apex) / height over f − 1| > .02,   or without any vertex inside,
//
// is split into four cells at a virtual vertex. Its barycentric coordinates are λ_f = δ / height_f for the
// outer faces, ¼ for the others, with δ = (number of outer faces / 4) / Σ 1/height_f; its φ is δ, so that the
// slope is 1 on each outer face. Without an outer face it is the centroid, with its distance. A virtual
// vertex moves as a fixed mean of the four real ones. So a cell deforms with its tetrahedron, and whatever
// acts on the cell acts on the four vertices of that.
//
// For the potential `nodal` the cells are the tetrahedra.
#ifndef TETLAP_CONTACT_SURFACE_MESH_H
#define TETLAP_CONTACT_SURFACE_MESH_H

#include <stddef.h>

#include "contact/def.h"

// A vertex that a tetrahedron is split at.
typedef struct ContactVirtual {
  int tet;
  double weights[4]; // of the tetrahedron's vertices
} ContactVirtual;

typedef struct ContactMesh {
  int cell_count;
  const int (*cells)[4]; // vertices, those of body b's from cell_begin[b] on             (cell_count)
  int *cell_begin;       //                                                              (body_count + 1)
  int position_count;    // vertices, then virtual ones
  // The rest with a field only.
  int (*own)[4];            // where the cells are not the tetrahedra; owned               (cell_count)
  int *tets;                // whose part a cell is; ascending                             (cell_count)
  signed char *replaced;    // which of that tetrahedron's vertices the virtual one stands for; −1: whole
                            //                                                              (cell_count)
  signed char *turns;       // the sign of its determinant at rest; 0: φ is 0 all round its tetrahedron and
                            // those that share a vertex with it                            (cell_count)
  unsigned char *outer;     // bit f: the cell's face opposite to its vertex f is on the surface  (cell_count)
  ContactVirtual *virtuals; //                                           (position_count − vertex_count)
  double *depths;           // φ at rest [m]                             (position_count)
} ContactMesh;

// Finds surfaces and depths where the definition's potential is `field`. Tetrahedra need a volume. A zeroed
// one can be destroyed.
Status contact_mesh_create(ContactMesh *mesh, const ContactSystemDef *def);
void contact_mesh_destroy(ContactMesh *mesh);

// The tetrahedron that a cell is part of.
static inline int contact_mesh_tet(const ContactMesh *mesh, int cell) {
  return mesh->tets ? mesh->tets[cell] : cell;
}

// Whether the cell is the first of its tetrahedron: it stands for the tetrahedron where that is used whole.
static inline bool contact_mesh_leads(const ContactMesh *mesh, int cell) {
  return !mesh->tets || cell == 0 || mesh->tets[cell - 1] != mesh->tets[cell];
}

// Fills the virtual vertices of positions (position_count, 3) from the others.
void contact_mesh_place(const ContactMesh *mesh, const ContactSystemDef *def, double *positions);

// Turns barycentric coordinates in a cell into those in its tetrahedron, in place.
static inline void contact_mesh_fold(const ContactMesh *mesh, const ContactSystemDef *def, int cell,
                                     double lambda[4]) {
  int replaced = mesh->replaced[cell];
  if (replaced < 0) return;
  const double *weights = mesh->virtuals[mesh->own[cell][replaced] - def->vertex_count].weights;
  double share = lambda[replaced];
  lambda[replaced] = 0;
  for (int v = 0; v < 4; v++) lambda[v] += share * weights[v];
}

#endif
