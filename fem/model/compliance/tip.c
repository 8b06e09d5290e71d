// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/tip.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/model/compliance/extent.h"

// At most: the solid angle of a tip over that of a cube's corner; how far its edges lead across its axis over
// how far along; its reach over the body's height. The second is √2 at a cube's corner, and more where that
// is sheared in a plane.
static const double NARROW = 0.9, ACROSS = 1.2, FINE = 0.5;

// Of a vertex.
typedef struct Corner {
  double angle; // that its elements fill [sr]
  double reach; // the least of their longest edges there; 0: no element [m]
  Vec3 axis;    // the mean of their directions
  bool is_wide; // an edge there leads too far across the axis
} Corner;

// Van Oosterom and Strackee 1983.
static double angle_between(const Vec3 e[3], const double lengths[3]) {
  double volume = fabs(vec3_dot(e[0], vec3_cross(e[1], e[2]))), sum = lengths[0] * lengths[1] * lengths[2];
  for (int k = 0; k < 3; k++) sum += vec3_dot(e[k], e[(k + 1) % 3]) * lengths[(k + 2) % 3];
  return 2 * atan2(volume, sum);
}

// From a corner of an element.
static void edges_of(const FemModel *model, int tet, int corner, Vec3 edges[3], double lengths[3]) {
  const int *vertices = model->tets[tet];
  Vec3 x = vec3_at(model->rest + 3 * (size_t)vertices[corner]);
  for (int k = 0; k < 3; k++) {
    edges[k] = vec3_sub(vec3_at(model->rest + 3 * (size_t)vertices[(corner + 1 + k) % 4]), x);
    lengths[k] = vec3_length(edges[k]);
  }
}

static void add_element(const FemModel *model, int tet, int corner, Corner *to) {
  Vec3 edges[3], middle = {0, 0, 0};
  double lengths[3], longest = 0;
  edges_of(model, tet, corner, edges, lengths);
  for (int k = 0; k < 3; k++) {
    middle = vec3_add(middle, vec3_scale(1 / lengths[k], edges[k]));
    longest = fmax(longest, lengths[k]);
  }
  double angle = angle_between(edges, lengths);
  to->angle += angle;
  to->axis = vec3_add(to->axis, vec3_scale(angle / vec3_length(middle), middle));
  to->reach = to->reach > 0 ? fmin(to->reach, longest) : longest;
}

static void compare_edges(const FemModel *model, int tet, int corner, Corner *to) {
  Vec3 edges[3];
  double lengths[3];
  edges_of(model, tet, corner, edges, lengths);
  for (int k = 0; k < 3; k++)
    if (vec3_length(vec3_cross(edges[k], to->axis)) > ACROSS * vec3_dot(edges[k], to->axis))
      to->is_wide = true;
}

static bool may_meet(const FemModel *model, const FemModelBody *body, int vertex) {
  const bool *is_prescribed = model->is_prescribed + 3 * (size_t)vertex;
  if (model->inner && model->inner[vertex]) return false;
  return body->is_obstacle || !(is_prescribed[0] || is_prescribed[1] || is_prescribed[2]);
}

static void keep_sharper(const Corner *corner, double height, FemTip *tip) {
  double cosine = 1 - corner->angle / (2 * M_PI), slope = cosine / sqrt(1 - cosine * cosine);
  if (!(corner->reach > 0) || corner->is_wide || corner->angle > NARROW * M_PI / 2 ||
      corner->reach > FINE * height)
    return;
  if (!(tip->slope > 0) || slope * tip->reach > tip->slope * corner->reach)
    *tip = (FemTip){.slope = slope, .reach = corner->reach};
}

Status fem_tip_find(const FemModel *model, int body, FemTip *tip) {
  const FemModelBody *range = &model->bodies[body];
  int begin = range->vertex_begin, count = range->vertex_end - begin;
  FemExtent extent;
  *tip = (FemTip){0};
  TRY(fem_extent_measure(model, body, &extent));
  Corner *corners = memory_zeroed((size_t)count, sizeof *corners);
  if (!corners) return status_no_memory("the tips of a body");
  for (int i = range->tet_begin; i < range->tet_end; i++)
    for (int v = 0; v < 4; v++) add_element(model, i, v, &corners[model->tets[i][v] - begin]);
  for (int i = range->tet_begin; i < range->tet_end; i++)
    for (int v = 0; v < 4; v++) compare_edges(model, i, v, &corners[model->tets[i][v] - begin]);
  for (int v = 0; v < count; v++)
    if (may_meet(model, range, begin + v)) keep_sharper(&corners[v], extent.height, tip);
  memory_free(corners);
  return STATUS_OK;
}
