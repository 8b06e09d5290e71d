// SPDX-License-Identifier: GPL-3.0-or-later
// The constant part of a contact system: the definition, rest volumes, and which parties can meet.
#ifndef TETLAP_CONTACT_SEARCH_LAYOUT_H
#define TETLAP_CONTACT_SEARCH_LAYOUT_H

#include <stddef.h>

#include "contact/def.h"
#include "contact/search/self.h"
#include "contact/surface/mesh.h"

// What is constant of an interface, where two can meet; contact/interface.h is what acts there. Bodies a < b,
// a body and itself, or body a and a shape. Side 0 is a, side 1 is b. Of a body and itself an element may be
// cells[0] of one pair and cells[1] of another; both weights are ½ then.
typedef struct ContactInterfaceDef {
  int a, b;         // b = body_count + shape, as in ContactInterface
  int shape;        // its number; −1: two bodies
  double weight[2]; // of each side's sum in U: ½ and ½ between bodies; 1 and 0 against an obstacle, so that
                    // > 0 also says that the side carries unknowns; `field` asks only that
  double stiffness; // κ
  const struct ContactLaw *law; // of the potential `field`, in place of κ; NULL: linear. Borrowed
} ContactInterfaceDef;

// A cell of the contact mesh (contact/surface/mesh.h) of side 0 and one of side 1. Without the potential
// `field` cells are tetrahedra. −1: a shape, which meets whole tetrahedra; the first cell of one stands for
// it.
typedef struct ContactPair {
  int interface;
  int cells[2];
} ContactPair;

// General position. The overlap models see each body shifted as a whole by a fixed random nudge of a
// billionth of the margin. Without it regular meshes meet in planes that coincide, also inside of the bodies.
// There each pair's ∇V is one-sided, and the sides of neighbouring pairs do not fit together: measured on
// aligned flat slabs, false friction of 5 % (exact) to 15 % (clip) of the normal force; with it 1e-11, and
// the models agree. U stays an exact function of the positions, only that of bodies that stand a little
// elsewhere. A body that meets itself is shifted by an affine function of the rest positions, no longer than
// a nudge, so that its parts move against each other and neighbours stay together. The potential `field` asks
// for no derivative of V and does without, so that its pairs balance to rounding; its stiffness takes the
// nudge (contact_layout_unsettle_pair).
typedef struct ContactLayout {
  ContactSystemDef def;   // its arrays are borrowed, but for `rest`, which has the virtual vertices as well
  double *rest;           // rest positions [m]                               (position_count, 3)
  ContactMesh mesh;       // the mesh that all below and all lists of pairs work on
  double *tet_volumes;    // of whole tetrahedra, rest [m³]                   (tet_count)
  double *cell_volumes;   // V_i, rest [m³]                                   (cell_count)
  double *vertex_volumes; // V_a = ¼ Σ_{i∋a} V_i [m³]                         (vertex_count)
  // Bodies with bodies and themselves first, then with shapes.
  ContactInterfaceDef *interfaces; //                                         (interface_count)
  int interface_count;
  double nudge;        // length of a nudge [m]
  double (*nudges)[3]; // of each body, see above [m]                       (body_count)
  double *shifts;      // of each vertex, for self-contact [m]; NULL: no body has it (position_count, 3)
  ContactSelf self;
  int party_count; // bodies, then shapes
  double margin;   // def.margin, or its default [m]
} ContactLayout;

// STATUS_INPUT: κ or margin not positive, a rest tetrahedron without volume, a normal that is no unit vector.
Status contact_layout_create(ContactLayout *layout, const ContactSystemDef *def);
void contact_layout_destroy(ContactLayout *layout);

// The margin where the definition gives none: half the shortest mean edge of a body [m].
double contact_layout_margin(const ContactSystemDef *def);

// The vertices of the tetrahedron that a cell is part of: those on which the forces of the cell act.
static inline const int *contact_layout_vertices(const ContactLayout *layout, int cell) {
  return layout->def.tets[contact_mesh_tet(&layout->mesh, cell)];
}

// The number that the definition gives that tetrahedron; of a star (contact/surface/stars.h) the element's
// first eighth.
static inline int contact_layout_origin(const ContactLayout *layout, int cell) {
  int tet = contact_mesh_tet(&layout->mesh, cell);
  return layout->def.origin ? layout->def.origin[tet] : tet;
}

static inline double contact_layout_tet_volume(const ContactLayout *layout, int cell) {
  return layout->tet_volumes[contact_mesh_tet(&layout->mesh, cell)];
}

// The 12 coordinates of a cell.
static inline void contact_layout_gather(const ContactLayout *layout, int cell, const double *positions,
                                         double coordinates[12]) {
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++)
      coordinates[3 * v + c] = positions[3 * (size_t)layout->mesh.cells[cell][v] + (size_t)c];
}

// The 12 coordinates of its tetrahedron.
static inline void contact_layout_gather_whole(const ContactLayout *layout, int cell, const double *positions,
                                               double coordinates[12]) {
  const int *vertices = contact_layout_vertices(layout, cell);
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) coordinates[3 * v + c] = positions[3 * (size_t)vertices[v] + (size_t)c];
}

// Adds the shifts of self-contact to a cell's vertices.
static inline void contact_layout_warp(const ContactLayout *layout, int cell, double coordinates[12]) {
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++)
      coordinates[3 * v + c] += layout->shifts[3 * (size_t)layout->mesh.cells[cell][v] + (size_t)c];
}

// Whether forces follow from the depth field (contact/pressure/field.h), else from volumes alone
// (contact/volume/volume.h).
static inline bool contact_layout_has_field(const ContactLayout *layout) {
  return layout->def.potential == CONTACT_POTENTIAL_FIELD;
}

// Puts a pair of cells into general position.
static inline void contact_layout_unsettle_pair(const ContactLayout *layout, const ContactPair *pair,
                                                double coordinates[24]) {
  const ContactInterfaceDef *interface = &layout->interfaces[pair->interface];
  if (interface->a == interface->b) {
    for (int side = 0; side < 2; side++)
      contact_layout_warp(layout, pair->cells[side], coordinates + 12 * side);
    return;
  }
  for (int k = 0; k < 12; k++) {
    coordinates[k] += layout->nudges[interface->a][k % 3];
    coordinates[12 + k] += layout->nudges[interface->b][k % 3];
  }
}

// The 24 coordinates of a pair as the overlap models see them: in general position but with the potential
// `field`; a shape has none: 12, of the whole tetrahedron.
static inline void contact_layout_gather_pair(const ContactLayout *layout, const ContactPair *pair,
                                              const double *positions, double coordinates[24]) {
  if (pair->cells[1] < 0) {
    contact_layout_gather_whole(layout, pair->cells[0], positions, coordinates);
    return;
  }
  contact_layout_gather(layout, pair->cells[0], positions, coordinates);
  contact_layout_gather(layout, pair->cells[1], positions, coordinates + 12);
  if (!contact_layout_has_field(layout)) contact_layout_unsettle_pair(layout, pair, coordinates);
}

#endif
