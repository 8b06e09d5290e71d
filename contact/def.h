// SPDX-License-Identifier: GPL-3.0-or-later
// The definition of a contact system, as its creator gives it: bodies, obstacles without elements, the
// potential. Plain data; contact/system.h says what is done with it.
#ifndef TETLAP_CONTACT_DEF_H
#define TETLAP_CONTACT_DEF_H

#include <stdbool.h>
#include <stddef.h>

#include "overlap/model.h"

typedef struct ContactBody {
  const char *name; // borrowed
  int vertex_begin, vertex_end;
  int tet_begin, tet_end;
  int quadratic_begin, quadratic_end; // equal: its tetrahedra are linear
  bool is_obstacle;                   // carries no unknowns: static or driven
  bool meets_itself;                  // parts of it may touch each other (contact/search/self.h)
  int smooth; // the level of contact/surface/smooth/smooth.h; 0: facets as they are
} ContactBody;

// Obstacles without elements.
typedef enum ContactShapeKind {
  CONTACT_SHAPE_HALFSPACE, // { x : normal·(x − point) ≤ 0 }
  CONTACT_SHAPE_BALL,      // { x : |x − point| ≤ radius }
  CONTACT_SHAPE_CONVEX,    // `convex` about `point`, along `axes`
  CONTACT_SHAPE_CYLINDER,  // of `radius` and `half_length` about axes[2] through `point`
} ContactShapeKind;

// `point` moves by point(t) = point + t velocity, or as `move` says, which returns position and velocity at a
// time of what rests at `rest`, by a rigid motion; a half-space must not turn. `move` may be called from
// several threads.
typedef struct ContactShape {
  const char *name; // borrowed
  ContactShapeKind kind;
  double point[3];                    // [m]
  double normal[3];                   // of a half-space, unit length
  double radius;                      // of a ball, a cylinder [m]
  double half_length;                 // of a cylinder [m]
  double round;                       // of a cylinder: its radius where the depth has the slope 1 [m]
  const struct ContactConvex *convex; // of that kind; borrowed
  double axes[3][3];                  // its own axes at rest, in space, orthonormal and right-handed
  double velocity[3];                 // [m/s]
  const void *motion;                 // handed to `move`; borrowed
  void (*move)(const void *motion, double time, const double rest[3], double position[3],
               double velocity[3]); // NULL: by `velocity`
} ContactShape;

// How overlaps become forces, by the name a scene uses. κ: stiffness.
typedef enum ContactPotential {
  CONTACT_POTENTIAL_NODAL, // by volumes alone (contact/volume/volume.h), κ [Pa]: no friction, no viscosity
  CONTACT_POTENTIAL_FIELD, // U = κ ∫_A φ_B + κ ∫_B φ_A over rest volumes, φ the depth below the other's
                           // surface (contact/pressure/field.h), κ [Pa/m]; both terms also against a mesh
                           // obstacle
} ContactPotential;

enum { CONTACT_POTENTIAL_COUNT = 2 };
const char *contact_def_potential_name(ContactPotential potential); // "nodal", …
const char *contact_def_potential_help(ContactPotential potential); // one line
const char *contact_def_potential_unit(ContactPotential potential); // of κ

typedef struct ContactSystemDef {
  int vertex_count;
  const double *rest;   // rest positions [m], borrowed                    (vertex_count, 3)
  const int (*tets)[4]; // borrowed; all bodies one after another          (tet_count)
  int tet_count;
  // Quadratic tetrahedra, of ten nodes: the corners, then the middles of the edges 01, 02, 03, 12, 13, 23.
  // Each is eight of its body's tets, one after another. NULL: there are none. Read in creation.
  const int (*quadratics)[10]; // borrowed
  // The number of a tet in the caller's mesh (contact/surface/stars.h), below origin_count; NULL: the same.
  const int *origin; //                                                     (tet_count)
  int origin_count;
  const ContactBody *bodies; // borrowed                                    (body_count)
  int body_count;
  const ContactShape *shapes; // borrowed                           (shape_count)
  int shape_count;
  // Bit k of a vertex: it lies on the k-th part of the boundary that is no surface (a plane of symmetry, what
  // is glued). Faces whose three vertices share a bit have no depth below them. NULL: none; read in creation.
  const unsigned char *inner; //                                            (vertex_count)
  double crease; // between faces that make more, an edge stays sharp where a body is smooth [rad]
  // Depth of a vertex at rest where its creator knows it [m]; NaN: it is measured. NULL: none; borrowed.
  const double *heights; //                                                 (vertex_count)
  ContactPotential potential;
  double stiffness; // κ
  // κ of each body (row) with each party, bodies then shapes; NULL: `stiffness` for all. Read in creation.
  const double *pair_stiffness; // (body_count, body_count + shape_count)
  // A pressure law of the potential `field` for each body with each party, in place of κ; an entry NULL:
  // linear. NULL: all are. Read in creation, the laws are borrowed.
  const struct ContactLaw *const *pair_laws; // (body_count, body_count + shape_count)
  double margin; // skin margin while bodies are near [m]; 0: half the shortest mean edge of a body
  const OverlapModel *model; // borrowed
} ContactSystemDef;

#endif
