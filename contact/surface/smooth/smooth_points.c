// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth/smooth_points.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/limits.h"
#include "contact/surface/smooth/fit.h"

enum { MOST_FACES = CONTACT_FIT_MOST_COUNT / 2 };

static const double THICKNESS = 0.25; // of a tetrahedron's height: the largest bulge

static Status no_memory(void) {
  return status_no_memory("the smooth surface of a body");
}

static Vec3 rest_of(const ContactSmooth *smooth, int vertex) {
  return vec3_at(smooth->def->rest + 3 * (size_t)vertex);
}

// ---- Points and what carries them.

// The vertices from which a point is estimated.
typedef struct Ring {
  int count, nodes[CONTACT_FIT_MOST_COUNT];
  Vec3 x[CONTACT_FIT_MOST_COUNT], normal;
} Ring;

static void add_to_ring(const ContactSmooth *smooth, Ring *ring, int vertex) {
  for (int k = 0; k < ring->count; k++)
    if (ring->nodes[k] == vertex) return;
  if (ring->count == CONTACT_FIT_MOST_COUNT) return;
  ring->x[ring->count] = rest_of(smooth, vertex);
  ring->nodes[ring->count++] = vertex;
}

// The corners, then what is round them on the same smooth part of the surface as the face.
static void find_ring(const ContactSmooth *smooth, int face, int corner_count, const int *corners,
                      Ring *ring) {
  ring->count = 0, ring->normal = (Vec3){0, 0, 0};
  for (int c = 0; c < corner_count; c++) add_to_ring(smooth, ring, corners[c]);
  for (int c = 0; c < corner_count; c++) {
    int faces[MOST_FACES];
    int count = contact_skin_sector(&smooth->skin, corners[c], face, MOST_FACES, faces);
    Vec3 normal = contact_skin_normal(&smooth->skin, corners[c], count, faces);
    double length = vec3_length(normal);
    if (length > 0) ring->normal = vec3_add(ring->normal, vec3_scale(1 / length, normal));
    for (int f = 0; f < count; f++)
      for (int v = 0; v < 3; v++) add_to_ring(smooth, ring, smooth->skin.faces[faces[f]].vertices[v]);
  }
}

// A crease through its vertices: those of the edge, and the next on either side.
typedef struct Curve {
  int count, nodes[4];
  double along[4];
} Curve;

static void extend(const ContactSmooth *smooth, Curve *curve, int edge, int end, double sign) {
  int vertex = smooth->skin.edges[edge].vertices[end];
  int next = contact_skin_next(&smooth->skin, vertex, edge, smooth->crease);
  if (next < 0) return;
  const int *ends = smooth->skin.edges[next].vertices;
  int beyond = ends[ends[0] == vertex];
  double step = vec3_length(vec3_sub(rest_of(smooth, beyond), rest_of(smooth, vertex)));
  if (beyond == curve->nodes[0] || beyond == curve->nodes[1]) return;
  curve->nodes[curve->count] = beyond;
  curve->along[curve->count++] = curve->along[end] + sign * step;
}

static void find_curve(const ContactSmooth *smooth, int edge, Curve *curve) {
  const int *ends = smooth->skin.edges[edge].vertices;
  double length = vec3_length(vec3_sub(rest_of(smooth, ends[1]), rest_of(smooth, ends[0])));
  *curve = (Curve){.count = 2, .nodes = {ends[0], ends[1]}, .along = {0, length}};
  extend(smooth, curve, edge, 0, -1);
  extend(smooth, curve, edge, 1, 1);
  if (curve->count == 4 && curve->nodes[2] == curve->nodes[3]) curve->count = 3;
}

// `share`: of the way off the chord.
static Status add_point(ContactSmooth *smooth, int count, const int *nodes, const double *weights, int own,
                        const double *prior, double share) {
  size_t points = (size_t)smooth->point_count + 1;
  size_t rows = (size_t)(smooth->point_count ? smooth->begin[smooth->point_count] : 0);
  if (!memory_reserve((void **)&smooth->begin, &smooth->begin_capacity, points + 1, sizeof(int)) ||
      !memory_reserve((void **)&smooth->nodes, &smooth->node_capacity, rows + CONTACT_FIT_MOST_COUNT,
                      sizeof(int)) ||
      !memory_reserve((void **)&smooth->weights, &smooth->weight_capacity, rows + CONTACT_FIT_MOST_COUNT,
                      sizeof(double)) ||
      !memory_reserve((void **)&smooth->owns, &smooth->own_capacity, points, sizeof(int)) ||
      !memory_reserve((void **)&smooth->priors, &smooth->prior_capacity, points, sizeof *smooth->priors) ||
      !memory_reserve((void **)&smooth->chosen, &smooth->chosen_capacity, points, sizeof(double)))
    return no_memory();
  memcpy(smooth->nodes + rows, nodes, (size_t)count * sizeof *nodes);
  memcpy(smooth->weights + rows, weights, (size_t)count * sizeof *weights);
  memcpy(smooth->priors[points - 1], prior, (size_t)own * sizeof *prior);
  smooth->owns[points - 1] = own;
  smooth->chosen[points - 1] = share;
  smooth->begin[points] = (int)rows + count;
  smooth->point_count++;
  return STATUS_OK;
}

