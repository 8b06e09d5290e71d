// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/roundness.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "contact/limits.h"
#include "contact/surface/smooth/smooth_points.h"

typedef struct Weighed {
  double value, area;
} Weighed;

// Facets by area, and what of them curves either way; edges of those that curve.
typedef struct Facets {
  Weighed *edges, *round, *hollow; // (edge_count, round_count, hollow_count)
  int edge_count, round_count, hollow_count;
  double area, round_area, hollow_area;
} Facets;

// A body is round, or hollow, if half of one in so many parts of its surface is, and its edge is the one
// below which one in so many is.
enum { PARTS = 10 };

// A symmetric form of the plane of a facet.
typedef struct Form {
  double uu, uv, vv;
} Form;

// Of a facet: the principal curvature that is larger in magnitude, positive where the surface is convex, and
// the facet's edge along it.
typedef struct Bend {
  double curvature, edge; // [1/m], [m]
} Bend;

// length² times the normal curvature along an edge: 8 times the way of the edge's middle to the surface. That
// of a curve in a surface is the surface's along it, wherever the curve turns to (Meusnier 1776): an edge
// that is sharp tells it, too.
static double bulge_along(const ContactSmooth *smooth, int e, Vec3 normal) {
  const ContactSkinEdge *edge = &smooth->skin.edges[e];
  if (!smooth->is_curved[e]) return 0;
  Vec3 a = vec3_at(smooth->def->rest + 3 * (size_t)edge->vertices[0]);
  Vec3 b = vec3_at(smooth->def->rest + 3 * (size_t)edge->vertices[1]);
  Vec3 middle = contact_smooth_points_place(smooth, smooth->def->vertex_count + smooth->edge_points[e]);
  Vec3 way = vec3_sub(middle, vec3_scale(0.5, vec3_add(a, b)));
  double bulge = vec3_dot(way, normal) / smooth->shares[e];
  if (!(fabs(bulge) > CONTACT_FLAT * vec3_length(vec3_sub(b, a)))) return 0; // in a flat face, to rounding
  return 8 * bulge;
}

static void add_square(Form *form, double share, double u, double v) {
  form->uu += share * u * u, form->uv += share * u * v, form->vv += share * v * v;
}

// The form Q with e·Q e = bulge along the three edges e, whose cross products with each other are ±2 area:
//
//   Q = Σ_k (bulge_i + bulge_j − bulge_k)/(8 area²) t_k t_kᵀ,     t_k: e_k turned by a right angle.
//
// Its eigenvalues are the principal curvatures. The edge along them is h with
//
//   h² = Σ_k e_k·|Q| e_k / (2 tr |Q|),     |Q| = (Q² + |det Q|)/tr |Q|,     (tr |Q|)² = tr Q² + 2 |det Q|,
//
// the side of a right triangle with two equal ones, whichever way it curves, and where it curves along one
// side alone that side, however long the other is.
static Bend bend_of(const double u[3], const double v[3], const double bulges[3], double area) {
  Form q = {0}, squares = {0};
  for (int k = 0; k < 3; k++) {
    double others = bulges[(k + 1) % 3] + bulges[(k + 2) % 3];
    add_square(&q, (others - bulges[k]) / (8 * area * area), -v[k], u[k]);
    add_square(&squares, 1, u[k], v[k]);
  }
  double mean = (q.uu + q.vv) / 2, determinant = q.uu * q.vv - q.uv * q.uv, size = fabs(determinant);
  double most = fabs(mean) + sqrt(fmax(mean * mean - determinant, 0));
  Form of = {q.uu * q.uu + q.uv * q.uv + size, 2 * mean * q.uv, q.vv * q.vv + q.uv * q.uv + size};
  double edges = (of.uu * squares.uu + 2 * of.uv * squares.uv + of.vv * squares.vv) / (of.uu + of.vv);
  return (Bend){.curvature = copysign(most, mean), .edge = sqrt(edges / 2)};
}

