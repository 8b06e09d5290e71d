// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/stars.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/limits.h"
#include "contact/surface/smooth/fit.h"
#include "contact/surface/smooth/smooth.h"
#include "contact/surface/smooth/smooth_row.h"
#include "contact/surface/surface.h"

// Of a quadratic element; of a star at most.
enum { NODE_COUNT = 10, FACE_COUNT = 4, EIGHTH_COUNT = 8, CELL_COUNT = 24 };

// The node in the middle of two corners.
static const int MIDDLE[4][4] = {{-1, 4, 5, 6}, {4, -1, 7, 8}, {5, 7, -1, 9}, {6, 8, 9, -1}};

// The face opposite to a corner by its nodes: three corners, outward, then the middles that follow each of
// them.
typedef struct Face {
  int nodes[6];
} Face;

static Face face_of(int corner) {
  static const int OUTWARD[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  Face face;
  memcpy(face.nodes, OUTWARD[corner], sizeof OUTWARD[corner]);
  for (int k = 0; k < 3; k++) face.nodes[3 + k] = MIDDLE[face.nodes[k]][face.nodes[(k + 1) % 3]];
  return face;
}

// A place in the list of a star, o.
enum { INSIDE = NODE_COUNT + FACE_COUNT };

// A star: cells by places in a list of the element's ten nodes, the fans' centres (10 + face) and o (14).
typedef struct Star {
  int cells[CELL_COUNT][4];
  int count;
  unsigned outer;     // bit f: face f has a fan
  Vec3 x[INSIDE + 1]; // of the list, at rest
  double weights[INSIDE + 1][NODE_COUNT];
} Star;

// N_a at barycentric coordinates.
static void find_shape_functions(const double lambda[4], double shape[NODE_COUNT]) {
  for (int v = 0; v < 4; v++) shape[v] = lambda[v] * (2 * lambda[v] - 1);
  for (int v = 0; v < 4; v++)
    for (int w = 0; w < v; w++) shape[MIDDLE[v][w]] = 4 * lambda[v] * lambda[w];
}

// ---- A fan's centre.

// A face's nodes at rest, in the order of `Face`, and what an even pressure of 1 puts on them along the
// normal.
typedef struct FaceLoad {
  Vec3 x[6], normal;
  double share[6]; // [m²]
} FaceLoad;

// ∫ N_a dA of the quadratic face by six points that integrate the fourth degree exactly (Cowper 1973).
static void add_quadratic_shares(FaceLoad *load) {
  static const double POINTS[2][2] = {{0.445948490915965, 0.223381589678011},
                                      {0.091576213509771, 0.109951743655322}};
  for (int k = 0; k < 6; k++) {
    double a = POINTS[k / 3][0], l[3] = {a, a, a}, shape[6], along[2][6];
    l[k % 3] = 1 - 2 * a;
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3;
      static const double SLOPES[2][3] = {{-1, 1, 0}, {-1, 0, 1}}; // of l by the two coordinates
      shape[i] = l[i] * (2 * l[i] - 1), shape[3 + i] = 4 * l[i] * l[j];
      for (int c = 0; c < 2; c++) {
        along[c][i] = (4 * l[i] - 1) * SLOPES[c][i];
        along[c][3 + i] = 4 * (l[i] * SLOPES[c][j] + l[j] * SLOPES[c][i]);
      }
    }
    Vec3 tangent[2] = {{0, 0, 0}, {0, 0, 0}};
    for (int c = 0; c < 2; c++)
      for (int n = 0; n < 6; n++) tangent[c] = vec3_add(tangent[c], vec3_scale(along[c][n], load->x[n]));
    double area = 0.5 * POINTS[k / 3][1] * vec3_dot(vec3_cross(tangent[0], tangent[1]), load->normal);
    for (int n = 0; n < 6; n++) load->share[n] += area * shape[n];
  }
}

