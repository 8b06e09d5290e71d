// SPDX-License-Identifier: GPL-3.0-or-later
// A tetrahedron against a convex solid with flat faces (a box, a prism), in closed form: the overlap with
// such an obstacle.
//
// Only planes that cut the tetrahedron take part. The boundary of the intersection P is made of polygons: P_f
// on face f of the tetrahedron (the triangle, clipped by the planes) and Q_k on plane k (the section of the
// tetrahedron, clipped by the other planes). With o one of P's vertices, n outward and p any point of a
// polygon,
//
//   V = ⅓ Σ_f n_f·(p_f − o) |P_f| + ⅓ Σ_k n_k·(p_k − o) |Q_k|,
//
// ∂V/∂x_a = Σ_{f∋a} n_f ∫_{P_f} β_a dA, β the barycentric coordinates. Every polygon is clipped for itself,
// so no sign of a distance that is only rounding can tear the surface open. An error ε of a distance moves a
// polygon's edge by ε.
#ifndef TETLAP_CONTACT_SHAPE_CONVEX_H
#define TETLAP_CONTACT_SHAPE_CONVEX_H

#include <stdbool.h>

#include "base/vec3.h"

enum {
  CONTACT_CONVEX_FACE_COUNT = 64, // of a prism, at most
  CONTACT_CONVEX_PLANES = CONTACT_CONVEX_FACE_COUNT + 2,
  CONTACT_CONVEX_CORNERS = CONTACT_CONVEX_FACE_COUNT, // half of them
  CONTACT_CONVEX_EDGES = CONTACT_CONVEX_FACE_COUNT / 2 + 1,
};

// The solid { x : normal_k·x ≤ offset_k }, symmetric about the origin.
typedef struct ContactConvex {
  int plane_count, corner_count, edge_count;
  Vec3 normals[CONTACT_CONVEX_PLANES];   // unit length, outward              (plane_count)
  double offsets[CONTACT_CONVEX_PLANES]; // > 0 [m]                           (plane_count)
  Vec3 corners[CONTACT_CONVEX_CORNERS];  // one of each opposite two [m]      (corner_count)
  Vec3 edges[CONTACT_CONVEX_EDGES];      // directions, each once             (edge_count)
  double reach;                          // farthest corner from the origin [m]
} ContactConvex;

// The box |x_c| ≤ half_size_c.
void contact_convex_make_box(ContactConvex *convex, const double half_size[3]);
// A prism about z, |z| ≤ half_length, with `faces` (even, 8 … CONTACT_CONVEX_FACE_COUNT) sides whose section
// has the area of the circle of that radius: what is drawn of a cylinder.
void contact_convex_make_prism(ContactConvex *convex, double radius, double half_length, int faces);

// V [m³] and, where not NULL, ∂V/∂x [m²] of a tetrahedron of either orientation. Where a face lies in a plane
// V has one-sided derivatives only.
void contact_convex_overlap(const ContactConvex *convex, const double tet[12], double *volume,
                            double gradient[12]);

// Of the potential `field` (contact/pressure/field.h) with c = 1 Pa/m: V [m³], the energy of a tetrahedron of
// that rest volume [m⁴], its gradient [m³] and, where not NULL, Hessian [m²]. The depth is that below the
// nearest plane, so the tetrahedron is cut into pieces, one of each plane that is the nearest somewhere in
// it. With m_a = ∫ β_a over piece k, rest over present volume s, and its section Q with plane k or with one
// halfway to another plane j,
//
//   U = s Σ_k Σ_a m_a d_k(x_a),   ∂U/∂x_a = −s Σ_k m_a n_k,
//   δ²U = s Σ_k ∫_Q_k (δu·n_k)² dA − s Σ_kj ∫_Q_kj |n_j − n_k| (δu·m)² dA,   m = (n_j − n_k)/|n_j − n_k|.
void contact_convex_press(const ContactConvex *convex, const double tet[12], double rest_volume,
                          double *volume, double *energy, double gradient[12], double hessian[144]);

// How far apart the two are along the best of their separating axes (overlap/separation.h): at most
// their distance, negative once they overlap. It ends early with a lower bound that is > enough.
double contact_convex_separation(const ContactConvex *convex, const double tet[12], double enough);

#endif
