// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/extent.h"

#include <math.h>

#include "contact/surface/surface.h"
#include "fem/material/svd3.h"

static Vec3 corner_of(const FemModel *model, int tet, int v) {
  return vec3_at(model->rest + 3 * (size_t)model->tets[tet][v]);
}

// Volume, and ∫ x and ∫ x xᵀ about the body's first vertex.
typedef struct Moments {
  double volume;
  Vec3 first;
  double second[9];
} Moments;

static void add_tet(const FemModel *model, int tet, Vec3 origin, Moments *moments) {
  Vec3 x[4], sum = {0, 0, 0};
  for (int v = 0; v < 4; v++) x[v] = vec3_sub(corner_of(model, tet, v), origin), sum = vec3_add(sum, x[v]);
  double volume = fabs(vec3_det4(x[0], x[1], x[2], x[3])) / 6;
  moments->volume += volume;
  moments->first = vec3_add(moments->first, vec3_scale(volume / 4, sum));
  for (int v = 0; v < 5; v++) {
    Vec3 y = v < 4 ? x[v] : sum;
    const double p[3] = {y.x, y.y, y.z};
    for (int e = 0; e < 9; e++) moments->second[e] += volume / 20 * p[e / 3] * p[e % 3];
  }
}

// The squares of the radii of inertia about the centroid are the principal values of the covariance.
static double find_principal(const FemModel *model, const FemModelBody *body, FemSvd3 *principal) {
  Moments moments = {0};
  Vec3 origin = corner_of(model, body->tet_begin, 0);
  for (int i = body->tet_begin; i < body->tet_end; i++) add_tet(model, i, origin, &moments);
  const double mean[3] = {moments.first.x / moments.volume, moments.first.y / moments.volume,
                          moments.first.z / moments.volume};
  for (int e = 0; e < 9; e++)
    moments.second[e] = moments.second[e] / moments.volume - mean[e / 3] * mean[e % 3];
  fem_svd3_factor(principal, moments.second);
  return moments.volume;
}

static double reach(const Vec3 x[3], Vec3 axis) {
  double low = INFINITY, high = -INFINITY;
  for (int v = 0; v < 3; v++) {
    low = fmin(low, vec3_dot(x[v], axis));
    high = fmax(high, vec3_dot(x[v], axis));
  }
  return high - low;
}

static Status measure_surface(const FemModel *model, const FemModelBody *body, FemExtent *extent,
                              double *area) {
  ContactSurface surface;
  TRY(contact_surface_find(&surface, (const int(*)[4])model->tets, body->tet_begin, body->tet_end));
  *area = 0;
  for (int f = 0; f < surface.count; f++) {
    Vec3 x[3];
    for (int v = 0; v < 3; v++) x[v] = vec3_at(model->rest + 3 * (size_t)surface.faces[f].vertices[v]);
    *area += 0.5 * vec3_length(vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0])));
    extent->edge += reach(x, extent->axis) / surface.count;
  }
  contact_surface_destroy(&surface);
  return STATUS_OK;
}

Status fem_extent_measure(const FemModel *model, int body, FemExtent *extent) {
  FemSvd3 principal;
  double area, volume = find_principal(model, &model->bodies[body], &principal);
  *extent = (FemExtent){.length = sqrt(12 * fabs(principal.sigma[0])),
                        .axis = {principal.U[0], principal.U[3], principal.U[6]}};
  TRY(measure_surface(model, &model->bodies[body], extent, &area));
  extent->height = fmin(sqrt(12) * sqrt(fabs(principal.sigma[2])), 6 * volume / area);
  return STATUS_OK;
}