int contact_smooth_points_carry(const ContactSmooth *smooth, int point, const int **nodes, double *weights) {
  int begin = smooth->begin[point], count = smooth->begin[point + 1] - begin;
  double share = smooth->chosen[point];
  *nodes = smooth->nodes + begin;
  for (int k = 0; k < count; k++) {
    double prior = k < smooth->owns[point] ? smooth->priors[point][k] : 0;
    weights[k] = prior + share * (smooth->weights[begin + k] - prior);
  }
  return share > 0 ? count : smooth->owns[point];
}

Vec3 contact_smooth_points_place(const ContactSmooth *smooth, int vertex) {
  if (vertex < smooth->def->vertex_count) return rest_of(smooth, vertex);
  const int *nodes;
  double weights[CONTACT_FIT_MOST_COUNT];
  int count = contact_smooth_points_carry(smooth, vertex - smooth->def->vertex_count, &nodes, weights);
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < count; k++) sum = vec3_add(sum, vec3_scale(weights[k], rest_of(smooth, nodes[k])));
  return sum;
}

// The vertices that carry the points of an edge.
typedef struct Carriers {
  bool is_crease;
  Ring ring;
  Curve curve;
} Carriers;

static void find_carriers(const ContactSmooth *smooth, int e, Carriers *carriers) {
  const ContactSkinEdge *edge = &smooth->skin.edges[e];
  carriers->is_crease = edge->is_crease;
  if (edge->is_crease)
    find_curve(smooth, e, &carriers->curve);
  else
    find_ring(smooth, edge->faces[0], 2, edge->vertices, &carriers->ring);
}

// Of the point at that share of the edge; returns how many, the edge's ends first.
static int weigh(const Carriers *carriers, double share, double weights[CONTACT_FIT_MOST_COUNT]) {
  const double prior[2] = {1 - share, share};
  const Curve *curve = &carriers->curve;
  const Ring *ring = &carriers->ring;
  if (carriers->is_crease)
    contact_fit_curve(curve->count, curve->along, share * curve->along[1], weights);
  else
    contact_fit_surface(ring->count, ring->x, 2, prior, ring->normal, weights);
  return carriers->is_crease ? curve->count : ring->count;
}

static const int *nodes_of(const Carriers *carriers) {
  return carriers->is_crease ? carriers->curve.nodes : carriers->ring.nodes;
}

static Status add_edge_points(ContactSmooth *smooth, int e) {
  Carriers carriers;
  double weights[CONTACT_FIT_MOST_COUNT];
  find_carriers(smooth, e, &carriers);
  smooth->edge_points[e] = smooth->point_count;
  for (int k = 1; k < smooth->parts; k++) {
    double share = (double)k / smooth->parts, prior[2] = {1 - share, share};
    int count = weigh(&carriers, share, weights);
    TRY(add_point(smooth, count, nodes_of(&carriers), weights, 2, prior, smooth->shares[e]));
  }
  return STATUS_OK;
}

// ---- Which edges are divided.

static double length_of(const ContactSmooth *smooth, int e) {
  const int *ends = smooth->skin.edges[e].vertices;
  return vec3_length(vec3_sub(rest_of(smooth, ends[1]), rest_of(smooth, ends[0])));
}

static double bulge_of(const ContactSmooth *smooth, int e) {
  const int *ends = smooth->skin.edges[e].vertices;
  Carriers carriers;
  double weights[CONTACT_FIT_MOST_COUNT];
  find_carriers(smooth, e, &carriers);
  int count = weigh(&carriers, 0.5, weights);
  Vec3 way = vec3_scale(-0.5, vec3_add(rest_of(smooth, ends[0]), rest_of(smooth, ends[1])));
  for (int k = 0; k < count; k++) {
    way = vec3_add(way, vec3_scale(weights[k], rest_of(smooth, nodes_of(&carriers)[k])));
  }
  return vec3_length(way);
}

// The least height of a tetrahedron over its faces.
static double height_below(const ContactSmooth *smooth, int e) {
  double height = INFINITY;
  for (int side = 0; side < 2; side++) {
    int f = smooth->skin.edges[e].faces[side];
    if (f >= 0) height = fmin(height, smooth->skin.faces[f].height);
  }
  return height;
}

