// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/field_law.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/shape/convex.h"
#include "contact/shape/shape.h"

// ---- Two points of a pair.

// Of the depth φ in side t over P: mean, variance, third central moment; and the covariance of φ with the
// cells' barycentric coordinates.
typedef struct Moments {
  double mean, square, cube;
  double lanes[8];
} Moments;

// Sums over the pyramids, of φ less that of the apex.
typedef struct Sums {
  double volume, depth, square, cube;
  double lanes[8], products[8];
} Sums;

// ∫ φ, φ², φ³ over a tetrahedron are Vol/4 h₁, Vol/10 h₂, Vol/20 h₃ with h the complete homogeneous
// polynomials of the values at its corners, here by their power sums.
static void add_pyramid(Sums *sums, double volume, const double depth[4], const double *const lanes[4]) {
  double p1 = 0, p2 = 0, p3 = 0;
  for (int k = 0; k < 4; k++) {
    p1 += depth[k];
    p2 += depth[k] * depth[k];
    p3 += depth[k] * depth[k] * depth[k];
  }
  sums->volume += volume;
  sums->depth += volume / 4 * p1;
  sums->square += volume / 20 * (p1 * p1 + p2);
  sums->cube += volume / 120 * (p1 * p1 * p1 + 3 * p1 * p2 + 2 * p3);
  for (int z = 0; z < 8; z++) {
    double sum = 0, product = 0;
    for (int k = 0; k < 4; k++) sum += lanes[k][z], product += lanes[k][z] * depth[k];
    sums->lanes[z] += volume / 4 * sum;
    sums->products[z] += volume / 20 * (p1 * sum + product);
  }
}

static Moments central(const Sums *sums) {
  double mean = sums->depth / sums->volume, square = sums->square / sums->volume;
  Moments moments = {.mean = mean, .square = square - mean * mean};
  moments.cube = sums->cube / sums->volume - mean * (3 * square - 2 * mean * mean);
  for (int z = 0; z < 8; z++)
    moments.lanes[z] = sums->products[z] / sums->volume - mean * sums->lanes[z] / sums->volume;
  return moments;
}

// False: the polyhedron has no volume to speak of.
static bool find_moments(const ContactClipped *clipped, const ContactSide sides[2], Moments moments[2]) {
  const OverlapClipPolytope *polytope = &clipped->polytope;
  int apex = contact_clipped_apex(clipped);
  for (int t = 0; t < 2; t++) {
    Sums sums = {0};
    double base = contact_side_depth(&sides[t], polytope->vertex[apex] + 4 * t);
    for (int i = 0; i < clipped->triangle_count; i++) {
      const ContactTriangle *triangle = &clipped->triangles[i];
      const double *lanes[4] = {polytope->vertex[apex]};
      double depth[4] = {0};
      for (int k = 1; k < 4; k++) {
        lanes[k] = polytope->vertex[triangle->vertex[k - 1]];
        depth[k] = contact_side_depth(&sides[t], lanes[k] + 4 * t) - base;
      }
      add_pyramid(&sums, contact_clipped_pyramid(clipped, triangle), depth, lanes);
    }
    if (!(sums.volume > 0)) return false;
    moments[t] = central(&sums);
  }
  return true;
}

// A point of P for the depth in one side, with its share of V.
typedef struct Point {
  double share, depth;
  double lanes[8]; // of the cells
} Point;

// `lanes` of x̄, φ(x̄) = `depth`. Returns how many points there are.
static int find_points(const Moments *moments, const double lanes[8], double depth, Point points[2]) {
  double sigma = sqrt(fmax(moments->square, 0));
  points[0] = (Point){.share = 1, .depth = depth};
  memcpy(points[0].lanes, lanes, sizeof points[0].lanes);
  if (!(sigma > DBL_EPSILON * fabs(depth))) return 1;
  double skew = moments->cube / (sigma * sigma * sigma), root = sqrt(4 + skew * skew);
  for (int k = 0; k < 2; k++) {
    double sign = k == 0 ? 1 : -1, reach = 0.5 * (skew + sign * root);
    points[k] = (Point){.share = 0.5 * (1 - sign * skew / root), .depth = depth + reach * sigma};
    for (int z = 0; z < 8; z++) points[k].lanes[z] = lanes[z] + reach * moments->lanes[z] / sigma;
  }
  return 2;
}

// ---- Force and energy of a pair.