static Bend bend_along_facet(const ContactSmooth *smooth, const ContactSkinFace *face) {
  Vec3 x[3], normal, axes[2];
  double u[3], v[3], bulges[3], most = 0;
  for (int k = 0; k < 3; k++) x[k] = vec3_at(smooth->def->rest + 3 * (size_t)face->vertices[k]);
  normal = vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0]));
  normal = vec3_scale(1 / vec3_length(normal), normal);
  axes[0] = vec3_sub(x[1], x[0]), axes[0] = vec3_scale(1 / vec3_length(axes[0]), axes[0]);
  axes[1] = vec3_cross(normal, axes[0]);
  for (int k = 0; k < 3; k++) {
    Vec3 edge = vec3_sub(x[(k + 1) % 3], x[k]);
    u[k] = vec3_dot(edge, axes[0]), v[k] = vec3_dot(edge, axes[1]);
    bulges[k] = bulge_along(smooth, face->edges[k], normal);
    most = fmax(most, fabs(bulges[k]));
  }
  return most > 0 ? bend_of(u, v, bulges, face->area) : (Bend){0};
}

static void add_facet(const ContactSmooth *smooth, int f, Facets *facets) {
  double area = smooth->skin.faces[f].area;
  Bend bend = bend_along_facet(smooth, &smooth->skin.faces[f]);
  facets->area += area;
  if (bend.curvature != 0) facets->edges[facets->edge_count++] = (Weighed){bend.edge, 1};
  if (bend.curvature > 0)
    facets->round[facets->round_count++] = (Weighed){bend.curvature, area}, facets->round_area += area;
  if (bend.curvature < 0)
    facets->hollow[facets->hollow_count++] = (Weighed){-bend.curvature, area}, facets->hollow_area += area;
}

static int compare(const void *left, const void *right) {
  double a = ((const Weighed *)left)->value, b = ((const Weighed *)right)->value;
  return (a > b) - (a < b);
}

// The value below which one in `parts` of the area is; 0 of none.
static double quantile(Weighed *values, int count, int parts) {
  double area = 0, below = 0;
  if (count == 0) return 0;
  qsort(values, (size_t)count, sizeof *values, compare);
  for (int k = 0; k < count; k++) area += values[k].area;
  for (int k = 0; k < count; k++)
    if ((below += values[k].area) * parts >= area) return values[k].value;
  return values[count - 1].value;
}

static bool is_held(const ContactSmooth *smooth, const bool *held, int f) {
  const int *v = smooth->skin.faces[f].vertices;
  return held && held[v[0]] && held[v[1]] && held[v[2]];
}

// Of flat ones the edge of a square of two such right triangles.
static double edge_of(const ContactSmooth *smooth, const bool *held, bool is_flat, Facets *facets) {
  if (is_flat) facets->edge_count = 0;
  for (int f = 0; f < smooth->skin.face_count && is_flat; f++)
    if (!is_held(smooth, held, f))
      facets->edges[facets->edge_count++] = (Weighed){sqrt(2 * smooth->skin.faces[f].area), 1};
  return quantile(facets->edges, facets->edge_count, PARTS);
}

static Status look_at(const ContactSmooth *smooth, const bool *held, Facets *facets,
                      ContactRoundness *roundness) {
  size_t count = (size_t)smooth->skin.face_count;
  facets->edges = memory_zeroed(count, sizeof(Weighed));
  facets->round = memory_zeroed(count, sizeof(Weighed));
  facets->hollow = memory_zeroed(count, sizeof(Weighed));
  if (!facets->edges || !facets->round || !facets->hollow) return status_no_memory("the curvature of a body");
  for (int f = 0; f < smooth->skin.face_count; f++)
    if (!is_held(smooth, held, f)) add_facet(smooth, f, facets);
  double least = 0.5 * facets->area / PARTS;
  if (facets->round_area > least) roundness->round = quantile(facets->round, facets->round_count, 2);
  if (facets->hollow_area > least) roundness->hollow = quantile(facets->hollow, facets->hollow_count, 2);
  roundness->edge = edge_of(smooth, held, roundness->round == 0 && roundness->hollow == 0, facets);
  return STATUS_OK;
}

Status contact_roundness_measure(ContactRoundness *roundness, const ContactSystemDef *def,
                                 const ContactBody *body, double crease, const bool *held) {
  ContactSmooth smooth = {0};
  Facets facets = {0};
  *roundness = (ContactRoundness){0};
  Status status = contact_smooth_points_create(&smooth, def, body, 1, crease);
  if (!status) status = look_at(&smooth, held, &facets, roundness);
  memory_free(facets.edges);
  memory_free(facets.round);
  memory_free(facets.hollow);
  contact_smooth_points_destroy(&smooth);
  return status;
}
