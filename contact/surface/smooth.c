// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/surface/fit.h"

enum { MOST_FACES = CONTACT_FIT_MOST_COUNT / 2, MOST_PARTS = 1 << CONTACT_SMOOTH_MOST_LEVEL };

static const double STRAIGHT = 1e-5;  // of an edge's length, 1 − the cosine of a turn: less is rounding
static const double THICKNESS = 0.25; // of a tetrahedron's height: the largest bulge
static const double FLAT = 1e-4;      // of a tetrahedron's volume: the least of a cell's

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

int contact_smooth_carry(const ContactSmooth *smooth, int point, const int **nodes, double *weights) {
  int begin = smooth->begin[point], count = smooth->begin[point + 1] - begin;
  double share = smooth->chosen[point];
  *nodes = smooth->nodes + begin;
  for (int k = 0; k < count; k++) {
    double prior = k < smooth->owns[point] ? smooth->priors[point][k] : 0;
    weights[k] = prior + share * (smooth->weights[begin + k] - prior);
  }
  return share > 0 ? count : smooth->owns[point];
}

static Vec3 place_of(const ContactSmooth *smooth, int vertex) {
  if (vertex < smooth->def->vertex_count) return rest_of(smooth, vertex);
  const int *nodes;
  double weights[CONTACT_FIT_MOST_COUNT];
  int count = contact_smooth_carry(smooth, vertex - smooth->def->vertex_count, &nodes, weights);
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
  smooth->is_curved[e] = bulge > STRAIGHT * length_of(smooth, e);
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

// Points within faces go as far as those of the edges.
static void follow_edges(ContactSmooth *smooth) {
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

// ---- Faces in triangles.

typedef struct Triangles {
  int count, corners[MOST_PARTS * MOST_PARTS][3];
} Triangles;

static void add_triangle(Triangles *to, int a, int b, int c) {
  int *corners = to->corners[to->count++];
  corners[0] = a, corners[1] = b, corners[2] = c;
}

// The vertices from a to b along an edge, both included; returns how many parts.
static int walk(const ContactSmooth *smooth, int a, int b, int path[MOST_PARTS + 1]) {
  int e = contact_skin_edge(&smooth->skin, a, b);
  bool is_divided = e >= 0 && smooth->is_curved[e];
  int parts = is_divided ? smooth->parts : 1;
  path[0] = a, path[parts] = b;
  for (int k = 1; k < parts; k++) {
    int point = smooth->def->vertex_count + smooth->edge_points[e];
    path[k] = point + (a < b ? k : parts - k) - 1;
  }
  return parts;
}

// Between two paths from one vertex, `parts` each; the diagonals begin on that which ends at the lower
// vertex.
static void add_strip(Triangles *to, const int *p, const int *q, int parts) {
  bool from_p = p[parts] < q[parts];
  add_triangle(to, p[0], p[1], q[1]);
  for (int i = 1; i < parts; i++) {
    if (from_p) {
      add_triangle(to, p[i], p[i + 1], q[i + 1]);
      add_triangle(to, p[i], q[i + 1], q[i]);
    } else {
      add_triangle(to, p[i], p[i + 1], q[i]);
      add_triangle(to, p[i + 1], q[i + 1], q[i]);
    }
  }
}

// Three divided edges: a strip at each corner up to the middles, and the triangle of these.
static void add_corners(Triangles *to, int paths[3][MOST_PARTS + 1], int parts) {
  int half = parts / 2;
  for (int k = 0; k < 3; k++) {
    int back[MOST_PARTS + 1];
    for (int i = 0; i <= half; i++) back[i] = paths[(k + 2) % 3][parts - i];
    add_strip(to, paths[k], back, half);
  }
  add_triangle(to, paths[0][half], paths[1][half], paths[2][half]);
}

// In sixteen, about the three points within.
static void add_lattice(Triangles *to, int paths[3][MOST_PARTS + 1], int inner) {
  int in[3] = {inner, inner + 1, inner + 2}; // nearest to the corners where the paths begin
  for (int k = 0; k < 3; k++) {
    const int *out = paths[k], *before = paths[(k + 2) % 3];
    int next = in[(k + 1) % 3];
    add_triangle(to, out[0], out[1], before[3]);
    add_triangle(to, out[1], in[k], before[3]);
    add_triangle(to, out[1], out[2], in[k]);
    add_triangle(to, out[2], next, in[k]);
    add_triangle(to, out[2], out[3], next);
  }
  add_triangle(to, in[0], in[1], in[2]);
}

// Of a face that is given counter-clockwise; `inner`: the first point within, −1: none.
static void cut_face(const ContactSmooth *smooth, const int corners[3], int inner, Triangles *to) {
  int paths[3][MOST_PARTS + 1], divided = 0, odd = 0;
  bool is_divided[3];
  to->count = 0;
  for (int k = 0; k < 3; k++) {
    is_divided[k] = walk(smooth, corners[k], corners[(k + 1) % 3], paths[k]) > 1;
    divided += is_divided[k];
  }
  if (divided == 0) add_triangle(to, corners[0], corners[1], corners[2]);
  for (int k = 0; k < 3; k++)
    if (is_divided[k] == (divided == 1)) odd = k;
  if (divided == 1)
    for (int i = 0; i < smooth->parts; i++)
      add_triangle(to, paths[odd][i], paths[odd][i + 1], corners[(odd + 2) % 3]);
  if (divided == 2) {
    int back[MOST_PARTS + 1];
    for (int i = 0; i <= smooth->parts; i++) back[i] = paths[(odd + 1) % 3][smooth->parts - i];
    add_strip(to, paths[(odd + 2) % 3], back, smooth->parts);
  }
  if (divided == 3 && inner >= 0) add_lattice(to, paths, inner);
  if (divided == 3 && inner < 0) add_corners(to, paths, smooth->parts);
}

// ---- The mean way off the chords.

void contact_smooth_row_add(ContactSmoothRow *row, int vertex, double weight) {
  for (int k = 0; k < row->count; k++)
    if (row->nodes[k] == vertex) {
      row->weights[k] += weight;
      return;
    }
  if (row->count == CONTACT_SMOOTH_ROW_COUNT) {
    row->weights[0] += weight;
    return;
  }
  row->nodes[row->count] = vertex;
  row->weights[row->count++] = weight;
}

// Adds scale times a point's way off its chord.
static void add_way(const ContactSmooth *smooth, int point, double scale, ContactSmoothRow *row) {
  const int *nodes;
  double weights[CONTACT_FIT_MOST_COUNT];
  int count = contact_smooth_carry(smooth, point, &nodes, weights);
  for (int k = 0; k < count; k++) {
    double prior = k < smooth->owns[point] ? smooth->priors[point][k] : 0;
    contact_smooth_row_add(row, nodes[k], scale * (weights[k] - prior));
  }
}

static Vec3 chord_of(const ContactSmooth *smooth, int vertex) {
  int point = vertex - smooth->def->vertex_count;
  Vec3 sum = {0, 0, 0};
  if (point < 0) return rest_of(smooth, vertex);
  for (int k = 0; k < smooth->owns[point]; k++)
    sum = vec3_add(
        sum, vec3_scale(smooth->priors[point][k], rest_of(smooth, smooth->nodes[smooth->begin[point] + k])));
  return sum;
}

static double area_of(Vec3 a, Vec3 b, Vec3 c) {
  return vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / 2;
}

static void cut_face(const ContactSmooth *smooth, const int corners[3], int inner, Triangles *to);

static void cut_skin_face(const ContactSmooth *smooth, int f, Triangles *to) {
  int inner = smooth->face_points[f] < 0 ? -1 : smooth->def->vertex_count + smooth->face_points[f];
  cut_face(smooth, smooth->skin.faces[f].vertices, inner, to);
}

// ∫_f (x − chord) dA of a face, times scale.
static void add_face_way(const ContactSmooth *smooth, int f, double scale, ContactSmoothRow *row) {
  Triangles triangles;
  cut_skin_face(smooth, f, &triangles);
  for (int t = 0; t < triangles.count; t++) {
    const int *c = triangles.corners[t];
    double area = area_of(chord_of(smooth, c[0]), chord_of(smooth, c[1]), chord_of(smooth, c[2]));
    for (int v = 0; v < 3; v++)
      if (c[v] >= smooth->def->vertex_count)
        add_way(smooth, c[v] - smooth->def->vertex_count, scale * area / 3, row);
  }
}

static Vec3 place_of_row(const ContactSmooth *smooth, const ContactSmoothRow *row) {
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < row->count; k++)
    sum = vec3_add(sum, vec3_scale(row->weights[k], rest_of(smooth, row->nodes[k])));
  return sum;
}

// A vector at rest, as a tetrahedron carries it: ∇λ_k · vector of its corners k.
static void add_carried(const ContactSmooth *smooth, int tet, Vec3 vector, ContactSmoothRow *row) {
  const int *v = smooth->def->tets[tet];
  Vec3 x[4];
  for (int k = 0; k < 4; k++) x[k] = rest_of(smooth, v[k]);
  double six = vec3_det4(x[0], x[1], x[2], x[3]), last = 0;
  for (int k = 1; k < 4; k++) {
    Vec3 a = vec3_sub(x[k % 3 + 1], x[0]), b = vec3_sub(x[(k + 1) % 3 + 1], x[0]);
    double share = vec3_dot(vec3_cross(a, b), vector) / six;
    contact_smooth_row_add(row, v[k], share);
    last -= share;
  }
  contact_smooth_row_add(row, v[0], last);
}

void contact_smooth_settle(const ContactSmooth *smooth, int vertex, double share, ContactSmoothRow *row) {
  const ContactSkin *skin = &smooth->skin;
  int local = vertex - skin->vertex_begin, begin = skin->begin[local], end = skin->begin[local + 1];
  ContactSmoothRow mean = {.count = 0};
  double area = 0;
  if (!smooth->is_near[local]) return;
  for (int r = begin; r < end; r++) area += skin->faces[skin->list[r]].area;
  for (int r = begin; r < end; r++) add_face_way(smooth, skin->list[r], 1 / area, &mean);
  Vec3 at_rest = place_of_row(smooth, &mean);
  for (int k = 0; k < mean.count; k++) contact_smooth_row_add(row, mean.nodes[k], -share * mean.weights[k]);
  for (int r = begin; r < end; r++) {
    const ContactSkinFace *face = &skin->faces[skin->list[r]];
    add_carried(smooth, face->tet, vec3_scale(share * face->area / area, at_rest), row);
  }
}

// ---- Tetrahedra in cells.

// What is known of a tetrahedron: its faces in triangles, seen from outside.
typedef struct Tet {
  int corners[4];
  Triangles faces[4];  // opposite to each corner
  unsigned outer;      // bit f: face f is on the surface
  unsigned bent;       // ... and no longer flat
  unsigned on_divided; // bit v: corner v ends a divided edge
} Tet;

static const int OUTWARD[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

static Vec3 normal_of(const ContactSmooth *smooth, const int triangle[3]) {
  Vec3 a = place_of(smooth, triangle[0]);
  return vec3_cross(vec3_sub(place_of(smooth, triangle[1]), a), vec3_sub(place_of(smooth, triangle[2]), a));
}

static bool is_bent(const ContactSmooth *smooth, const Triangles *face) {
  Vec3 first = normal_of(smooth, face->corners[0]);
  for (int t = 1; t < face->count; t++) {
    Vec3 other = normal_of(smooth, face->corners[t]);
    if (!(vec3_dot(first, other) > (1 - STRAIGHT) * vec3_length(first) * vec3_length(other))) return true;
  }
  return false;
}

// The face of the skin with these corners; −1: it is within the body.
static int find_face(const ContactSmooth *smooth, const int corners[3]) {
  int e = contact_skin_edge(&smooth->skin, corners[0], corners[1]);
  for (int side = 0; side < 2 && e >= 0; side++) {
    int f = smooth->skin.edges[e].faces[side];
    if (f < 0) continue;
    const int *v = smooth->skin.faces[f].vertices;
    if (v[0] == corners[2] || v[1] == corners[2] || v[2] == corners[2]) return f;
  }
  return -1;
}

// The three points within a face are numbered by its first three corners; here from this one on.
static void cut_tet_face(const ContactSmooth *smooth, Tet *tet, int f, bool is_mirrored) {
  int corners[3];
  for (int k = 0; k < 3; k++) corners[k] = tet->corners[OUTWARD[f][is_mirrored ? 2 - k : k]];
  int face = find_face(smooth, corners);
  if (face >= 0) {
    memcpy(corners, smooth->skin.faces[face].vertices, sizeof corners);
    tet->outer |= 1u << f;
  }
  int inner = face >= 0 && smooth->face_points[face] >= 0
                  ? smooth->def->vertex_count + smooth->face_points[face]
                  : -1;
  cut_face(smooth, corners, inner, &tet->faces[f]);
  if (face >= 0 && is_bent(smooth, &tet->faces[f])) tet->bent |= 1u << f;
}

static bool look_at(const ContactSmooth *smooth, int number, Tet *tet) {
  int near = 0;
  memcpy(tet->corners, smooth->def->tets[number], sizeof tet->corners);
  for (int v = 0; v < 4; v++) near += smooth->is_near[tet->corners[v] - smooth->skin.vertex_begin];
  if (near < 2) return false;
  tet->outer = tet->bent = tet->on_divided = 0;
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++) {
      int e = contact_skin_edge(&smooth->skin, tet->corners[v], tet->corners[w]);
      if (e >= 0 && smooth->is_curved[e]) tet->on_divided |= 1u << v | 1u << w;
    }
  if (!tet->on_divided) return false;
  const int *c = tet->corners;
  bool is_mirrored = vec3_det4(rest_of(smooth, c[0]), rest_of(smooth, c[1]), rest_of(smooth, c[2]),
                               rest_of(smooth, c[3])) < 0;
  for (int f = 0; f < 4; f++) cut_tet_face(smooth, tet, f, is_mirrored);
  return true;
}

// The corner that cells may be made from; −1: they need a point inside.
static int apex_of(const Tet *tet) {
  if (tet->bent) return -1;
  for (int v = 0; v < 4; v++)
    if (!(tet->on_divided >> v & 1) && !(tet->outer & ~(1u << v))) return v;
  return -1;
}

static void add_cell(ContactSmoothCut *cut, const int triangle[3], int apex) {
  int *cell = cut->cells[cut->count++];
  cell[0] = triangle[1], cell[1] = triangle[0], cell[2] = triangle[2], cell[3] = apex;
}

static Vec3 inside_of(const ContactSmooth *smooth, const Tet *tet, const ContactSmoothCut *cut) {
  Vec3 sum = {0, 0, 0};
  for (int v = 0; v < 4; v++)
    sum = vec3_add(sum, vec3_scale(cut->inside[v], rest_of(smooth, tet->corners[v])));
  return sum;
}

// o as deep below each of the faces on the surface, were they flat; its depth is the mean of its heights over
// their triangles, by area.
static void place_inside(const ContactSmooth *smooth, const Tet *tet, ContactSmoothCut *cut) {
  double inverse[4] = {0}, sum = 0, area = 0, volume = 0;
  int count = 0;
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = rest_of(smooth, tet->corners[v]), cut->inside[v] = 0.25;
  double six = fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  cut->has_inside = true, cut->depth = INFINITY;
  for (int f = 0; f < 4; f++) {
    if (!(tet->outer >> f & 1)) continue;
    inverse[f] =
        vec3_length(normal_of(smooth, (int[]){tet->corners[OUTWARD[f][0]], tet->corners[OUTWARD[f][1]],
                                              tet->corners[OUTWARD[f][2]]})) /
        six;
    sum += inverse[f], count++;
  }
  if (count == 0) return;
  for (int f = 0; f < 4; f++)
    if (tet->outer >> f & 1) cut->inside[f] = count / (4 * sum) * inverse[f];
  Vec3 o = inside_of(smooth, tet, cut);
  for (int f = 0; f < 4; f++)
    for (int t = 0; t < tet->faces[f].count && tet->outer >> f & 1; t++) {
      const int *corners = tet->faces[f].corners[t];
      Vec3 normal = normal_of(smooth, corners);
      area += vec3_length(normal);
      volume += vec3_dot(normal, vec3_sub(place_of(smooth, corners[0]), o));
    }
  cut->depth = volume / area;
}

static bool make_cut(const ContactSmooth *smooth, int number, Tet *tet, ContactSmoothCut *cut) {
  cut->count = 0, cut->has_inside = false;
  if (!look_at(smooth, number, tet)) return false;
  int apex = apex_of(tet);
  if (apex < 0) place_inside(smooth, tet, cut);
  for (int f = 0; f < 4; f++)
    for (int t = 0; t < tet->faces[f].count && (apex < 0 || f == apex); t++)
      add_cell(cut, tet->faces[f].corners[t], apex < 0 ? CONTACT_SMOOTH_INSIDE : tet->corners[apex]);
  return true;
}

bool contact_smooth_cut(const ContactSmooth *smooth, int tet, ContactSmoothCut *cut) {
  Tet own;
  return make_cut(smooth, tet, &own, cut);
}

// ---- Cells that would be inside out.

static bool is_sound(const ContactSmooth *smooth, const Tet *tet, const ContactSmoothCut *cut) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = rest_of(smooth, tet->corners[v]);
  double least = FLAT * fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  Vec3 o = cut->has_inside ? inside_of(smooth, tet, cut) : x[0];
  for (int c = 0; c < cut->count; c++) {
    const int *cell = cut->cells[c];
    for (int v = 0; v < 4; v++) x[v] = cell[v] == CONTACT_SMOOTH_INSIDE ? o : place_of(smooth, cell[v]);
    if (!(vec3_det4(x[0], x[1], x[2], x[3]) > least)) return false;
  }
  return !cut->has_inside || cut->depth > 0;
}

