// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/normalise.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "overlap/tpn/axis.h"

static const double FLATTEST = 1e-14, SOFTEST = 1e-6, LINEAR = 3, SAME = 1e-9;

const char *overlap_tpn_normalise_name(OverlapTpnNormalisation kind) {
  static const char *const names[OVERLAP_TPN_NORMALISE_COUNT] = {"unit", "pca", "sorted", "unscaled", "axis"};
  return names[kind];
}

// y = M x
static Vec3 apply(const double m[9], Vec3 x) {
  return (Vec3){m[0] * x.x + m[1] * x.y + m[2] * x.z, m[3] * x.x + m[4] * x.y + m[5] * x.z,
                m[6] * x.x + m[7] * x.y + m[8] * x.z};
}

// y = Mᵀ x
static Vec3 apply_transposed(const double m[9], Vec3 x) {
  return (Vec3){m[0] * x.x + m[3] * x.y + m[6] * x.z, m[1] * x.x + m[4] * x.y + m[7] * x.z,
                m[2] * x.x + m[5] * x.y + m[8] * x.z};
}

// Vertices first … 7.
static void map_vertices(const double pair[24], int first, OverlapTpnNormalised *normalised) {
  for (int v = first; v < 8; v++) {
    Vec3 from_origin = vec3_sub(vec3_at(pair + 3 * v), vec3_at(normalised->origin));
    vec3_store(normalised->pair + 3 * v, apply(normalised->matrix, from_origin));
  }
}

static const double simplex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

const double *overlap_tpn_normalise_first(OverlapTpnNormalisation kind) {
  return kind == OVERLAP_TPN_NORMALISE_PCA ? NULL : simplex;
}

// The rows of E⁻¹ are cross products of edges over det E.
static bool find_unit(const double pair[24], OverlapTpnNormalised *normalised) {
  Vec3 origin = vec3_at(pair), edge[3];
  for (int k = 0; k < 3; k++) edge[k] = vec3_sub(vec3_at(pair + 3 + 3 * k), origin);
  Vec3 normal = vec3_cross(edge[1], edge[2]);
  double det = vec3_dot(edge[0], normal);
  double size = vec3_length(edge[0]) * vec3_length(edge[1]) * vec3_length(edge[2]);
  // of edges so short that their products underflow, 1 / det is no number
  if (!(fabs(det) > FLATTEST * size && isfinite(1 / det))) return false;
  vec3_store(normalised->origin, origin);
  vec3_store(normalised->matrix, vec3_scale(1 / det, normal));
  vec3_store(normalised->matrix + 3, vec3_scale(1 / det, vec3_cross(edge[2], edge[0])));
  vec3_store(normalised->matrix + 6, vec3_scale(1 / det, vec3_cross(edge[0], edge[1])));
  normalised->factor = fabs(det);
  map_vertices(pair, 4, normalised);
  memcpy(normalised->pair, simplex, sizeof simplex);
  return true;
}

// Numbers the places of the largest value, the next, …; ties stay as they came. Every place counts those
// before it, which takes no branches.
static void sort_places(const double value[4], int order[4]) {
  int before[4] = {0};
  for (int i = 0; i < 4; i++) order[i] = i; // NaN has no order: whatever comes out is a vertex
  for (int i = 0; i < 3; i++)
    for (int j = i + 1; j < 4; j++) {
      int is_larger = value[j] > value[i];
      before[i] += is_larger, before[j] += !is_larger;
    }
  for (int i = 0; i < 4; i++) order[before[i] & 3] = i;
}

// Vertices `order` of the first tetrahedron, those of the second as they are.
static void arrange_first(const double pair[24], const int order[4], double arranged[24]) {
  for (int v = 0; v < 4; v++) memcpy(arranged + 3 * v, pair + 3 * order[v], 3 * sizeof(double));
  memcpy(arranged + 12, pair + 12, 12 * sizeof(double));
}