static void add_point(const ContactLayout *layout, const ContactPair *pair, Point *point, Vec3 force,
                      ContactFieldPair *field, double forces[24]) {
  vec3_accumulate(field->force, force);
  for (int t = 0; t < 2; t++) {
    double *lanes = point->lanes + 4 * t;
    contact_mesh_fold(&layout->mesh, &layout->def, pair->cells[t], lanes);
    for (int v = 0; v < 4; v++)
      vec3_accumulate(forces + 12 * t + 3 * v, vec3_scale(t == 0 ? lanes[v] : -lanes[v], force));
  }
}

void contact_field_law_press(const ContactLayout *layout, const ContactPair *pair,
                             const double coordinates[24], const ContactSide sides[2],
                             ContactFieldPair *field, double forces[24]) {
  ContactClipped clipped;
  Moments moments[2] = {0};
  const ContactLaw *law = field->law;
  double lanes[8];
  for (int t = 0; t < 2; t++) contact_side_locate(&sides[t], vec3_at(field->centroid), lanes + 4 * t);
  bool has_moments =
      contact_clipped_make(&clipped, layout, pair, coordinates) && find_moments(&clipped, sides, moments);
  memset(forces, 0, 24 * sizeof *forces);
  for (int t = 0; t < 2; t++) {
    Point points[2];
    if (!has_moments) moments[t].square = 0;
    int count = find_points(&moments[t], lanes, field->depths[t], points);
    for (int k = 0; k < count; k++) {
      double weight = CONTACT_FIELD_HALF * field->weighed[1 - t] * points[k].share;
      ContactLawValue value = contact_law_at(law, points[k].depth);
      field->energy += weight * value.pressure;
      add_point(layout, pair, &points[k], vec3_scale((t == 0 ? 1 : -1) * weight * value.slope, sides[t].g),
                field, forces);
    }
  }
}

// ---- What second derivatives are made of.

// Rules with positive weights: on a triangle exact to fourth degree (Dunavant 1985), on a tetrahedron to
// second, with equal weights.
static const double TRIANGLE[6][3] = {{0.108103018168070, 0.445948490915965, 0.445948490915965},
                                      {0.445948490915965, 0.108103018168070, 0.445948490915965},
                                      {0.445948490915965, 0.445948490915965, 0.108103018168070},
                                      {0.816847572980458, 0.091576213509771, 0.091576213509771},
                                      {0.091576213509771, 0.816847572980458, 0.091576213509771},
                                      {0.091576213509771, 0.091576213509771, 0.816847572980458}};
static const double TRIANGLE_WEIGHTS[6] = {0.223381589678011, 0.223381589678011, 0.223381589678011,
                                           0.109951743655322, 0.109951743655322, 0.109951743655322};
static const double TET[4][4] = {
    {0.5854101966249685, 0.1381966011250105, 0.1381966011250105, 0.1381966011250105},
    {0.1381966011250105, 0.5854101966249685, 0.1381966011250105, 0.1381966011250105},
    {0.1381966011250105, 0.1381966011250105, 0.5854101966249685, 0.1381966011250105},
    {0.1381966011250105, 0.1381966011250105, 0.1381966011250105, 0.5854101966249685}};
enum { TRIANGLE_COUNT = sizeof TRIANGLE / sizeof *TRIANGLE, TET_COUNT = sizeof TET / sizeof *TET };

// A point of P: λ of the tetrahedra's vertices and the depths in both sides.
typedef struct Spot {
  double lanes[8], depths[2];
} Spot;

static Spot spot_between(ContactClipped *clipped, const ContactSide sides[2], int count, const int *vertices,
                         const double *shares) {
  Spot spot = {.depths = {0}};
  for (int i = 0; i < count; i++) {
    const double *lanes = contact_clipped_lanes(clipped, vertices[i]);
    const double *raw = clipped->polytope.vertex[vertices[i]];
    for (int z = 0; z < 8; z++) spot.lanes[z] += shares[i] * lanes[z];
    for (int t = 0; t < 2; t++) spot.depths[t] += shares[i] * contact_side_depth(&sides[t], raw + 4 * t);
  }
  return spot;
}

static void add_squares(double squares[8][8], double weight, const double lanes[8]) {
  for (int z = 0; z < 8; z++)
    for (int w = 0; w < 8; w++) squares[z][w] += weight * lanes[z] * lanes[w];
}

static void add_face(ContactClipped *clipped, const ContactLaw *law, const ContactSide sides[2],
                     const ContactTriangle *triangle, ContactFieldLawSums *sums) {
  const int vertices[3] = {triangle->vertex[0], triangle->vertex[1], triangle->vertex[2]};
  for (int k = 0; k < TRIANGLE_COUNT; k++) {
    Spot spot = spot_between(clipped, sides, 3, vertices, TRIANGLE[k]);
    double slope = contact_law_at(law, spot.depths[triangle->face / 4]).slope;
    add_squares(sums->face[triangle->face], triangle->share * TRIANGLE_WEIGHTS[k] * slope, spot.lanes);
  }
}

