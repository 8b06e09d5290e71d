// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/element/quadratic_face.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

enum { NODES = FEM_QUADRATIC_FACE_NODES, DOFS = 3 * NODES, POINTS = 6 };

// Shape functions and their derivatives along ξ = L₁ and η = L₂ at one point, whose weights add up to ½.
typedef struct Point {
  double N[NODES], along_xi[NODES], along_eta[NODES], weight;
} Point;

static Point point_at(const double L[3], double weight) {
  Point point = {.weight = weight};
  // ∂L/∂ξ = (−1, 1, 0), ∂L/∂η = (−1, 0, 1).
  static const double xi[3] = {-1, 1, 0}, eta[3] = {-1, 0, 1};
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3;
    point.N[a] = L[a] * (2 * L[a] - 1);
    point.along_xi[a] = (4 * L[a] - 1) * xi[a];
    point.along_eta[a] = (4 * L[a] - 1) * eta[a];
    point.N[3 + a] = 4 * L[a] * L[b];
    point.along_xi[3 + a] = 4 * (L[a] * xi[b] + L[b] * xi[a]);
    point.along_eta[3 + a] = 4 * (L[a] * eta[b] + L[b] * eta[a]);
  }
  return point;
}

// Two rings of three points (1 − 2b, b, b).
static void list_points(Point points[POINTS]) {
  const double root = sqrt(38 - 44 * sqrt(0.4)), spread = sqrt(213125 - 53320 * sqrt(10));
  for (int ring = 0; ring < 2; ring++) {
    double sign = ring == 0 ? 1 : -1, b = (8 - sqrt(10) + sign * root) / 18;
    for (int k = 0; k < 3; k++) {
      double L[3] = {b, b, b};
      L[k] = 1 - 2 * b;
      points[3 * ring + k] = point_at(L, 0.5 * (620 + sign * spread) / 3720);
    }
  }
}

static Vec3 sum(const double weights[NODES], const double x[18]) {
  Vec3 total = {0, 0, 0};
  for (int a = 0; a < NODES; a++) total = vec3_add(total, vec3_scale(weights[a], vec3_at(x + 3 * a)));
  return total;
}

// Positions relative to the first node: the areas do not depend on where the origin is.
static void shift(const double x[18], double moved[18]) {
  for (int r = 0; r < DOFS; r++) moved[r] = x[r] - x[r % 3];
}

void fem_quadratic_face_share(const double x[18], double share[6]) {
  Point points[POINTS];
  double moved[DOFS];
  list_points(points);
  shift(x, moved);
  memset(share, 0, NODES * sizeof *share);
  for (int p = 0; p < POINTS; p++) {
    double stretch = vec3_length(vec3_cross(sum(points[p].along_xi, moved), sum(points[p].along_eta, moved)));
    for (int a = 0; a < NODES; a++) share[a] += points[p].weight * points[p].N[a] * stretch;
  }
}

void fem_quadratic_face_area(const double x[18], double area[18]) {
  Point points[POINTS];
  double moved[DOFS];
  list_points(points);
  shift(x, moved);
  memset(area, 0, DOFS * sizeof *area);
  for (int p = 0; p < POINTS; p++) {
    Vec3 normal = vec3_cross(sum(points[p].along_xi, moved), sum(points[p].along_eta, moved));
    for (int a = 0; a < NODES; a++)
      vec3_accumulate(area + 3 * a, vec3_scale(points[p].weight * points[p].N[a], normal));
  }
}

// ∂A_a/∂x_b = Σ w N_a (N_b,η [x,ξ]ₓ − N_b,ξ [x,η]ₓ).
void fem_quadratic_face_stiffness(double pressure, const double x[18], double stiffness[324]) {
  Point points[POINTS];
  double moved[DOFS], whole[DOFS * DOFS] = {0};
  list_points(points);
  shift(x, moved);
  for (int p = 0; p < POINTS; p++) {
    const Point *at = &points[p];
    Vec3 xi = sum(at->along_xi, moved), eta = sum(at->along_eta, moved);
    for (int a = 0; a < NODES; a++)
      for (int b = 0; b < NODES; b++) {
        Vec3 w = vec3_scale(pressure * at->weight * at->N[a],
                            vec3_sub(vec3_scale(at->along_eta[b], xi), vec3_scale(at->along_xi[b], eta)));
        const double cross[9] = {0, -w.z, w.y, w.z, 0, -w.x, -w.y, w.x, 0};
        for (int r = 0; r < 9; r++) whole[DOFS * (3 * a + r / 3) + 3 * b + r % 3] += cross[r];
      }
  }
  for (int r = 0; r < DOFS; r++)
    for (int c = 0; c < DOFS; c++)
      stiffness[DOFS * r + c] = 0.5 * (whole[DOFS * r + c] + whole[DOFS * c + r]);
}