// Less what lies between a curved edge and the two chords of the fan: the neighbour's fan has it. A node in
// the middle that is outwards by d leaves an area of d · length / 6 there, of which 7/10 are the middle's.
static void leave_out_slivers(FaceLoad *load) {
  for (int k = 0; k < 3; k++) {
    Vec3 from = load->x[k], to = load->x[(k + 1) % 3], middle = vec3_scale(0.5, vec3_add(from, to));
    Vec3 outward = vec3_cross(vec3_sub(to, from), load->normal);
    double area = vec3_dot(vec3_sub(load->x[3 + k], middle), outward) / 6;
    load->share[3 + k] -= 7.0 / 10 * area;
    load->share[k] -= 3.0 / 20 * area;
    load->share[(k + 1) % 3] -= 3.0 / 20 * area;
  }
}

// Weights of the six nodes with which the fan's shares are these, from those for a centre at `at`. Of a
// straight face −⅓ and ⅔.
static void weigh_fan(const FaceLoad *load, Vec3 at, double weights[6]) {
  static const int RING[6] = {0, 3, 1, 4, 2, 5};
  double own[6] = {0}, whole = 0, sum = 0;
  for (int k = 0; k < 6; k++) {
    int a = RING[k], b = RING[(k + 1) % 6];
    double area =
        0.5 * vec3_dot(vec3_cross(vec3_sub(load->x[a], at), vec3_sub(load->x[b], at)), load->normal);
    own[a] += area / 3, own[b] += area / 3, whole += area;
  }
  for (int n = 0; n < 6; n++) weights[n] = 3 * (load->share[n] - own[n]) / whole, sum += weights[n];
  for (int n = 3; n < 6; n++) weights[n] += (1 - sum) / 3;
}

static void weigh_centre(const Vec3 x[NODE_COUNT], int face, double weights[NODE_COUNT]) {
  Face nodes = face_of(face);
  FaceLoad load = {.share = {0}};
  double own[6], moved = INFINITY, before;
  Vec3 at = {0, 0, 0}, from;
  for (int n = 0; n < 6; n++) load.x[n] = x[nodes.nodes[n]];
  load.normal = vec3_cross(vec3_sub(load.x[1], load.x[0]), vec3_sub(load.x[2], load.x[0]));
  load.normal = vec3_scale(1 / vec3_length(load.normal), load.normal);
  add_quadratic_shares(&load);
  leave_out_slivers(&load);
  for (int n = 0; n < 3; n++) at = vec3_add(at, vec3_scale(1.0 / 3, load.x[n]));
  do { // the centre moves the areas by a share of the edges' offsets, so it converges fast, until all is
       // rounding
    from = at, before = moved;
    weigh_fan(&load, at, own);
    at = (Vec3){0, 0, 0};
    for (int n = 0; n < 6; n++) at = vec3_add(at, vec3_scale(own[n], load.x[n]));
    moved = vec3_length(vec3_sub(at, from));
  } while (moved < before);
  memset(weights, 0, NODE_COUNT * sizeof *weights);
  for (int n = 0; n < 6; n++) weights[nodes.nodes[n]] = own[n];
}

// o, as deep below each of the outer faces, were they straight.
static void weigh_inside(const Vec3 x[NODE_COUNT], unsigned outer, double weights[NODE_COUNT]) {
  double lambda[4] = {0.25, 0.25, 0.25, 0.25}, inverse[4], sum = 0;
  double six = fabs(vec3_det4(x[0], x[1], x[2], x[3]));
  int count = 0;
  for (int f = 0; f < 4; f++) {
    if (!(outer >> f & 1)) continue;
    Vec3 a = x[(f + 1) % 4], b = x[(f + 2) % 4], c = x[(f + 3) % 4];
    inverse[f] = vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / six;
    sum += inverse[f], count++;
  }
  for (int f = 0; f < 4; f++)
    if (outer >> f & 1) lambda[f] = count / (4 * sum) * inverse[f];
  find_shape_functions(lambda, weights);
}