// How far the depth in side t reaches over a pyramid.
static double span_of(const ContactClipped *clipped, const ContactSide *side, int t, const int vertices[4]) {
  double low = INFINITY, high = -INFINITY;
  for (int k = 0; k < 4; k++) {
    double depth = contact_side_depth(side, clipped->polytope.vertex[vertices[k]] + 4 * t);
    low = fmin(low, depth), high = fmax(high, depth);
  }
  return high - low;
}

// The mean of p″ about a point of a pyramid, by the points' distance from its base: p″ may have a pole at the
// surface, as that of d^1.5, and a table's jumps.
static double mean_curve(const ContactLaw *law, double depth, double span) {
  double half = TET[0][1] * span;
  if (depth < 0) return -mean_curve(law, -depth, span);
  if (!(span * span > DBL_EPSILON * depth * depth)) return contact_law_at(law, depth).curve;
  double low = fmax(depth - half, 0), high = depth + half;
  return (contact_law_at(law, high).slope - contact_law_at(law, low).slope) / (high - low);
}

static void add_body(ContactClipped *clipped, const ContactLaw *law, const ContactSide sides[2],
                     const ContactTriangle *triangle, ContactFieldLawSums *sums) {
  const int vertices[4] = {contact_clipped_apex(clipped), triangle->vertex[0], triangle->vertex[1],
                           triangle->vertex[2]};
  double volume = contact_clipped_pyramid(clipped, triangle) / TET_COUNT, spans[2];
  for (int t = 0; t < 2; t++) spans[t] = span_of(clipped, &sides[t], t, vertices);
  for (int k = 0; k < TET_COUNT && volume != 0; k++) {
    Spot spot = spot_between(clipped, sides, 4, vertices, TET[k]);
    for (int t = 0; t < 2; t++) {
      double slope = contact_law_at(law, spot.depths[t]).slope;
      for (int z = 0; z < 8; z++) sums->first[t][z] += volume * slope * spot.lanes[z];
      double curve = mean_curve(law, spot.depths[t], spans[t]);
      if (isfinite(curve)) add_squares(sums->second[t], volume * curve, spot.lanes);
    }
  }
}

void contact_field_law_add(ContactClipped *clipped, const ContactLaw *law, const ContactSide sides[2],
                           ContactFieldLawSums *sums) {
  memset(sums, 0, sizeof *sums);
  for (int i = 0; i < clipped->triangle_count; i++) {
    const ContactTriangle *triangle = &clipped->triangles[i];
    add_face(clipped, law, sides, triangle, sums);
    add_body(clipped, law, sides, triangle, sums);
  }
}

// ---- Shapes, by layers.

static bool reaches(const ContactShape *shape, double time, const double tet[12], double depth) {
  ContactConvex solid;
  if (!(depth < contact_shape_middle(shape))) return false;
  ContactShape smaller = contact_shape_shrink(shape, depth, &solid);
  return contact_shape_separation(&smaller, time, tet, 0) < 0;
}

// The largest depth in a shape that the tetrahedron has: at a vertex, else from above.
static double reach_into(const ContactShape *shape, double time, const double tet[12]) {
  double low = 0, high = contact_shape_middle(shape), near = sqrt(DBL_EPSILON);
  for (int v = 0; v < 4; v++) low = fmax(low, contact_shape_depth(shape, time, vec3_at(tet + 3 * v)));
  if (low > 0 && !reaches(shape, time, tet, (1 + near) * low)) return low;
  while (high - low > near * high) {
    double middle = low > 0 ? (low + high) / 2 : high / 16; // not chosen: any divisor leads to the same depth
    if (!(middle > 0)) break;
    if (reaches(shape, time, tet, middle))
      low = middle;
    else
      high = middle;
  }
  return high;
}

// Gauss's points and weights on [0, 1].
static const double POINT[5] = {0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                0.953089922969332};
static const double WEIGHT[5] = {0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683,
                                 0.118463442528095};

enum { LAYER_COUNT = sizeof POINT / sizeof *POINT };

// Depths are powers of what is even, by this exponent: p″ may begin with a root or a pole.
static double crowding(const ContactLaw *law) {
  double n = law->exponent;
  if (law->kind == CONTACT_LAW_FORMULA) return 2;
  if (law->kind != CONTACT_LAW_POWER || n == floor(n)) return 1;
  return fmin(fmax(2, 1 / (n - 1)), 4 * LAYER_COUNT);
}

