// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/ball.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/tet.h"
#include "base/vec3.h"
#include "contact/shape/definite.h"
#include "contact/shape/triangle.h"

// About the centre of a ball many elements wide, terms of the size R³ add up to those of an element: 1e-16 of
// them is what a force is off by. So they are computed in the processor's widest type.
typedef long double Real;

typedef struct Vec {
  Real x, y, z;
} Vec;

static inline Vec vec_at(const double *p) {
  return (Vec){p[0], p[1], p[2]};
}
static inline void vec_store(double *p, Vec a) {
  p[0] = (double)a.x, p[1] = (double)a.y, p[2] = (double)a.z;
}
static inline Vec vec_add(Vec a, Vec b) {
  return (Vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline Vec vec_sub(Vec a, Vec b) {
  return (Vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline Vec vec_scale(Real s, Vec a) {
  return (Vec){s * a.x, s * a.y, s * a.z};
}
static inline Real vec_dot(Vec a, Vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline Vec vec_cross(Vec a, Vec b) {
  return (Vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline Real vec_length(Vec a) {
  return sqrtl(vec_dot(a, a));
}
static inline Real vec_det4(Vec a, Vec b, Vec c, Vec d) {
  return vec_dot(vec_sub(b, a), vec_cross(vec_sub(c, a), vec_sub(d, a)));
}

// What the edges of a face add up to, about the foot of the centre on its plane.
typedef struct Section {
  Real area;      // of the face's part inside the ball
  Real moment[2]; // ∫ (x, y) over it
  Real outer;     // sgn(d) R³ Ω of its part outside
  Real second;    // ∫ ρ² over the part inside, ρ² = x² + y²
  Real third[2];  // ∫ ρ² (x, y) over it
} Section;

// The plane of a face and the circle that the sphere cuts out of it.
typedef struct Plane {
  Real distance;             // d
  Real radius, circle;       // R, √(R² − d²) or 0
  Real reach;                // sgn(d) min(|d|, R)
  Vec foot, normal, axis[2]; // of the centre; unit vectors
} Plane;

static Plane plane_of(Vec a, Vec b, Vec doubled, Real radius) {
  Plane plane = {.radius = radius, .normal = vec_scale(1 / vec_length(doubled), doubled)};
  plane.distance = vec_dot(plane.normal, a);
  Real square = (radius - plane.distance) * (radius + plane.distance);
  plane.circle = square > 0 ? sqrtl(square) : 0;
  plane.reach = fmaxl(-radius, fminl(plane.distance, radius));
  plane.foot = vec_scale(plane.distance, plane.normal);
  Vec along = vec_sub(b, a);
  plane.axis[0] = vec_scale(1 / vec_length(along), along);
  plane.axis[1] = vec_cross(plane.normal, plane.axis[0]);
  return plane;
}

// An edge of a face in the plane's coordinates: the points foot + t · direction, |foot| = |height|.
typedef struct Edge {
  Real foot[2], direction[2];
  Real height; // signed: positive if the face lies to the left as the centre does
} Edge;

static void add_inside(const Edge *edge, Real from, Real to, Section *section) {
  Real area = 0.5 * edge->height * (to - from);
  section->area += area;
  for (int c = 0; c < 2; c++)
    section->moment[c] += area / 3 * (2 * edge->foot[c] + (from + to) * edge->direction[c]);
  Real h = edge->height, a = from * from, b = to * to;
  Real even = h * h * (to - from) + (b * to - a * from) / 3; // ∫ (h² + t²) dt
  Real odd = h * h * (b - a) / 2 + (b * b - a * a) / 4;      // ∫ (h² + t²) t dt
  section->second += h / 4 * even;
  for (int c = 0; c < 2; c++) section->third[c] += h / 5 * (edge->foot[c] * even + edge->direction[c] * odd);
}

// θ(t): the angle from the edge's foot to the point t.
static Real angle(const Edge *edge, Real t) {
  return copysignl(1, edge->height) * atan2l(t, fabsl(edge->height));
}

// θ(t) less the solid angle of the triangle centre's foot – edge's foot – t, as seen from the centre; odd in
// d.
static Real excess(const Edge *edge, const Plane *plane, Real t) {
  Real d = plane->distance, length = sqrtl(edge->height * edge->height + t * t + d * d);
  return copysignl(1, edge->height) * atan2l(t * d, fabsl(edge->height) * length);
}

static void unit_at(const Edge *edge, Real t, Real unit[2]) {
  Real x = edge->foot[0] + t * edge->direction[0], y = edge->foot[1] + t * edge->direction[1];
  Real length = hypotl(x, y);
  unit[0] = length > 0 ? x / length : 0, unit[1] = length > 0 ? y / length : 0;
}

static void add_outside(const Edge *edge, const Plane *plane, Real from, Real to, Section *section) {
  Real turned = angle(edge, to) - angle(edge, from), R = plane->radius, r = plane->circle;
  section->outer +=
      R * R * plane->reach * turned - R * R * R * (excess(edge, plane, to) - excess(edge, plane, from));
  if (!(r > 0)) return;
  Real begin[2], end[2];
  unit_at(edge, from, begin);
  unit_at(edge, to, end);
  section->area += 0.5 * r * r * turned;
  section->moment[0] += r * r * r / 3 * (end[1] - begin[1]);
  section->moment[1] -= r * r * r / 3 * (end[0] - begin[0]);
  section->second += r * r * r * r / 4 * turned;
  section->third[0] += r * r * r * r * r / 5 * (end[1] - begin[1]);
  section->third[1] -= r * r * r * r * r / 5 * (end[0] - begin[0]);
}

// One edge from p to q: outside the circle, inside, outside again.
static void add_edge(const Plane *plane, const Real p[2], const Real q[2], Section *section) {
  Real length = hypotl(q[0] - p[0], q[1] - p[1]);
  if (!(length > 0)) return;
  Edge edge = {.direction = {(q[0] - p[0]) / length, (q[1] - p[1]) / length}};
  Real from = p[0] * edge.direction[0] + p[1] * edge.direction[1], to = from + length;
  edge.height = p[0] * edge.direction[1] - p[1] * edge.direction[0];
  edge.foot[0] = edge.height * edge.direction[1], edge.foot[1] = -edge.height * edge.direction[0];
  Real square = (plane->circle - edge.height) * (plane->circle + edge.height);
  Real half = square > 0 ? sqrtl(square) : 0;
  Real enter = fminl(fmaxl(-half, from), to), leave = fminl(fmaxl(half, from), to);
  if (!(square > 0)) {
    add_outside(&edge, plane, from, to, section);
    return;
  }
  if (enter > from) add_outside(&edge, plane, from, enter, section);
  if (leave > enter) add_inside(&edge, enter, leave, section);
  if (to > leave) add_outside(&edge, plane, leave, to, section);
}

static Section section_of(const Plane *plane, const Vec corners[3]) {
  Section section = {.area = 0};
  Real flat[3][2];
  for (int v = 0; v < 3; v++)
    for (int c = 0; c < 2; c++) flat[v][c] = vec_dot(vec_sub(corners[v], plane->foot), plane->axis[c]);
  for (int v = 0; v < 3; v++) add_edge(plane, flat[v], flat[(v + 1) % 3], &section);
  return section;
}

// ∫ N n dA of the three corners, by N_v = (doubled · ((next − x) × (after − x))) / |doubled|².
static void add_gradient(const Plane *plane, const Section *section, const Vec corners[3], Vec doubled,
                         Vec gradient[3]) {
  Real twice = vec_length(doubled);
  Vec moment =
      vec_add(vec_scale(section->moment[0], plane->axis[0]), vec_scale(section->moment[1], plane->axis[1]));
  for (int v = 0; v < 3; v++) {
    Vec next = corners[(v + 1) % 3], edge = vec_sub(corners[(v + 2) % 3], next);
    Vec slope = vec_scale(1 / twice, vec_cross(plane->normal, edge)); // ∇N_v
    Real at_foot = vec_dot(slope, vec_sub(plane->foot, next));
    gradient[v] =
        vec_add(gradient[v], vec_scale(at_foot * section->area + vec_dot(slope, moment), plane->normal));
  }
}

// ∫ N n φ dA with φ = (R² − r²)/(2R), r² = d² + ρ².
static void add_weighed_gradient(const Plane *plane, const Section *section, const Vec corners[3],
                                 Vec doubled, Vec gradient[3]) {
  Real share = (plane->radius - plane->distance) * (plane->radius + plane->distance);
  Section weighed = {.area = (share * section->area - section->second) / (2 * plane->radius)};
  for (int c = 0; c < 2; c++)
    weighed.moment[c] = (share * section->moment[c] - section->third[c]) / (2 * plane->radius);
  add_gradient(plane, &weighed, corners, doubled, gradient);
}

// V and, of φ over it, the integral; with the gradient of one of them.
typedef struct Sums {
  Real volume, depth;
  Vec gradient[4];
} Sums;

static Sums sum_faces(const double tet[12], const double centre[3], double radius, bool is_weighed) {
  Sums sums = {.volume = 0};
  Vec x[4];
  Real second = 0; // ∫ r²
  for (int v = 0; v < 4; v++) x[v] = vec_sub(vec_at(tet + 3 * v), vec_at(centre));
  bool is_flipped = vec_det4(x[0], x[1], x[2], x[3]) < 0;
  for (int f = 0; f < 4; f++) {
    int order[3] = {tet_faces[f][0], tet_faces[f][1 + is_flipped], tet_faces[f][2 - is_flipped]};
    Vec corners[3] = {x[order[0]], x[order[1]], x[order[2]]}, own[3] = {{0, 0, 0}};
    Vec doubled = vec_cross(vec_sub(corners[1], corners[0]), vec_sub(corners[2], corners[0]));
    if (!(vec_length(doubled) > 0)) continue;
    Plane plane = plane_of(corners[0], corners[1], doubled, radius);
    Section section = section_of(&plane, corners);
    Real d = plane.distance;
    sums.volume += (d * section.area + section.outer) / 3;
    second += (d * (d * d * section.area + section.second) + radius * radius * section.outer) / 5;
    (is_weighed ? add_weighed_gradient : add_gradient)(&plane, &section, corners, doubled, own);
    for (int v = 0; v < 3; v++) sums.gradient[order[v]] = vec_add(sums.gradient[order[v]], own[v]);
  }
  sums.depth = fmaxl((radius * radius * sums.volume - second) / (2 * radius), 0);
  sums.volume = fmaxl(sums.volume, 0);
  return sums;
}

static double overlap_with_gradient(const double tet[12], const double centre[3], double radius,
                                    double gradient[12]) {
  Sums sums = sum_faces(tet, centre, radius, false);
  for (int v = 0; v < 4; v++) vec_store(gradient + 3 * v, sums.gradient[v]);
  return (double)sums.volume;
}

// What a gradient is taken of, at a tetrahedron.
typedef struct Question {
  const double *centre;
  double radius;
  double rest_volume;
} Question;

// U = s ∫ φ with s = V⁰/|V_tet|, and |V_tet| grows by |V_tet| ∇λ_v.
static double press_with_gradient(const Question *question, const double tet[12], double *volume,
                                  double gradient[12]) {
  Sums sums = sum_faces(tet, question->centre, question->radius, true);
  Vec a = vec_sub(vec_at(tet + 3), vec_at(tet)), b = vec_sub(vec_at(tet + 6), vec_at(tet));
  Vec c = vec_sub(vec_at(tet + 9), vec_at(tet)), slope[4];
  Real det = vec_dot(a, vec_cross(b, c)), s = 6 * question->rest_volume / fabsl(det);
  slope[1] = vec_scale(1 / det, vec_cross(b, c));
  slope[2] = vec_scale(1 / det, vec_cross(c, a));
  slope[3] = vec_scale(1 / det, vec_cross(a, b));
  slope[0] = vec_scale(-1, vec_add(slope[1], vec_add(slope[2], slope[3])));
  for (int v = 0; v < 4; v++)
    vec_store(gradient + 3 * v, vec_scale(s, vec_sub(sums.gradient[v], vec_scale(sums.depth, slope[v]))));
  *volume = (double)sums.volume;
  return (double)(s * sums.depth);
}

static void find_gradient(const void *question, const double tet[12], double gradient[12]) {
  double volume;
  press_with_gradient(question, tet, &volume, gradient);
}

void contact_ball_overlap(const double tet[12], const double centre[3], double radius, double *volume,
                          double gradient[12]) {
  double own[12];
  *volume = 0;
  if (gradient) memset(gradient, 0, 12 * sizeof *gradient);
  if (contact_ball_separation(tet, centre, radius) >= 0) return;
  *volume = overlap_with_gradient(tet, centre, radius, gradient ? gradient : own);
}

void contact_ball_press(const double tet[12], const double centre[3], double radius, double rest_volume,
                        double *volume, double *energy, double gradient[12], double hessian[144]) {
  Question question = {centre, radius, rest_volume};
  *volume = *energy = 0;
  memset(gradient, 0, 12 * sizeof *gradient);
  if (hessian) memset(hessian, 0, 144 * sizeof *hessian);
  if (contact_ball_separation(tet, centre, radius) >= 0) return;
  *energy = press_with_gradient(&question, tet, volume, gradient);
  if (!hessian) return;
  contact_definite_differentiate(find_gradient, &question, tet, hessian);
  double whole = fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
  double bound = rest_volume / whole / radius * *volume; // with it no eigenvalue is negative but by rounding
  for (int r = 0; r < 12; r++) hessian[13 * r] += bound;
  contact_definite_mend(hessian);
  for (int r = 0; r < 12; r++) hessian[13 * r] -= bound;
}

// The share of b at the point of the segment a b that is nearest to the origin.
static double share_on_segment(Vec3 a, Vec3 b) {
  Vec3 edge = vec3_sub(b, a);
  double square = vec3_dot(edge, edge);
  return square > 0 ? fmin(fmax(-vec3_dot(a, edge) / square, 0), 1) : 0;
}

// The weights of a triangle's corners at its point nearest to the origin: at the foot on the plane if that
// lies inside, else on an edge. Returns the square of the distance.
static double nearest_on_triangle(const Vec3 corners[3], double weights[3]) {
  Vec3 normal = vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
  double twice = vec3_dot(normal, normal), nearest = INFINITY;
  bool is_inside = twice > 0;
  for (int v = 0; v < 3; v++) {
    Vec3 next = corners[(v + 1) % 3], edge = vec3_sub(corners[(v + 2) % 3], next);
    weights[v] = is_inside ? -vec3_dot(vec3_cross(normal, edge), next) / twice : 0;
  }
  for (int v = 0; v < 3; v++) is_inside = is_inside && weights[v] >= 0;
  if (is_inside) return vec3_dot(normal, corners[0]) * vec3_dot(normal, corners[0]) / twice;
  for (int v = 0; v < 3; v++) {
    int next = (v + 1) % 3;
    double square = contact_triangle_square_of_edge(corners[v], corners[next]);
    if (!(square < nearest)) continue;
    nearest = square;
    weights[next] = share_on_segment(corners[v], corners[next]);
    weights[v] = 1 - weights[next];
    weights[(v + 2) % 3] = 0;
  }
  return nearest;
}

void contact_ball_nearest(const double tet[12], const double centre[3], double weights[4]) {
  Vec3 x[4];
  double nearest = INFINITY;
  for (int v = 0; v < 4; v++) x[v] = vec3_sub(vec3_at(tet + 3 * v), vec3_at(centre));
  double orientation = vec3_det4(x[0], x[1], x[2], x[3]);
  bool is_inside = orientation != 0;
  for (int v = 0; v < 4; v++) weights[v] = 0.25;
  for (int f = 0; f < 4; f++) {
    Vec3 corners[3] = {x[tet_faces[f][0]], x[tet_faces[f][1]], x[tet_faces[f][2]]};
    Vec3 normal = vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
    is_inside = is_inside && vec3_dot(normal, corners[0]) * orientation >= 0;
  }
  for (int f = 0; f < 4 && !is_inside; f++) {
    double own[3];
    Vec3 corners[3] = {x[tet_faces[f][0]], x[tet_faces[f][1]], x[tet_faces[f][2]]};
    double square = nearest_on_triangle(corners, own);
    if (!(square < nearest)) continue;
    nearest = square;
    weights[f] = 0;
    for (int v = 0; v < 3; v++) weights[tet_faces[f][v]] = own[v];
  }
}

double contact_ball_separation(const double tet[12], const double centre[3], double radius) {
  Vec3 x[4];
  for (int v = 0; v < 4; v++) x[v] = vec3_sub(vec3_at(tet + 3 * v), vec3_at(centre));
  double orientation = vec3_det4(x[0], x[1], x[2], x[3]), nearest = INFINITY;
  bool is_inside = orientation != 0;
  for (int f = 0; f < 4; f++) {
    Vec3 corners[3] = {x[tet_faces[f][0]], x[tet_faces[f][1]], x[tet_faces[f][2]]};
    Vec3 normal = vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
    is_inside = is_inside && vec3_dot(normal, corners[0]) * orientation >= 0;
    nearest = fmin(nearest, contact_triangle_square(corners));
  }
  return is_inside ? -radius : sqrt(nearest) - radius;
}