// The barycentric coordinates of the second's centroid (times four) in the first, which is in the unit frame.
static void find_centroid(const double unit[24], double centroid[4]) {
  centroid[0] = 4, centroid[1] = centroid[2] = centroid[3] = 0;
  for (int b = 4; b < 8; b++)
    for (int k = 0; k < 3; k++) centroid[k + 1] += unit[3 * b + k], centroid[0] -= unit[3 * b + k];
}

static void order_second(const double unit[24], int order[4]) {
  double value[4];
  for (int b = 0; b < 4; b++) {
    const double *y = unit + 12 + 3 * b;
    value[b] = 1 - y[0] - y[1] - y[2];
  }
  sort_places(value, order);
}

static double compress(double y) {
  return fabs(y) <= LINEAR ? y : copysign(LINEAR * (1 + log(fabs(y) / LINEAR)), y);
}

static double expand(double c) {
  return fabs(c) <= LINEAR ? c : copysign(LINEAR * exp(fabs(c) / LINEAR - 1), c);
}

// The second's vertices in the order `second`, compressed.
static void arrange_second(const int second[4], OverlapTpnNormalised *normalised) {
  double unit[12];
  memcpy(unit, normalised->pair + 12, sizeof unit);
  for (int v = 0; v < 4; v++) {
    normalised->order[4 + v] = 4 + second[v];
    for (int k = 0; k < 3; k++) normalised->pair[12 + 3 * v + k] = compress(unit[3 * second[v] + k]);
  }
}

static bool find_sorted(const double pair[24], OverlapTpnNormalised *normalised) {
  double arranged[24], centroid[4];
  int second[4];
  if (!find_unit(pair, normalised)) return false;
  find_centroid(normalised->pair, centroid);
  sort_places(centroid, normalised->order);
  arrange_first(pair, normalised->order, arranged);
  if (!find_unit(arranged, normalised)) return false;
  order_second(normalised->pair, second);
  arrange_second(second, normalised);
  return true;
}

static OverlapTpnAxisSide find_side(const double pair[24], OverlapTpnNormalised *normalised) {
  OverlapTpnAxisSide side = {.stands = find_unit(pair, normalised)};
  if (!side.stands) return side;
  for (int b = 0; b < 4; b++) {
    const double *y = normalised->pair + 12 + 3 * b;
    side.lambda[b][0] = 1 - y[0] - y[1] - y[2];
    memcpy(side.lambda[b] + 1, y, 3 * sizeof *y);
  }
  side.det = normalised->factor;
  return side;
}

// Of points, by x, then y, then z.
static bool is_greater(const double *x, const double *y) {
  int c = 0;
  while (c < 2 && x[c] == y[c]) c++;
  return x[c] > y[c];
}

// Of the greatest vertices of both.
static bool is_second_greater(const double pair[24]) {
  int greatest[2] = {0, 4};
  for (int t = 0; t < 2; t++)
    for (int v = 4 * t + 1; v < 4 * t + 4; v++)
      if (is_greater(pair + 3 * v, pair + 3 * greatest[t])) greatest[t] = v;
  return is_greater(pair + 3 * greatest[1], pair + 3 * greatest[0]);
}

static bool is_second_larger(const double pair[24], const OverlapTpnAxisSide sides[2]) {
  if (!sides[0].stands || !sides[1].stands) return sides[1].stands;
  double difference = sides[1].det - sides[0].det;
  if (fabs(difference) > SAME * (sides[0].det + sides[1].det)) return difference > 0;
  return is_second_greater(pair);
}

// The vertices of an edge, the one of the larger value first, then the other two as they are.
static void order_edge(const int edge[4], const double value[4], int order[4]) {
  memcpy(order, edge, 4 * sizeof *edge);
  if (value[edge[1]] > value[edge[0]]) order[0] = edge[1], order[1] = edge[0];
}

