// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surface/smooth/fit.h"

#include <assert.h>
#include <string.h>

#include "contact/limits.h"

enum { AFFINE_COUNT = 3, FORM_COUNT = 3, TERM_COUNT = AFFINE_COUNT + FORM_COUNT };

static const double MOST_WEIGHT = 3; // Σ |w| that vertices carry well
// Of the largest eigenvalue of the forms: what is less is left out; the second where the first gives weights
// that are too large.
static const double INDEPENDENT[2] = {CONTACT_FLAT, 1e-2};

// The tangent plane about the point, lengths in units of the first two vertices' distance.
typedef struct Plane {
  Vec3 origin, axes[2];
} Plane;

static Plane plane_at(const Vec3 *x, int own, const double *prior, Vec3 normal) {
  Plane plane = {.origin = {0, 0, 0}};
  for (int k = 0; k < own; k++) plane.origin = vec3_add(plane.origin, vec3_scale(prior[k], x[k]));
  Vec3 n = vec3_scale(1 / vec3_length(normal), normal), along = vec3_sub(x[1], x[0]);
  along = vec3_sub(along, vec3_scale(vec3_dot(along, n), n));
  double square = vec3_dot(along, along);
  plane.axes[0] = vec3_scale(1 / square, along);
  plane.axes[1] = vec3_cross(n, plane.axes[0]);
  return plane;
}

static void find_terms(const Plane *plane, Vec3 x, double terms[TERM_COUNT]) {
  Vec3 arm = vec3_sub(x, plane->origin);
  double u = vec3_dot(arm, plane->axes[0]), v = vec3_dot(arm, plane->axes[1]);
  const double all[TERM_COUNT] = {1, u, v, u * u, sqrt(2) * u * v, v * v};
  memcpy(terms, all, sizeof all);
}

// Takes the affine functions out of the forms: G → L, with forms' rows as what they are short of, r likewise.
static void take_out_affine(double matrix[TERM_COUNT][TERM_COUNT], double r[TERM_COUNT]) {
  for (int j = 0; j < AFFINE_COUNT; j++) {
    if (!(matrix[j][j] > 0)) continue;
    for (int i = j + 1; i < TERM_COUNT; i++) {
      double share = matrix[i][j] / matrix[j][j];
      for (int k = j; k < TERM_COUNT; k++) matrix[i][k] -= share * matrix[j][k];
      r[i] -= share * r[j];
    }
  }
}

// One rotation of Jacobi's method in the plane of rows i, j, which makes entry (i, j) 0.
static void rotate(double s[FORM_COUNT][FORM_COUNT], double axes[FORM_COUNT][FORM_COUNT], int i, int j) {
  if (s[i][j] == 0) return;
  double angle = 0.5 * atan2(2 * s[i][j], s[j][j] - s[i][i]), c = cos(angle), d = sin(angle);
  for (int k = 0; k < FORM_COUNT; k++) {
    double a = s[i][k], b = s[j][k];
    s[i][k] = c * a - d * b, s[j][k] = d * a + c * b;
  }
  for (int k = 0; k < FORM_COUNT; k++) {
    double a = s[k][i], b = s[k][j], p = axes[k][i], q = axes[k][j];
    s[k][i] = c * a - d * b, s[k][j] = d * a + c * b;
    axes[k][i] = c * p - d * q, axes[k][j] = d * p + c * q;
  }
}

// z of the forms by those eigenvectors whose eigenvalues are large enough.
static void solve_forms(double matrix[TERM_COUNT][TERM_COUNT], const double r[TERM_COUNT], double independent,
                        double z[TERM_COUNT]) {
  double s[FORM_COUNT][FORM_COUNT], axes[FORM_COUNT][FORM_COUNT] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                    largest = 0;
  for (int i = 0; i < FORM_COUNT; i++) memcpy(s[i], matrix[AFFINE_COUNT + i] + AFFINE_COUNT, sizeof s[i]);
  for (int sweep = 0; sweep < 2 * FORM_COUNT; sweep++)
    rotate(s, axes, 0, 1), rotate(s, axes, 0, 2), rotate(s, axes, 1, 2);
  for (int i = 0; i < FORM_COUNT; i++) largest = fmax(largest, s[i][i]), z[AFFINE_COUNT + i] = 0;
  for (int e = 0; e < FORM_COUNT; e++) {
    double along = 0;
    if (!(s[e][e] > independent * largest)) continue;
    for (int i = 0; i < FORM_COUNT; i++) along += axes[i][e] * r[AFFINE_COUNT + i];
    for (int i = 0; i < FORM_COUNT; i++) z[AFFINE_COUNT + i] += axes[i][e] * along / s[e][e];
  }
}

// The rest of G z = r, upwards.
static void solve_affine(double matrix[TERM_COUNT][TERM_COUNT], const double r[TERM_COUNT],
                         double z[TERM_COUNT]) {
  for (int j = AFFINE_COUNT - 1; j >= 0; j--) {
    z[j] = r[j];
    for (int k = j + 1; k < TERM_COUNT; k++) z[j] -= matrix[j][k] * z[k];
    z[j] = matrix[j][j] > 0 ? z[j] / matrix[j][j] : 0;
  }
}

bool contact_fit_surface(int count, const Vec3 *x, int own, const double *prior, Vec3 normal,
                         double *weights) {
  assert(count <= CONTACT_FIT_MOST_COUNT && own >= 2);
  Plane plane = plane_at(x, own, prior, normal);
  double terms[CONTACT_FIT_MOST_COUNT][TERM_COUNT], pulls[CONTACT_FIT_MOST_COUNT];
  double matrix[TERM_COUNT][TERM_COUNT] = {{0}}, r[TERM_COUNT] = {1, 0, 0, 0, 0, 0}, size;
  for (int k = 0; k < count; k++) {
    const double *own_terms = terms[k];
    find_terms(&plane, x[k], terms[k]);
    pulls[k] = 1 / (own_terms[3] + own_terms[5]);
    for (int i = 0; i < TERM_COUNT; i++) {
      r[i] -= k < own ? prior[k] * own_terms[i] : 0;
      for (int j = 0; j < TERM_COUNT; j++) matrix[i][j] += pulls[k] * own_terms[i] * own_terms[j];
    }
  }
  take_out_affine(matrix, r);
  for (int attempt = 0; attempt < 2; attempt++) {
    double z[TERM_COUNT];
    solve_forms(matrix, r, INDEPENDENT[attempt], z);
    solve_affine(matrix, r, z);
    size = 0;
    for (int k = 0; k < count; k++) {
      weights[k] = k < own ? prior[k] : 0;
      for (int i = 0; i < TERM_COUNT; i++) weights[k] += pulls[k] * terms[k][i] * z[i];
      size += fabs(weights[k]);
    }
    if (size <= MOST_WEIGHT) return true;
  }
  for (int k = 0; k < count; k++) weights[k] = k < own ? prior[k] : 0;
  return false;
}

void contact_fit_curve(int count, const double *along, double at, double *weights) {
  for (int k = 0; k < count; k++) {
    weights[k] = 1;
    for (int j = 0; j < count; j++)
      if (j != k) weights[k] *= (at - along[j]) / (along[k] - along[j]);
  }
}
