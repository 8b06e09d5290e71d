// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/probe/line.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/shape/ball.h"
#include "contact/surface/surface.h"

static const double ROUNDING = 1e-6; // of an element's longest edge: meshes are written in single precision

// So far below a round surface lies a facet whose edge is one, if four or more make a circle: ½ tan(90°/4).
static const double SAGITTA = 0.2071;

static void corners_of(const FemMesh *mesh, int tet, Vec3 x[4]) {
  for (int k = 0; k < 4; k++) x[k] = vec3_at(mesh->rest + 3 * (size_t)mesh->tets[tet][k]);
}

static double longest_edge(const Vec3 x[4]) {
  double longest = 0;
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < a; b++) longest = fmax(longest, vec3_length(vec3_sub(x[a], x[b])));
  return longest;
}

static void box_of(const Vec3 x[4], double low[3], double high[3]) {
  for (int c = 0; c < 3; c++) {
    low[c] = INFINITY, high[c] = -INFINITY;
    for (int k = 0; k < 4; k++) {
      double value = c == 0 ? x[k].x : c == 1 ? x[k].y : x[k].z;
      low[c] = fmin(low[c], value), high[c] = fmax(high[c], value);
    }
  }
}

// How far a place is from a box, squared: no more than from what is in it.
static double box_distance2(const double low[3], const double high[3], Vec3 at) {
  const double p[3] = {at.x, at.y, at.z};
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double off = fmax(0, fmax(low[c] - p[c], p[c] - high[c]));
    sum += off * off;
  }
  return sum;
}

static Vec3 place_of(const Vec3 x[4], const double shares[4]) {
  Vec3 place = {0, 0, 0};
  for (int k = 0; k < 4; k++) place = vec3_add(place, vec3_scale(shares[k], x[k]));
  return place;
}

// The shares of a place within; of one outside those of the tetrahedron's nearest point. The distance
// squared.
static double project(const Vec3 x[4], Vec3 at, double shares[4]) {
  double tet[12], centre[3], volume = vec3_det4(x[0], x[1], x[2], x[3]), least = INFINITY;
  for (int k = 0; k < 4; k++) {
    Vec3 y[4] = {x[0], x[1], x[2], x[3]};
    y[k] = at;
    shares[k] = vec3_det4(y[0], y[1], y[2], y[3]) / volume;
    least = fmin(least, shares[k]);
    vec3_store(tet + 3 * k, x[k]);
  }
  if (least >= 0) return 0;
  vec3_store(centre, at);
  contact_ball_nearest(tet, centre, shares);
  Vec3 off = vec3_sub(at, place_of(x, shares));
  return vec3_dot(off, off);
}

// Where a point lies: between 0 and 1 along the line.
static double share_of(const FemLineDef *def, int k) {
  return (double)k / (def->points - 1);
}

static Vec3 point_of(const FemLineDef *def, int k) {
  const Vec3 from = vec3_at(def->from), way = vec3_sub(vec3_at(def->to), from);
  return vec3_add(from, vec3_scale(share_of(def, k), way));
}

// Which points of a line are within `margin` of a box in each direction, from *first to before *end; one more
// at both ends for rounding.
static void find_range(const FemLineDef *def, const double low[3], const double high[3], double margin,
                       int *first, int *end) {
  double least = 0, most = 1;
  for (int c = 0; c < 3; c++) {
    double way = def->to[c] - def->from[c], near = low[c] - margin - def->from[c],
           far = high[c] + margin - def->from[c];
    if (way == 0 && !(near <= 0 && far >= 0)) most = -INFINITY;
    if (way == 0) continue;
    least = fmax(least, fmin(near / way, far / way));
    most = fmin(most, fmax(near / way, far / way));
  }
  *first = *end = 0;
  if (!(least <= most)) return;
  *first = (int)fmax(0, ceil(least * (def->points - 1)) - 1);
  *end = (int)fmin(def->points, floor(most * (def->points - 1)) + 2);
}