static void place_carried(Star *star, int place) {
  star->x[place] = (Vec3){0, 0, 0};
  for (int a = 0; a < NODE_COUNT; a++)
    star->x[place] = vec3_add(star->x[place], vec3_scale(star->weights[place][a], star->x[a]));
}

// Over a triangle that is given outward.
static void add_cell(Star *star, int a, int b, int c) {
  int *cell = star->cells[star->count++];
  cell[0] = b, cell[1] = a, cell[2] = c, cell[3] = INSIDE;
}

static void cut_face(Star *star, int face, bool is_outer) {
  Face f = face_of(face);
  for (int k = 0; k < 3; k++) {
    int corner = f.nodes[k], after = f.nodes[3 + k], before = f.nodes[3 + (k + 2) % 3];
    if (!is_outer) {
      add_cell(star, corner, after, before);
      continue;
    }
    add_cell(star, corner, after, NODE_COUNT + face);
    add_cell(star, before, corner, NODE_COUNT + face);
  }
  if (!is_outer) add_cell(star, f.nodes[3], f.nodes[4], f.nodes[5]);
}

// Cuts an element with these faces on the surface. False: it is so curved that a cell would be flat or inside
// out.
static bool make_star(Star *star, const Vec3 x[NODE_COUNT], unsigned outer) {
  double least = CONTACT_FLAT * vec3_det4(x[0], x[1], x[2], x[3]);
  memset(star->weights, 0, sizeof star->weights);
  memcpy(star->x, x, NODE_COUNT * sizeof *x);
  star->count = 0, star->outer = outer;
  weigh_inside(x, outer, star->weights[INSIDE]);
  place_carried(star, INSIDE);
  for (int f = 0; f < 4; f++) {
    if (outer >> f & 1) {
      weigh_centre(x, f, star->weights[NODE_COUNT + f]);
      place_carried(star, NODE_COUNT + f);
    }
    cut_face(star, f, outer >> f & 1);
  }
  for (int c = 0; c < star->count; c++) {
    const int *cell = star->cells[c];
    if (!(vec3_det4(star->x[cell[0]], star->x[cell[1]], star->x[cell[2]], star->x[cell[3]]) > least))
      return false;
  }
  return true;
}

// ---- The faces on the surface.

// Bit f of an element: its face opposite to corner f is on the surface, and is none of those that are
// declared not to be. `outer` by the elements of the definition.
static Status find_outer(const ContactSystemDef *def, const ContactBody *body, const int (*corners)[4],
                         unsigned char *outer) {
  ContactSurface surface;
  TRY(contact_surface_find(&surface, corners, body->quadratic_begin, body->quadratic_end));
  for (int f = 0; f < surface.count; f++) {
    const ContactSurfaceFace *face = &surface.faces[f];
    const int *v = face->vertices;
    bool is_inner = def->inner && (def->inner[v[0]] & def->inner[v[1]] & def->inner[v[2]]);
    if (!is_inner) outer[face->tet] |= (unsigned char)(1 << face->corner);
  }
  contact_surface_destroy(&surface);
  return STATUS_OK;
}

// ---- The mesh.

// What creation works on.
typedef struct Work {
  const ContactSystemDef *given;
  ContactStars *stars;
  unsigned char *outer;   // of each quadratic element
  ContactSmooth *smooths; // (body_count)
  int tet_count, vertex_count, row_count;
} Work;

static Status no_memory(void) {
  return status_no_memory("the contact mesh of curved bodies");
}

// Room for one vertex more.
static bool reserve_vertex(Work *work, int count) {
  ContactStars *stars = work->stars;
  size_t rows = (size_t)(work->row_count + count), vertices = (size_t)work->vertex_count + 1;
  return memory_reserve((void **)&stars->begin, &stars->begin_capacity, vertices + 1, sizeof(int)) &&
         memory_reserve((void **)&stars->heights, &stars->height_capacity, vertices, sizeof(double)) &&
         memory_reserve((void **)&stars->inner, &stars->inner_capacity, vertices, 1) &&
         memory_reserve((void **)&stars->nodes, &stars->row_capacity, rows, sizeof(int)) &&
         memory_reserve((void **)&stars->weights, &stars->weight_capacity, rows, sizeof(double));
}