static void choose_share(ContactSmooth *smooth, int e, double share) {
  smooth->shares[e] = share;
  for (int k = 0; k < smooth->parts - 1; k++) {
    double *chosen = &smooth->chosen[smooth->edge_points[e] + k];
    *chosen = fmin(*chosen, share);
  }
}

// Halves the shares of its edges, those below a half to 0. False: there is nothing left to draw back.
static bool draw_back(ContactSmooth *smooth, const Tet *tet) {
  bool has_changed = false;
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++) {
      int e = contact_skin_edge(&smooth->skin, tet->corners[v], tet->corners[w]);
      if (e < 0 || !smooth->is_curved[e] || smooth->shares[e] == 0) continue;
      choose_share(smooth, e, smooth->shares[e] > 0.5 ? smooth->shares[e] / 2 : 0);
      has_changed = true;
    }
  return has_changed;
}

static void keep_sound(ContactSmooth *smooth, const ContactBody *body) {
  Tet tet;
  ContactSmoothCut cut;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (int i = body->tet_begin; i < body->tet_end; i++)
      if (make_cut(smooth, i, &tet, &cut) && !is_sound(smooth, &tet, &cut) && draw_back(smooth, &tet))
        has_changed = true;
    follow_edges(smooth);
  }
}

// ---- All of it.

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