// Of the side's tetrahedron, by the other's centroid.
static void order_first(const OverlapTpnAxisSide *side, const OverlapTpnAxis *axis, bool tet, int order[4]) {
  double centroid[4];
  for (int k = 0; k < 4; k++)
    centroid[k] = side->lambda[0][k] + side->lambda[1][k] + side->lambda[2][k] + side->lambda[3][k];
  if (axis->is_edges) {
    order_edge(axis->edge[tet], centroid, order);
  } else {
    centroid[axis->face] = -INFINITY;
    sort_places(centroid, order);
  }
}

// Of the tetrahedron `tet`, the second, in the first's unit frame.
static void order_along(const OverlapTpnAxis *axis, bool tet, const double unit[24], int order[4]) {
  double value[4];
  for (int b = 0; b < 4; b++) value[b] = axis->is_edges ? -unit[12 + 3 * b + 1] : unit[12 + 3 * b + 2];
  if (axis->is_edges)
    order_edge(axis->edge[tet], value, order);
  else
    sort_places(value, order);
}

// x₃ becomes the height above the plane through the first's edge along the second's, of which the slope from
// the x₁x₂-plane is 0 to 1. Both ends of the second's edge have the same height: that of the other end is
// replaced by it plus the slope.
static void shear(const int second[4], OverlapTpnNormalised *normalised) {
  double *y = normalised->pair + 12, *p = y + 3 * second[0], *q = y + 3 * second[1];
  normalised->run = q[1] - p[1];
  normalised->slope = -(q[2] - p[2]) / normalised->run;
  for (int b = 0; b < 4; b++) y[3 * b + 2] += normalised->slope * y[3 * b + 1];
  q[2] = p[2] + normalised->slope;
}

static bool find_along_axis(const double pair[24], OverlapTpnNormalised *normalised) {
  double exchanged[24], arranged[24];
  int second[4];
  memcpy(exchanged, pair + 12, 12 * sizeof(double));
  memcpy(exchanged + 12, pair, 12 * sizeof(double));
  const OverlapTpnAxisSide sides[2] = {find_side(pair, normalised), find_side(exchanged, normalised)};
  bool larger = is_second_larger(pair, sides);
  if (!sides[larger].stands) return false;
  OverlapTpnAxis axis = overlap_tpn_axis_find(sides, larger);
  bool first = axis.tet;
  order_first(&sides[first], &axis, first, normalised->order);
  arrange_first(first ? exchanged : pair, normalised->order, arranged);
  if (!find_unit(arranged, normalised)) return false;
  order_along(&axis, !first, normalised->pair, second);
  if (axis.is_edges) shear(second, normalised);
  arrange_second(second, normalised);
  for (int v = 0; v < 8 && first; v++) normalised->order[v] ^= 4;
  return true;
}

// One Jacobi rotation of the symmetric a in the plane (p, q); the rows of v become eigenvectors.
static void rotate(double a[9], double v[9], int p, int q) {
  double apq = a[3 * p + q];
  // below the rounding of the values a rotation turns nothing
  if (fabs(apq) <= 1e-18 * (fabs(a[0]) + fabs(a[4]) + fabs(a[8]))) return;
  double theta = (a[4 * q] - a[4 * p]) / (2 * apq);
  double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
  double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; k++) {
    double kp = a[3 * k + p], kq = a[3 * k + q];
    a[3 * k + p] = c * kp - s * kq, a[3 * k + q] = s * kp + c * kq;
  }
  for (int k = 0; k < 3; k++) {
    double pk = a[3 * p + k], qk = a[3 * q + k], vp = v[3 * p + k], vq = v[3 * q + k];
    a[3 * p + k] = c * pk - s * qk, a[3 * q + k] = s * pk + c * qk;
    v[3 * p + k] = c * vp - s * vq, v[3 * q + k] = s * vp + c * vq;
  }
}

static void exchange_rows(double v[9], double value[3], int i, int j) {
  double row[3], kept = value[i];
  memcpy(row, v + 3 * i, sizeof row);
  memcpy(v + 3 * i, v + 3 * j, sizeof row);
  memcpy(v + 3 * j, row, sizeof row);
  value[i] = value[j], value[j] = kept;
}