// Between the first `own` nodes, which say whether it is on a part of the boundary that is no surface.
static Status add_vertex(Work *work, int count, const int *nodes, const double *weights, int own,
                         int *number) {
  ContactStars *stars = work->stars;
  const unsigned char *inner = work->given->inner;
  if (!reserve_vertex(work, count)) return no_memory();
  *number = work->vertex_count++;
  stars->heights[*number] = NAN;
  stars->inner[*number] = inner ? 0xff : 0;
  for (int k = 0; k < count; k++) {
    if (weights[k] == 0) continue;
    stars->nodes[work->row_count] = nodes[k];
    stars->weights[work->row_count++] = weights[k];
    if (inner && k < own) stars->inner[*number] &= inner[nodes[k]];
  }
  stars->begin[work->vertex_count] = work->row_count;
  return STATUS_OK;
}

static Status add_tet(Work *work, int origin, bool is_star, const int vertices[4]) {
  ContactStars *stars = work->stars;
  size_t count = (size_t)work->tet_count + 1;
  if (!memory_reserve((void **)&stars->tets, &stars->tet_capacity, count, sizeof *stars->tets) ||
      !memory_reserve((void **)&stars->origin, &stars->origin_capacity, count, sizeof(int)) ||
      !memory_reserve((void **)&stars->is_star, &stars->star_capacity, count, sizeof(bool)))
    return no_memory();
  memcpy(stars->tets[work->tet_count], vertices, sizeof *stars->tets);
  stars->origin[work->tet_count] = origin;
  stars->is_star[work->tet_count++] = is_star;
  return STATUS_OK;
}

static Status keep_tet(Work *work, int tet) {
  int vertices[4];
  for (int v = 0; v < 4; v++) vertices[v] = work->stars->place[work->given->tets[tet][v]];
  return add_tet(work, tet, false, vertices);
}

static Status add_star(Work *work, const int nodes[NODE_COUNT], const Star *star, int origin) {
  int numbers[INSIDE + 1];
  for (int a = 0; a < NODE_COUNT; a++) numbers[a] = work->stars->place[nodes[a]];
  for (int k = NODE_COUNT; k < INSIDE + 1; k++)
    if (k == INSIDE || star->outer >> (k - NODE_COUNT) & 1)
      TRY(add_vertex(work, NODE_COUNT, nodes, star->weights[k], NODE_COUNT, &numbers[k]));
  for (int c = 0; c < star->count; c++) {
    int vertices[4];
    for (int v = 0; v < 4; v++) vertices[v] = numbers[star->cells[c][v]];
    TRY(add_tet(work, origin, true, vertices));
  }
  return STATUS_OK;
}

static Status add_element(Work *work, const ContactBody *body, int element) {
  const ContactSystemDef *given = work->given;
  const int *nodes = given->quadratics[element];
  int first = body->tet_begin + EIGHTH_COUNT * (element - body->quadratic_begin);
  Star star;
  Vec3 x[NODE_COUNT];
  for (int a = 0; a < NODE_COUNT; a++) x[a] = vec3_at(given->rest + 3 * (size_t)nodes[a]);
  if (work->outer[element] && make_star(&star, x, work->outer[element]))
    return add_star(work, nodes, &star, first);
  for (int i = first; i < first + EIGHTH_COUNT; i++) TRY(keep_tet(work, i));
  return STATUS_OK;
}