Status contact_smooth_create(ContactSmooth *smooth, const ContactSystemDef *def, const ContactBody *body,
                             int level, double crease) {
  *smooth = (ContactSmooth){.def = def, .parts = 1 << level, .crease = crease};
  TRY(contact_skin_create(&smooth->skin, def, body, crease));
  TRY(reserve(smooth));
  const ContactSkin *skin = &smooth->skin;
#pragma omp parallel for schedule(static) if (skin->edge_count > 512)
  for (int e = 0; e < skin->edge_count; e++) smooth->bulges[e] = bulge_of(smooth, e);
  for (int e = 0; e < skin->edge_count; e++) choose_edge(smooth, e);
  for (int e = 0; e < skin->edge_count; e++)
    if (smooth->is_curved[e]) TRY(add_edge_points(smooth, e));
  for (int f = 0; f < skin->face_count && smooth->parts == MOST_PARTS; f++)
    if (is_all_curved(smooth, &skin->faces[f])) TRY(add_face_points(smooth, f));
  follow_edges(smooth);
  keep_sound(smooth, body);
  return STATUS_OK;
}

void contact_smooth_destroy(ContactSmooth *smooth) {
  contact_skin_destroy(&smooth->skin);
  void *arrays[] = {smooth->is_curved,   smooth->shares,  smooth->bulges, smooth->edge_points,
                    smooth->face_points, smooth->is_near, smooth->begin,  smooth->nodes,
                    smooth->weights,     smooth->owns,    smooth->priors, smooth->chosen};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *smooth = (ContactSmooth){0};
}