// Axes as the rows of `axes`, the largest value first.
static void find_axes(double moment[9], double axes[9], double value[3]) {
  for (int i = 0; i < 9; i++) axes[i] = i % 4 == 0;
  for (int sweep = 0; sweep < 12; sweep++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) rotate(moment, axes, p, q);
  for (int i = 0; i < 3; i++) value[i] = moment[4 * i];
  for (int i = 0; i < 2; i++)
    for (int j = 2; j > i; j--)
      if (value[j] > value[j - 1]) exchange_rows(axes, value, j, j - 1);
}

// Which way the first two axes point, and the third.
static void direct_axes(const double pair[24], const double origin[3], double axes[9]) {
  for (int i = 0; i < 2; i++) {
    double skewness = 0;
    for (int a = 0; a < 4; a++) {
      double y = vec3_dot(vec3_at(axes + 3 * i), vec3_sub(vec3_at(pair + 3 * a), vec3_at(origin)));
      skewness += y * y * y;
    }
    if (skewness < 0) vec3_store(axes + 3 * i, vec3_scale(-1, vec3_at(axes + 3 * i)));
  }
  vec3_store(axes + 6, vec3_cross(vec3_at(axes), vec3_at(axes + 3)));
}

static bool find_pca(const double pair[24], OverlapTpnNormalised *normalised) {
  double moment[9] = {0};
  Vec3 centroid = {0, 0, 0};
  for (int a = 0; a < 4; a++) centroid = vec3_add(centroid, vec3_scale(0.25, vec3_at(pair + 3 * a)));
  vec3_store(normalised->origin, centroid);
  for (int a = 0; a < 4; a++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        moment[3 * i + j] +=
            0.25 * (pair[3 * a + i] - normalised->origin[i]) * (pair[3 * a + j] - normalised->origin[j]);
  find_axes(moment, normalised->matrix, normalised->principal);
  direct_axes(pair, normalised->origin, normalised->matrix);
  normalised->factor = 1;
  map_vertices(pair, 0, normalised);
  return normalised->principal[0] > 0;
}

static bool find(OverlapTpnNormalisation kind, const double pair[24], OverlapTpnNormalised *normalised) {
  normalised->kind = kind;
  normalised->run = 0;
  switch (kind) {
  case OVERLAP_TPN_NORMALISE_UNIT:
    return find_unit(pair, normalised);
  case OVERLAP_TPN_NORMALISE_PCA:
    return find_pca(pair, normalised);
  case OVERLAP_TPN_NORMALISE_SORTED:
    return find_sorted(pair, normalised);
  case OVERLAP_TPN_NORMALISE_AXIS:
    return find_along_axis(pair, normalised);
  case OVERLAP_TPN_NORMALISE_UNSCALED:
    if (!find_unit(pair, normalised)) return false;
    normalised->factor = 1;
    return true;
  default:
    return false;
  }
}

// As the kernels of devices have it (device/kernels/tpn/normalise.inc).
bool overlap_tpn_normalise(OverlapTpnNormalisation kind, const double pair[24],
                           OverlapTpnNormalised *normalised) {
  if (!find(kind, pair, normalised)) return false;
  double sum = 0; // NaN unless all are finite
  for (int i = 12; i < 24; i++) sum += normalised->pair[i] - normalised->pair[i];
  return sum == 0;
}

// With λ_k(b) the barycentric coordinates of vertex b of the second tetrahedron in the first,
//
//   δx'_b = E⁻¹ (δx_b − Σ_k λ_k(b) δx_k),   δ|det E| = |det E| Σ_k ∇λ_k · δx_k.
static void pull_unit(const OverlapTpnNormalised *normalised, double volume, const double inner[24],
                      double gradient[24]) {
  const double *m = normalised->matrix;
  Vec3 normal[4]; // ∇λ_k
  for (int k = 1; k < 4; k++) normal[k] = vec3_at(m + 3 * (k - 1));
  normal[0] = vec3_scale(-1, vec3_add(normal[1], vec3_add(normal[2], normal[3])));
  for (int k = 0; k < 4; k++)
    vec3_store(gradient + 3 * k, vec3_scale(normalised->factor * volume, normal[k]));
  for (int b = 0; b < 4; b++) {
    const double *y = normalised->pair + 12 + 3 * b;
    const double lambda[4] = {1 - y[0] - y[1] - y[2], y[0], y[1], y[2]};
    Vec3 pull = vec3_scale(normalised->factor, apply_transposed(m, vec3_at(inner + 12 + 3 * b)));
    vec3_store(gradient + 12 + 3 * b, pull);
    for (int k = 0; k < 4; k++) vec3_accumulate(gradient + 3 * k, vec3_scale(-lambda[k], pull));
  }
}

// An affine map of all space, which moves vertex k of the first tetrahedron by e_c and x by λ_k(x) e_c,
// leaves s as it is and turns its gradient at x_i by −∇λ_k (g_i)_c. So, with i any vertex,
//
//     ∂²s/∂x_ir ∂x_kc = −(∇λ_k)_r g_ic − Σ_b λ_k(b) ∂²s/∂x_ir ∂x_bc,
//
// and what the second tetrahedron's vertices b know among themselves, M ∇²s Mᵀ, is all that is needed.
static void bend_columns(const double normal[12], double lambda[4][4], const double gradient[24], int first,
                         double hessian[576]) {
  for (int i = first; i < first + 12; i++)
    for (int j = 0; j < 12; j++) {
      double sum = normal[j - j % 3 + i % 3] * gradient[i - i % 3 + j % 3];
      for (int b = 0; b < 4; b++) sum += lambda[b][j / 3] * hessian[24 * i + 12 + 3 * b + j % 3];
      hessian[24 * i + j] = -sum;
    }
}

// The block of vertices b and d: Mᵀ S M.
static void bend_block(const double m[9], const double inner_hessian[144], int b, int d,
                       double hessian[576]) {
  double half[9];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      half[3 * r + c] = 0;
      for (int k = 0; k < 3; k++)
        half[3 * r + c] += inner_hessian[12 * (3 * b + r) + 3 * d + k] * m[3 * k + c];
    }
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double sum = 0;
      for (int k = 0; k < 3; k++) sum += m[3 * k + r] * half[3 * k + c];
      hessian[24 * (12 + 3 * b + r) + 12 + 3 * d + c] = sum;
    }
}