// What a layer adds to.
typedef struct Pressed {
  const ContactShape *shape;
  double time;
  const double *tet;
  double rest_volume;
  double *energy, *gradient, *hessian; // the last may be NULL
} Pressed;

// E(c) times a weight. The depth in a ball of the smaller radius R_c is (R² − 2 R c − r²)/(2 R_c).
static void add_layer(const Pressed *pressed, double depth, double weight) {
  ContactConvex solid;
  double volume, energy, gradient[12], hessian[144];
  ContactShape smaller = contact_shape_shrink(pressed->shape, depth, &solid);
  if (weight == 0) return;
  contact_shape_press(&smaller, pressed->time, pressed->tet, pressed->rest_volume, &volume, &energy, gradient,
                      pressed->hessian ? hessian : NULL);
  if (!(volume > 0)) return;
  if (smaller.kind == CONTACT_SHAPE_BALL) weight *= smaller.radius / pressed->shape->radius;
  *pressed->energy += weight * energy;
  for (int k = 0; k < 12; k++) pressed->gradient[k] += weight * gradient[k];
  for (int e = 0; e < 144 && pressed->hessian; e++) pressed->hessian[e] += weight * hessian[e];
}

// ∫ p″ E between two depths.
static void add_layers(const Pressed *pressed, const ContactLaw *law, double low, double high) {
  double crowd = crowding(law), from = pow(low, 1 / crowd), to = pow(high, 1 / crowd);
  for (int k = 0; k < LAYER_COUNT && low < high; k++) {
    double u = from + (to - from) * POINT[k], depth = pow(u, crowd);
    double width = (to - from) * crowd * pow(u, crowd - 1) * WEIGHT[k];
    add_layer(pressed, depth, width * contact_law_at(law, depth).curve);
  }
}

// Where E is not smooth in c, in order: the depths of the vertices. Returns how many are within `reach`.
static int find_knots(const ContactShape *shape, double time, const double tet[12], double reach,
                      double knots[4]) {
  int count = 0;
  for (int v = 0; v < 4; v++) {
    double depth = contact_shape_depth(shape, time, vec3_at(tet + 3 * v));
    if (!(depth > 0 && depth < reach)) continue;
    int i = count++;
    for (; i > 0 && knots[i - 1] > depth; i--) knots[i] = knots[i - 1];
    knots[i] = depth;
  }
  return count;
}

// From knot to knot, of the shape and of a table.
static void add_all_layers(const Pressed *pressed, const ContactLaw *law, double reach) {
  double knots[4], low = 0;
  int count = find_knots(pressed->shape, pressed->time, pressed->tet, reach, knots), knot = 0, row = 1;
  while (low < reach) {
    double high = knot < count ? knots[knot] : reach;
    bool has_row = law->kind == CONTACT_LAW_TABLE && row < law->table_count;
    if (has_row && law->table[2 * row] <= high)
      high = law->table[2 * row++];
    else
      knot++;
    add_layers(pressed, law, low, high);
    low = high;
  }
}

// By the exponent, on which the layers' depths depend: of the sums as they are, by a central difference.
static void derive_exponent(const ContactShape *shape, const ContactLaw *law, double time,
                            const double tet[12], double rest_volume, double *energy, double gradient[12]) {
  double step = contact_field_law_step() * (law->exponent - 1);
  *energy = 0;
  memset(gradient, 0, 12 * sizeof *gradient);
  for (int side = -1; side <= 1; side += 2) {
    double own, slope[12];
    ContactLaw other = *law;
    other.by = CONTACT_LAW_VALUE;
    other.exponent += side * step;
    contact_field_law_press_shape(shape, &other, time, tet, rest_volume, &own, slope, NULL);
    *energy += side * own / (2 * step);
    for (int i = 0; i < 12; i++) gradient[i] += side * slope[i] / (2 * step);
  }
}

void contact_field_law_press_shape(const ContactShape *shape, const ContactLaw *law, double time,
                                   const double tet[12], double rest_volume, double *energy,
                                   double gradient[12], double hessian[144]) {
  if (law->by == CONTACT_LAW_BY_EXPONENT) {
    derive_exponent(shape, law, time, tet, rest_volume, energy, gradient);
    return;
  }
  Pressed pressed = {shape, time, tet, rest_volume, energy, gradient, hessian};
  *energy = 0;
  memset(gradient, 0, 12 * sizeof *gradient);
  if (hessian) memset(hessian, 0, 144 * sizeof *hessian);
  double reach = reach_into(shape, time, tet);
  if (!(reach > 0)) return;
  add_layer(&pressed, 0, contact_law_at(law, 0).slope);
  add_all_layers(&pressed, law, reach);
}