// `near`: a vertex that the row is at.
static Status add_row(Work *work, int near, const ContactSmoothRow *row, int own, int *number) {
  if (!row->is_full) return add_vertex(work, row->count, row->nodes, row->weights, own, number);
  int b = 0;
  while (near >= work->given->bodies[b].vertex_end) b++;
  return status_fail(
      STATUS_INPUT,
      "contact.smooth: body '%s': more than %d vertices lie round vertex %d, on faces that meet "
      "there; mesh the body anew, or write smooth: 0",
      work->given->bodies[b].name, CONTACT_SMOOTH_ROW_COUNT, near - work->given->bodies[b].vertex_begin);
}

// A vertex of a smooth surface, near which points are.
static Status add_settled(Work *work, const ContactSmooth *smooth, int vertex) {
  ContactSmoothRow row;
  row.count = 0, row.is_full = false;
  contact_smooth_row_add(&row, vertex, 1);
  contact_smooth_row_settle(smooth, vertex, 1, &row);
  return add_row(work, vertex, &row, 1, &work->stars->place[vertex]);
}

// The points of a smooth surface; that of number p becomes vertex first + p.
static Status add_points(Work *work, const ContactSmooth *smooth, int *first) {
  *first = work->vertex_count;
  for (int p = 0; p < smooth->point_count; p++) {
    double weights[CONTACT_FIT_MOST_COUNT];
    const int *nodes;
    int number, count = contact_smooth_points_carry(smooth, p, &nodes, weights), own = smooth->owns[p];
    ContactSmoothRow row;
    row.count = 0, row.is_full = false;
    for (int k = 0; k < count; k++) contact_smooth_row_add(&row, nodes[k], weights[k]);
    for (int k = 0; k < own; k++) contact_smooth_row_settle(smooth, nodes[k], smooth->priors[p][k], &row);
    TRY(add_row(work, nodes[0], &row, own, &number));
  }
  return STATUS_OK;
}

static Status add_cut(Work *work, int tet, const ContactSmoothCut *cut, int first) {
  int inside = -1;
  if (cut->has_inside) {
    TRY(add_vertex(work, 4, work->given->tets[tet], cut->inside, 4, &inside));
    if (cut->depth < INFINITY) work->stars->heights[inside] = cut->depth;
  }
  for (int c = 0; c < cut->count; c++) {
    int vertices[4];
    for (int v = 0; v < 4; v++) {
      int from = cut->cells[c][v], given_count = work->given->vertex_count;
      vertices[v] = from == CONTACT_SMOOTH_INSIDE ? inside
                    : from < given_count          ? work->stars->place[from]
                                                  : first + from - given_count;
    }
    TRY(add_tet(work, tet, false, vertices));
  }
  return STATUS_OK;
}

// Of a linear tetrahedron, or of an eighth; the points begin at `first`.
static Status add_smooth(Work *work, const ContactSmooth *smooth, int tet, int first) {
  ContactSmoothCut cut;
  if (smooth->curved_count > 0 && contact_smooth_cut(smooth, tet, &cut))
    return add_cut(work, tet, &cut, first);
  return keep_tet(work, tet);
}

static bool has_cut(const ContactSmooth *smooth, int tet_begin, int tet_end) {
  ContactSmoothCut cut;
  for (int i = tet_begin; i < tet_end && smooth->curved_count > 0; i++)
    if (contact_smooth_cut(smooth, i, &cut)) return true;
  return false;
}

// An element of which an eighth is cut: eighths, so that neighbours fit.
static Status add_quadratic(Work *work, const ContactBody *body, const ContactSmooth *smooth, int element,
                            int first) {
  int begin = body->tet_begin + EIGHTH_COUNT * (element - body->quadratic_begin), end = begin + EIGHTH_COUNT;
  if (!has_cut(smooth, begin, end)) return add_element(work, body, element);
  for (int i = begin; i < end; i++) TRY(add_smooth(work, smooth, i, first));
  return STATUS_OK;
}