void overlap_tpn_normalise_bend_unit(const OverlapTpnNormalised *normalised, const double inner[24],
                                     const double inner_hessian[144], double gradient[24],
                                     double hessian[576]) {
  OverlapTpnNormalised plain = *normalised;
  plain.factor = 1;
  pull_unit(&plain, 0, inner, gradient);
  double normal[12], lambda[4][4];
  memcpy(normal + 3, normalised->matrix, 9 * sizeof(double));
  for (int c = 0; c < 3; c++) normal[c] = -(normal[3 + c] + normal[6 + c] + normal[9 + c]);
  for (int b = 0; b < 4; b++) {
    const double *y = normalised->pair + 12 + 3 * b;
    lambda[b][0] = 1 - y[0] - y[1] - y[2];
    for (int k = 0; k < 3; k++) lambda[b][1 + k] = y[k];
    for (int d = 0; d < 4; d++) bend_block(normalised->matrix, inner_hessian, b, d, hessian);
  }
  bend_columns(normal, lambda, gradient, 12, hessian);
  for (int i = 0; i < 12; i++)
    for (int j = 12; j < 24; j++) hessian[24 * i + j] = hessian[24 * j + i];
  bend_columns(normal, lambda, gradient, 0, hessian);
}

// Back through `shear`: y and the derivatives by it. slope = −(y₅ − y₂)/run, run = y₄ − y₁.
static void pull_shear(double slope, double run, double y[12], double slopes[12]) {
  double by_slope = slopes[5];
  y[5] = y[2];
  slopes[2] += slopes[5], slopes[5] = 0;
  for (int b = 0; b < 4; b++) {
    y[3 * b + 2] -= slope * y[3 * b + 1];
    by_slope += slopes[3 * b + 2] * y[3 * b + 1];
    slopes[3 * b + 1] += slope * slopes[3 * b + 2];
  }
  double along = by_slope / run;
  slopes[2] += along, slopes[5] -= along;
  slopes[1] += slope * along, slopes[4] -= slope * along;
}

