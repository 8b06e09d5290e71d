// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/roundness.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "contact/surface/smooth_points.h"

typedef struct Weighed {
  double value, area;
} Weighed;

// Facets by area, and what of them curves either way.
typedef struct Facets {
  Weighed *edges, *round, *hollow; // (face_count, round_count, hollow_count)
  int round_count, hollow_count;
  double area, round_area, hollow_area;
} Facets;

// 1/R along an edge, positive where the surface is convex: 8 bulge / length² by the one point on it.
static double curvature_along(const ContactSmooth *smooth, int e, Vec3 normal) {
  const ContactSkinEdge *edge = &smooth->skin.edges[e];
  if (!smooth->is_curved[e] || edge->is_crease) return 0;
  Vec3 a = vec3_at(smooth->def->rest + 3 * (size_t)edge->vertices[0]);
  Vec3 b = vec3_at(smooth->def->rest + 3 * (size_t)edge->vertices[1]);
  Vec3 middle = contact_smooth_points_place(smooth, smooth->def->vertex_count + smooth->edge_points[e]);
  Vec3 chord = vec3_sub(b, a), way = vec3_sub(middle, vec3_scale(0.5, vec3_add(a, b)));
  return 8 * vec3_dot(way, normal) / vec3_dot(chord, chord);
}

static void add_facet(const ContactSmooth *smooth, int f, Facets *facets) {
  const ContactSkinFace *face = &smooth->skin.faces[f];
  Vec3 x[3];
  double most = 0;
  for (int v = 0; v < 3; v++) x[v] = vec3_at(smooth->def->rest + 3 * (size_t)face->vertices[v]);
  Vec3 normal = vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0]));
  normal = vec3_scale(1 / vec3_length(normal), normal);
  for (int k = 0; k < 3; k++) {
    double one = curvature_along(smooth, face->edges[k], normal);
    if (fabs(one) > fabs(most)) most = one;
  }
  facets->area += face->area;
  if (most > 0)
    facets->round[facets->round_count++] = (Weighed){most, face->area}, facets->round_area += face->area;
  if (most < 0)
    facets->hollow[facets->hollow_count++] = (Weighed){-most, face->area}, facets->hollow_area += face->area;
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

static bool curves(const ContactSmooth *smooth, int f) {
  for (int k = 0; k < 3; k++) {
    int e = smooth->skin.faces[f].edges[k];
    if (smooth->is_curved[e] && !smooth->skin.edges[e].is_crease) return true;
  }
  return false;
}

// Facets of two right angles to a square of this edge.
static double edge_of(const Facets *facets, const ContactSmooth *smooth, const bool *held, bool is_flat) {
  int count = 0;
  for (int f = 0; f < smooth->skin.face_count; f++)
    if (!is_held(smooth, held, f) && (is_flat || curves(smooth, f)))
      facets->edges[count++] = (Weighed){sqrt(2 * smooth->skin.faces[f].area), 1};
  return quantile(facets->edges, count, 10);
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
  double least = facets->area / 20;
  if (facets->round_area > least) roundness->round = quantile(facets->round, facets->round_count, 2);
  if (facets->hollow_area > least) roundness->hollow = quantile(facets->hollow, facets->hollow_count, 2);
  roundness->edge = edge_of(facets, smooth, held, roundness->round == 0 && roundness->hollow == 0);
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