static Status add_tets(Work *work, int b) {
  const ContactBody *body = &work->given->bodies[b];
  const ContactSmooth *smooth = &work->smooths[b];
  bool is_linear = body->quadratic_begin == body->quadratic_end;
  int first = 0;
  if (smooth->curved_count > 0) TRY(add_points(work, smooth, &first));
  for (int i = body->tet_begin; is_linear && i < body->tet_end; i++) TRY(add_smooth(work, smooth, i, first));
  for (int e = body->quadratic_begin; e < body->quadratic_end; e++)
    TRY(add_quadratic(work, body, smooth, e, first));
  return STATUS_OK;
}

static Status add_body(Work *work, int b) {
  const ContactBody *given = &work->given->bodies[b];
  ContactBody *body = &work->stars->bodies[b];
  body->vertex_begin = work->vertex_count, body->tet_begin = work->tet_count;
  const ContactSmooth *smooth = &work->smooths[b];
  for (int v = given->vertex_begin; v < given->vertex_end; v++) {
    if (smooth->curved_count > 0)
      TRY(add_settled(work, smooth, v));
    else
      TRY(add_vertex(work, 1, &v, &(double){1}, 1, &work->stars->place[v]));
  }
  TRY(add_tets(work, b));
  body->vertex_end = work->vertex_count, body->tet_end = work->tet_count;
  body->quadratic_begin = body->quadratic_end = 0;
  return STATUS_OK;
}

static Status finish(Work *work) {
  ContactStars *stars = work->stars;
  const ContactSystemDef *given = work->given;
  ContactSystemDef *def = &stars->def;
  def->vertex_count = work->vertex_count, def->tet_count = work->tet_count;
  stars->rest = memory_zeroed((size_t)work->vertex_count, 3 * sizeof(double));
  stars->given = memory_zeroed((size_t)work->vertex_count, sizeof *stars->given);
  if (!stars->rest || !stars->given) return no_memory();
  for (int v = 0; v < work->vertex_count; v++) stars->given[v] = -1;
  for (int v = 0; v < given->vertex_count; v++) stars->given[stars->place[v]] = v;
  contact_stars_place(stars, given->rest, stars->rest);
  def->rest = stars->rest, def->bodies = stars->bodies, def->heights = stars->heights;
  def->inner = given->inner ? stars->inner : NULL;
  def->tets = (const int(*)[4])stars->tets, def->origin = stars->origin;
  def->origin_count = given->tet_count;
  def->quadratics = NULL;
  return STATUS_OK;
}

static Status build(Work *work, int quadratic_count, int (*corners)[4]) {
  const ContactSystemDef *given = work->given;
  ContactStars *stars = work->stars;
  stars->bodies = memory_copy(given->bodies, (size_t)given->body_count, sizeof *stars->bodies);
  stars->place = memory_zeroed((size_t)given->vertex_count, sizeof *stars->place);
  work->outer = memory_zeroed((size_t)quadratic_count, 1);
  if (!stars->bodies || !stars->place || !work->outer || !corners) return no_memory();
  for (int e = 0; e < quadratic_count; e++) memcpy(corners[e], given->quadratics[e], sizeof corners[e]);
  for (int b = 0; b < given->body_count; b++)
    TRY(find_outer(given, &given->bodies[b], (const int(*)[4])corners, work->outer));
  for (int b = 0; b < given->body_count; b++) TRY(add_body(work, b));
  return finish(work);
}

// The surfaces that are wanted smooth; whether one is curved.
static Status find_smooth(Work *work, bool *has_curved) {
  const ContactSystemDef *given = work->given;
  for (int b = 0; b < given->body_count; b++) {
    const ContactBody *body = &given->bodies[b];
    if (body->smooth == 0) continue;
    TRY(contact_smooth_create(&work->smooths[b], given, body, body->smooth, given->crease));
    if (work->smooths[b].curved_count > 0) *has_curved = true;
  }
  return STATUS_OK;
}