static void pull_sorted(const OverlapTpnNormalised *normalised, double volume, const double inner[24],
                        double gradient[24]) {
  OverlapTpnNormalised unit = *normalised;
  double slopes[24] = {0}, arranged[24];
  for (int i = 12; i < 24; i++) {
    double y = unit.pair[i] = expand(normalised->pair[i]);
    slopes[i] = inner[i] * (fabs(y) <= LINEAR ? 1 : LINEAR / fabs(y));
  }
  if (unit.run > 0) pull_shear(unit.slope, unit.run, unit.pair + 12, slopes + 12);
  pull_unit(&unit, volume, slopes, arranged);
  for (int v = 0; v < 8; v++)
    memcpy(gradient + 3 * normalised->order[v], arranged + 3 * v, 3 * sizeof(double));
}

// 1/Δ, bounded.
static double reciprocal(double difference, double soft) {
  double bottom = difference * difference + soft * soft;
  return bottom > 0 ? difference / bottom : 0;
}

// With the axes turning by δR = R Ω, Ω_ij = D_ij / (λ_j − λ_i), D_ij = ¼ Σ_a (δy_ai y_aj + y_ai δy_aj):
//
//   Σ_v g_v·δy_v = Σ_v g_v·Rᵀ(δx_v − δc) − ¼ Σ_a (S y_a)·Rᵀ δx_a,  S_ij = (M_ij − M_ji) / (λ_j − λ_i),
//
// M = Σ_v g_v y_vᵀ, y the normalised vertices, a those of the first tetrahedron.
static void pull_pca(const OverlapTpnNormalised *normalised, const double inner[24], double gradient[24]) {
  const double *value = normalised->principal, *y = normalised->pair;
  double moment[9] = {0}, turn[9] = {0}, soft = SOFTEST * (value[0] + value[1] + value[2]);
  Vec3 total = {0, 0, 0};
  for (int v = 0; v < 8; v++) {
    total = vec3_add(total, vec3_at(inner + 3 * v));
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) moment[3 * i + j] += inner[3 * v + i] * y[3 * v + j];
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      if (i != j)
        turn[3 * i + j] = (moment[3 * i + j] - moment[3 * j + i]) * reciprocal(value[j] - value[i], soft);
  for (int v = 0; v < 8; v++) {
    Vec3 local = vec3_at(inner + 3 * v);
    if (v < 4) local = vec3_sub(local, vec3_scale(0.25, vec3_add(total, apply(turn, vec3_at(y + 3 * v)))));
    vec3_store(gradient + 3 * v, apply_transposed(normalised->matrix, local));
  }
}

void overlap_tpn_normalise_pull(const OverlapTpnNormalised *normalised, double volume, const double inner[24],
                                double gradient[24]) {
  if (normalised->kind == OVERLAP_TPN_NORMALISE_UNIT)
    pull_unit(normalised, volume, inner, gradient);
  else if (normalised->kind == OVERLAP_TPN_NORMALISE_UNSCALED)
    pull_unit(normalised, 0, inner, gradient);
  else if (normalised->kind == OVERLAP_TPN_NORMALISE_SORTED || normalised->kind == OVERLAP_TPN_NORMALISE_AXIS)
    pull_sorted(normalised, volume, inner, gradient);
  else
    pull_pca(normalised, inner, gradient);
}
