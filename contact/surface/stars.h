// SPDX-License-Identifier: GPL-3.0-or-later
// The mesh that the potential `field` works on where a body is curved: of a body of linear tetrahedra the
// cells of contact/surface/smooth/smooth.h, of quadratic ones stars, or where their surface is wanted smooth
// the cells of their eighths.
//
// If contact worked on the eighths of a quadratic tetrahedron, an even pressure p would act with p area/12 on
// each corner of a face and with p area/4 on each middle of an edge. The element's own nodal forces are p ∫
// N_a dA: zero on the corners of a straight face, a third of the area on each middle. So an element with a
// face on the surface is cut anew: that face into a fan of six triangles about a vertex
//
//   x = Σ_corners −⅓ x_c + Σ_middles ⅔ x_m,
//
// its other faces into four as the eighths do, so that neighbours fit. All triangles make cells with one
// vertex o inside. A linear function of the fan then adds up to area/9 − ⅓ · area/3 = 0 at a corner and to
// area/9 + ⅔ · area/3 = area/3 at a middle: the nodal forces of an even pressure are those of the element.
// The volume below the fan is that below the curved face, to first order in its curvature. Rigid motion and
// balance are kept, since the weights reproduce linear fields. o lies at λ_f = δ/height_f for the faces on
// the surface, ¼ for the others, δ as in contact/surface/mesh.h, and follows all ten nodes by their shape
// functions there.
//
// The mesh so made is a definition of its own. Its positions follow from the nodes by the weights, and
// forces and stiffness return to the nodes by the same weights, so balance there is balance for the nodes.
#ifndef TETLAP_CONTACT_SURFACE_STARS_H
#define TETLAP_CONTACT_SURFACE_STARS_H

#include "base/vec3.h"
#include "contact/def.h"

typedef struct ContactStars {
  bool is_needed;       // else everything is as it was given
  ContactSystemDef def; // with stars; its arrays are these
  ContactBody *bodies;
  double *rest;
  unsigned char *inner;
  double *heights; // as in the definition                               (def.vertex_count)
  int (*tets)[4];
  int *origin;   // of each tet: the given one, of a star's the first eighth             (def.tet_count)
  bool *is_star; //                                                                      (def.tet_count)
  int given_vertex_count, given_tet_count;
  int *place; // of a given vertex among those of `def`                                  (given_vertex_count)
  int *given; // the given vertex whose place it is; −1: none                            (def.vertex_count)
  // The given vertices that a vertex follows: begin[v] … begin[v + 1] of nodes, weights.
  int *begin; //                                                                    (def.vertex_count + 1)
  int *nodes; //                                                                    (begin[def.vertex_count])
  double *weights; // their sum is 1 for each vertex
  size_t tet_capacity, row_capacity, weight_capacity, begin_capacity, origin_capacity, star_capacity,
      height_capacity, inner_capacity;
} ContactStars;

// Makes them where the potential is `field` and a body is quadratic, or curved and wanted smooth. A zeroed
// one can be destroyed.
Status contact_stars_create(ContactStars *stars, const ContactSystemDef *def);
void contact_stars_destroy(ContactStars *stars);

// Values of the vertices of `def` (positions, velocities) from those of the given ones.
void contact_stars_place(const ContactStars *stars, const double *given, double *values);

// Adds a force on a vertex of `def` to those on the given ones. NULL: the vertices are the given ones.
void contact_stars_push(const ContactStars *stars, int vertex, Vec3 force, double *given);

// Σ over `def`'s tets of what each covers, by given tetrahedra; a star's is spread over its eighths by
// volume.
void contact_stars_cover(const ContactStars *stars, const double *covered, const double *given_volumes,
                         double *given);

// Copies the value of the first eighth of each star to all eight; by given tetrahedra. Without stars:
// nothing.
void contact_stars_spread(const ContactStars *stars, int *values);

// The given vertex whose place a vertex of `def` is; −1: none.
static inline int contact_stars_given(const ContactStars *stars, int vertex) {
  return stars->is_needed ? stars->given[vertex] : vertex;
}

size_t contact_stars_bytes(const ContactStars *stars); // on the heap

#endif
