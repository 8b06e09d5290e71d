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

// How far a place is from the box about a tetrahedron, squared: no more than from the tetrahedron.
static double box_distance2(const Vec3 x[4], Vec3 at) {
  const double p[3] = {at.x, at.y, at.z};
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < 4; k++) {
      double value = c == 0 ? x[k].x : c == 1 ? x[k].y : x[k].z;
      low = fmin(low, value), high = fmax(high, value);
    }
    double off = fmax(0, fmax(low - p[c], p[c] - high));
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

// The element that is nearest to a place; the first of several.
static double locate(const FemMesh *mesh, Vec3 at, FemLinePoint *point) {
  double nearest2 = INFINITY;
  for (int t = 0; t < mesh->tet_count && nearest2 > 0; t++) {
    Vec3 x[4];
    double shares[4];
    corners_of(mesh, t, x);
    if (!(box_distance2(x, at) < nearest2)) continue;
    double distance2 = project(x, at, shares);
    if (!(distance2 < nearest2)) continue;
    nearest2 = distance2;
    point->tet = t;
    memcpy(point->shares, shares, sizeof shares);
  }
  return sqrt(nearest2);
}

static void find_points(FemLine *line, const FemMesh *mesh, const ContactSurface *surface, int tet_begin) {
  const Vec3 from = vec3_at(line->def->from), way = vec3_sub(vec3_at(line->def->to), from);
  for (int k = 0; k < line->def->points; k++) {
    Vec3 x[4];
    FemLinePoint *point = &line->points[line->count];
    double share = (double)k / (line->def->points - 1);
    double off = locate(mesh, vec3_add(from, vec3_scale(share, way)), point);
    corners_of(mesh, point->tet, x);
    double edge = longest_edge(x);
    if (!(off <= SAGITTA * edge)) continue;
    point->way = share * vec3_length(way);
    point->is_surface = contact_surface_distance(surface, place_of(x, point->shares)) <= ROUNDING * edge;
    point->tet += tet_begin;
    line->count++;
  }
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
  if (!status) find_points(line, mesh, &surface, tet_begin);
  contact_surface_destroy(&surface);
  if (!status && line->count == 0) status = fail_outside(def, mesh);
  if (status) fem_line_destroy(line);
  return status;
}

void fem_line_destroy(FemLine *line) {
  memory_free(line->points);
  *line = (FemLine){0};
}