static void choose_edge(ContactSmooth *smooth, int e) {
  double bulge = smooth->bulges[e], most = THICKNESS * height_below(smooth, e);
  smooth->is_curved[e] = bulge > CONTACT_FLAT * length_of(smooth, e);
  if (!smooth->is_curved[e]) return;
  smooth->curved_count++;
  if (bulge > most) smooth->shares[e] = most / bulge;
  for (int v = 0; v < 2; v++)
    smooth->is_near[smooth->skin.edges[e].vertices[v] - smooth->skin.vertex_begin] = true;
}

static bool is_all_curved(const ContactSmooth *smooth, const ContactSkinFace *face) {
  return smooth->is_curved[face->edges[0]] && smooth->is_curved[face->edges[1]] &&
         smooth->is_curved[face->edges[2]];
}

static Status add_face_points(ContactSmooth *smooth, int f) {
  const ContactSkinFace *face = &smooth->skin.faces[f];
  Ring ring;
  double weights[CONTACT_FIT_MOST_COUNT];
  smooth->face_points[f] = smooth->point_count;
  find_ring(smooth, f, 3, face->vertices, &ring);
  for (int k = 0; k < 3; k++) {
    double prior[3] = {0.25, 0.25, 0.25};
    prior[k] = 0.5;
    contact_fit_surface(ring.count, ring.x, 3, prior, ring.normal, weights);
    TRY(add_point(smooth, ring.count, ring.nodes, weights, 3, prior, 1));
  }
  return STATUS_OK;
}

void contact_smooth_points_follow(ContactSmooth *smooth) {
  for (int f = 0; f < smooth->skin.face_count; f++) {
    if (smooth->face_points[f] < 0) continue;
    const int *edges = smooth->skin.faces[f].edges;
    double share = fmin(smooth->shares[edges[0]], fmin(smooth->shares[edges[1]], smooth->shares[edges[2]]));
    for (int k = 0; k < 3; k++) {
      double *chosen = &smooth->chosen[smooth->face_points[f] + k];
      *chosen = fmin(*chosen, share);
    }
  }
}

void contact_smooth_points_draw(ContactSmooth *smooth, int edge, double share) {
  smooth->shares[edge] = share;
  for (int k = 0; k < smooth->parts - 1; k++) {
    double *chosen = &smooth->chosen[smooth->edge_points[edge] + k];
    *chosen = fmin(*chosen, share);
  }
}

static Status reserve(ContactSmooth *smooth) {
  const ContactSkin *skin = &smooth->skin;
  size_t edges = (size_t)skin->edge_count, faces = (size_t)skin->face_count;
  smooth->is_curved = memory_zeroed(edges, sizeof(bool));
  smooth->shares = memory_zeroed(edges, sizeof(double));
  smooth->bulges = memory_zeroed(edges, sizeof(double));
  smooth->edge_points = memory_zeroed(edges, sizeof(int));
  smooth->face_points = memory_zeroed(faces, sizeof(int));
  smooth->is_near = memory_zeroed((size_t)skin->vertex_count, sizeof(bool));
  if (!smooth->is_curved || !smooth->shares || !smooth->bulges || !smooth->edge_points ||
      !smooth->face_points || !smooth->is_near)
    return no_memory();
  for (int e = 0; e < skin->edge_count; e++) smooth->shares[e] = 1;
  for (int f = 0; f < skin->face_count; f++) smooth->face_points[f] = -1;
  return STATUS_OK;
}

Status contact_smooth_points_create(ContactSmooth *smooth, const ContactSystemDef *def,
                                    const ContactBody *body, int level, double crease) {
  *smooth = (ContactSmooth){.def = def, .parts = 1 << level, .crease = crease};
  TRY(contact_skin_create(&smooth->skin, def, body, crease));
  TRY(reserve(smooth));
  const ContactSkin *skin = &smooth->skin;
#pragma omp parallel for schedule(static) if (skin->edge_count > 512)
  for (int e = 0; e < skin->edge_count; e++) smooth->bulges[e] = bulge_of(smooth, e);
  for (int e = 0; e < skin->edge_count; e++) choose_edge(smooth, e);
  for (int e = 0; e < skin->edge_count; e++)
    if (smooth->is_curved[e]) TRY(add_edge_points(smooth, e));
  for (int f = 0; f < skin->face_count && level == CONTACT_SMOOTH_MOST_LEVEL; f++)
    if (is_all_curved(smooth, &skin->faces[f])) TRY(add_face_points(smooth, f));
  contact_smooth_points_follow(smooth);
  return STATUS_OK;
}

void contact_smooth_points_destroy(ContactSmooth *smooth) {
  contact_skin_destroy(&smooth->skin);
  void *arrays[] = {smooth->is_curved,   smooth->shares,  smooth->bulges, smooth->edge_points,
                    smooth->face_points, smooth->is_near, smooth->begin,  smooth->nodes,
                    smooth->weights,     smooth->owns,    smooth->priors, smooth->chosen};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *smooth = (ContactSmooth){0};
}