// The element that is nearest to each point, the first of several, and the distance squared; INFINITY where
// all are farther than `margin`. Elements one after another: of each the points are known that it may have.
static void locate(const FemLineDef *def, const FemMesh *mesh, double margin, FemLinePoint *points,
                   double *nearest2) {
  for (int k = 0; k < def->points; k++) nearest2[k] = INFINITY;
  for (int t = 0; t < mesh->tet_count; t++) {
    Vec3 x[4];
    double low[3], high[3], shares[4];
    int first, end;
    corners_of(mesh, t, x);
    box_of(x, low, high);
    find_range(def, low, high, margin, &first, &end);
    for (int k = first; k < end; k++) {
      const Vec3 at = point_of(def, k);
      if (!(box_distance2(low, high, at) < nearest2[k])) continue;
      double distance2 = project(x, at, shares);
      if (!(distance2 < nearest2[k])) continue;
      nearest2[k] = distance2;
      points[k].tet = t;
      memcpy(points[k].shares, shares, sizeof shares);
    }
  }
}

// Of all elements.
static double longest_of_all(const FemMesh *mesh) {
  double longest = 0;
  for (int t = 0; t < mesh->tet_count; t++) {
    Vec3 x[4];
    corners_of(mesh, t, x);
    longest = fmax(longest, longest_edge(x));
  }
  return longest;
}

static Status find_points(FemLine *line, const FemMesh *mesh, const ContactSurface *surface, int tet_begin) {
  const FemLineDef *def = line->def;
  const double length = vec3_length(vec3_sub(vec3_at(def->to), vec3_at(def->from)));
  double *nearest2 = memory_zeroed((size_t)def->points, sizeof *nearest2);
  if (!nearest2) return status_no_memory("a line");
  const double margin = SAGITTA * (1 + ROUNDING) * longest_of_all(mesh);
  locate(def, mesh, margin, line->points, nearest2);
  for (int k = 0; k < def->points; k++) {
    Vec3 x[4];
    FemLinePoint *point = &line->points[line->count];
    if (!isfinite(nearest2[k])) continue;
    *point = line->points[k];
    corners_of(mesh, point->tet, x);
    double edge = longest_edge(x);
    if (!(sqrt(nearest2[k]) <= SAGITTA * edge)) continue;
    point->way = share_of(def, k) * length;
    point->is_surface = contact_surface_distance(surface, place_of(x, point->shares)) <= ROUNDING * edge;
    point->tet += tet_begin;
    line->count++;
  }
  memory_free(nearest2);
  return STATUS_OK;
}

static Status fail_outside(const FemLineDef *def, const FemMesh *mesh) {
  Vec3 least = {INFINITY, INFINITY, INFINITY}, most = {-INFINITY, -INFINITY, -INFINITY};
  for (int v = 0; v < mesh->vertex_count; v++) {
    const double *x = mesh->rest + 3 * (size_t)v;
    least = (Vec3){fmin(least.x, x[0]), fmin(least.y, x[1]), fmin(least.z, x[2])};
    most = (Vec3){fmax(most.x, x[0]), fmax(most.y, x[1]), fmax(most.z, x[2])};
  }
  return status_fail(STATUS_INPUT,
                     "none of its %d points is in the body, as placed, at rest [m]: that reaches from (%.6g, "
                     "%.6g, %.6g) to (%.6g, %.6g, %.6g)",
                     def->points, least.x, least.y, least.z, most.x, most.y, most.z);
}

Status fem_line_create(FemLine *line, const FemLineDef *def, const FemMesh *mesh, int tet_begin) {
  ContactSurface surface = {0};
  *line = (FemLine){.def = def};
  double length = vec3_length(vec3_sub(vec3_at(def->to), vec3_at(def->from)));
  if (!(length > 0 && isfinite(length)))
    return status_fail(STATUS_INPUT, "from and to are %g m apart; give the two ends of a line", length);
  line->points = memory_zeroed((size_t)def->points, sizeof *line->points);
  Status status = line->points ? STATUS_OK : status_no_memory("a line");
  if (!status) status = contact_surface_find(&surface, (const int(*)[4])mesh->tets, 0, mesh->tet_count);
  if (!status) status = contact_surface_index(&surface, mesh->rest);
  if (!status) status = find_points(line, mesh, &surface, tet_begin);
  contact_surface_destroy(&surface);
  if (!status && line->count == 0) status = fail_outside(def, mesh);
  if (status) fem_line_destroy(line);
  return status;
}

void fem_line_destroy(FemLine *line) {
  memory_free(line->points);
  *line = (FemLine){0};
}