static Status create(Work *work) {
  const ContactSystemDef *given = work->given;
  int quadratic_count = 0;
  work->smooths = memory_zeroed((size_t)given->body_count, sizeof *work->smooths);
  if (!work->smooths) return no_memory();
  for (int b = 0; b < given->body_count; b++)
    if (given->bodies[b].quadratic_end > quadratic_count) quadratic_count = given->bodies[b].quadratic_end;
  work->stars->is_needed = quadratic_count > 0;
  TRY(find_smooth(work, &work->stars->is_needed));
  if (!work->stars->is_needed) return STATUS_OK;
  int(*corners)[4] = memory_zeroed((size_t)quadratic_count, sizeof *corners);
  Status status = build(work, quadratic_count, corners);
  memory_free(corners);
  return status;
}

Status contact_stars_create(ContactStars *stars, const ContactSystemDef *def) {
  *stars =
      (ContactStars){.def = *def, .given_vertex_count = def->vertex_count, .given_tet_count = def->tet_count};
  if (def->potential != CONTACT_POTENTIAL_FIELD) return STATUS_OK;
  Work work = {.given = def, .stars = stars};
  Status status = create(&work);
  for (int b = 0; b < def->body_count && work.smooths; b++) contact_smooth_points_destroy(&work.smooths[b]);
  memory_free(work.smooths);
  memory_free(work.outer);
  return status;
}

void contact_stars_destroy(ContactStars *stars) {
  void *arrays[] = {stars->bodies,  stars->rest,  stars->inner, stars->tets,  stars->origin,  stars->heights,
                    stars->is_star, stars->place, stars->begin, stars->nodes, stars->weights, stars->given};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *stars = (ContactStars){0};
}

size_t contact_stars_bytes(const ContactStars *stars) {
  const void *const arrays[] = {stars->bodies, stars->rest,    stars->inner,   stars->tets,
                                stars->origin, stars->heights, stars->is_star, stars->place,
                                stars->begin,  stars->nodes,   stars->weights, stars->given};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

// ---- There and back.

void contact_stars_place(const ContactStars *stars, const double *given, double *values) {
#pragma omp parallel for schedule(static) if (stars->def.vertex_count > 4096)
  for (int v = 0; v < stars->def.vertex_count; v++) {
    Vec3 sum = {0, 0, 0};
    for (int r = stars->begin[v]; r < stars->begin[v + 1]; r++)
      sum = vec3_add(sum, vec3_scale(stars->weights[r], vec3_at(given + 3 * (size_t)stars->nodes[r])));
    vec3_store(values + 3 * (size_t)v, sum);
  }
}

void contact_stars_push(const ContactStars *stars, int vertex, Vec3 force, double *given) {
  if (!stars || !stars->is_needed) {
    vec3_accumulate(given + 3 * (size_t)vertex, force);
    return;
  }
  for (int r = stars->begin[vertex]; r < stars->begin[vertex + 1]; r++)
    vec3_accumulate(given + 3 * (size_t)stars->nodes[r], vec3_scale(stars->weights[r], force));
}

void contact_stars_cover(const ContactStars *stars, const double *covered, const double *given_volumes,
                         double *given) {
  for (int i = 0; i < stars->given_tet_count; i++) given[i] = 0;
  for (int i = 0; i < stars->def.tet_count; i++) {
    double whole = 0, *at = given + stars->origin[i];
    const double *volumes = given_volumes + stars->origin[i];
    if (!stars->is_star[i]) {
      at[0] += covered[i];
      continue;
    }
    if (covered[i] == 0) continue;
    for (int k = 0; k < EIGHTH_COUNT; k++) whole += volumes[k];
    for (int k = 0; k < EIGHTH_COUNT; k++) at[k] += covered[i] * volumes[k] / whole;
  }
}

void contact_stars_spread(const ContactStars *stars, int *values) {
  for (int i = 0; stars->is_needed && i < stars->def.tet_count; i++)
    for (int k = 1; stars->is_star[i] && k < EIGHTH_COUNT; k++)
      values[stars->origin[i] + k] = values[stars->origin[i]];
}
