// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/shape/cylinder.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/tet.h"
#include "contact/shape/definite.h"

// ---- Half of the cylinder with the tetrahedron: 0 ≤ z ≤ H; the other half is mirrored.

typedef struct Sums {
  double volume, depth; // ∫ dV, ∫ φ dV
  Vec3 slopes[4];       // ∫ λ_a ∇φ dV
  Vec3 sweeps[4];       // ∫ λ_a n dA over the faces
} Sums;

typedef struct Half {
  const ContactCylinder *cylinder;
  Vec3 x[4], slope[4]; // vertices, ∇λ
  double from;         // z₀
  Sums sums;
} Half;

// A corner more for each of the two ends.
enum { CORNER_COUNT = 8 };

typedef struct Polygon {
  int count;
  Vec3 corners[CORNER_COUNT]; // counter-clockwise from outside
  Vec3 normal;                // unit length, outward
  bool is_face;               // of the tetrahedron; else a section
} Polygon;

static double side_depth(const ContactCylinder *cylinder, Vec3 x) {
  double r = hypot(x.x, x.y);
  return (cylinder->radius - r) * (cylinder->radius + r) / (2 * cylinder->round);
}

// What the depth below the side is more than zero or, near the end, more than that below the end.
static double excess(const Half *half, bool is_end, Vec3 x) {
  double depth = side_depth(half->cylinder, x);
  return is_end ? depth - (half->cylinder->half_length - x.z) : depth;
}

static double weight_at(const Half *half, int v, Vec3 x) {
  return (v == 0) + vec3_dot(half->slope[v], vec3_sub(x, half->x[0]));
}

// What the column below x adds, `area` the vector of a piece of a polygon.
static void add_point(Half *half, bool is_end, bool is_face, Vec3 x, Vec3 area) {
  Sums *sums = &half->sums;
  double w = excess(half, is_end, x), length = is_end ? w : x.z - half->from, part = area.z * length;
  Vec3 middle = {x.x, x.y, x.z - length / 2};
  Vec3 slope = {-x.x / half->cylinder->round, -x.y / half->cylinder->round, is_end};
  if (is_end) part = -part;
  if (!is_end) sums->volume += part;
  sums->depth += is_end ? part * w / 2 : part * w;
  for (int v = 0; v < 4; v++) {
    sums->slopes[v] = vec3_add(sums->slopes[v], vec3_scale(part * weight_at(half, v, middle), slope));
    if (is_face && !is_end)
      sums->sweeps[v] = vec3_add(sums->sweeps[v], vec3_scale(weight_at(half, v, x), area));
  }
}

// Radon's rule, exact to the fifth degree.
static void add_triangle(Half *half, bool is_end, bool is_face, const Vec3 corners[3]) {
  static const double at[2] = {0.10128650732345633, 0.47014206410511511};
  static const double share[2] = {0.12593918054482717, 0.13239415278850619};
  Vec3 area = vec3_scale(0.5, vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0])));
  Vec3 sum = vec3_add(corners[0], vec3_add(corners[1], corners[2]));
  add_point(half, is_end, is_face, vec3_scale(1.0 / 3, sum), vec3_scale(9.0 / 40, area));
  for (int k = 0; k < 6; k++) {
    double a = at[k / 3];
    Vec3 x = vec3_add(vec3_scale(a, sum), vec3_scale(1 - 3 * a, corners[k % 3]));
    add_point(half, is_end, is_face, x, vec3_scale(share[k / 3], area));
  }
}

// ---- The part of a polygon within a circle, as seen along z.

enum { REGION_CORNER_COUNT = 64 };
static const double LONGEST_ARC = M_PI / 8; // not chosen: where six points of Gauss reach rounding

typedef struct Region {
  Half *half;
  const Polygon *polygon;
  bool is_end;
  double centre[2], square; // of the radius
  int count;
  Vec3 corners[REGION_CORNER_COUNT];
} Region;

static void push(Region *region, Vec3 corner) {
  if (region->count < REGION_CORNER_COUNT) region->corners[region->count++] = corner;
}

// Where an arc from p is after a turn, off p.
static Vec3 along_arc(const Region *region, Vec3 p, double turn) {
  Vec3 n = region->polygon->normal;
  double u = p.x - region->centre[0], v = p.y - region->centre[1];
  double sine = sin(turn), versine = 2 * sin(turn / 2) * sin(turn / 2);
  Vec3 way = {-versine * u - sine * v, -versine * v + sine * u, 0};
  way.z = -(n.x * way.x + n.y * way.y) / n.z;
  return way;
}

// Between an arc from p and its chord: p + t (what is along the arc).
static void add_segment(Region *region, Vec3 p, double turn) {
  static const double at[6] = {0.03376524289842399, 0.16939530676686774, 0.38069040695840156,
                               0.61930959304159844, 0.83060469323313226, 0.96623475710157601};
  static const double share[6] = {0.08566224618958517, 0.18038078652406930, 0.23395696728634552,
                                  0.23395696728634552, 0.18038078652406930, 0.08566224618958517};
  static const double out[4] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                0.93056815579702629};
  static const double weight[4] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                   0.17392742256872693};
  Vec3 per_z = vec3_scale(1 / fabs(region->polygon->normal.z), region->polygon->normal);
  for (int i = 0; i < 6; i++) {
    double t = at[i] * turn, versine = 2 * sin(t / 2) * sin(t / 2);
    double swept = share[i] * fabs(turn) * region->square * versine;
    Vec3 way = along_arc(region, p, t);
    for (int k = 0; k < 4; k++)
      add_point(region->half, region->is_end, region->polygon->is_face, vec3_add(p, vec3_scale(out[k], way)),
                vec3_scale(weight[k] * out[k] * swept, per_z));
  }
}

// An arc by that turn from the last corner, in pieces; its end is a corner already, or will be.
static void add_arc(Region *region, double turn) {
  int pieces = (int)ceil(fabs(turn) / LONGEST_ARC);
  for (int k = 0; k < pieces && region->count > 0; k++) {
    Vec3 p = region->corners[region->count - 1];
    add_segment(region, p, turn / pieces);
    if (k + 1 < pieces) push(region, vec3_add(p, along_arc(region, p, turn / pieces)));
  }
}

static bool holds_centre(const Region *region) {
  const Polygon *polygon = region->polygon;
  for (int i = 0; i < polygon->count; i++) {
    Vec3 p = polygon->corners[i], q = polygon->corners[(i + 1) % polygon->count];
    double left = (q.x - p.x) * (region->centre[1] - p.y) - (q.y - p.y) * (region->centre[0] - p.x);
    if (!(left * polygon->normal.z > 0)) return false;
  }
  return region->square > 0;
}

// From p to q the way round that the polygon goes. More than half a turn is within a polygon that holds the
// centre only. Of two edges that meet on the circle the arc is none.
static double turn_between(const Region *region, Vec3 p, Vec3 q, bool same_edge) {
  double side = region->polygon->normal.z > 0 ? 1 : -1;
  double u = p.x - region->centre[0], v = p.y - region->centre[1], du = q.x - p.x, dv = q.y - p.y;
  double turn = side * atan2(u * dv - v * du, u * (u + du) + v * (v + dv));
  bool is_short = fabs(turn) < M_PI / 2, is_long = is_short && holds_centre(region);
  bool is_whole = is_long && same_edge;
  if (is_short && !is_whole && turn < 0 && (!is_long || turn > -sqrt(DBL_EPSILON))) return 0;
  if (turn < 0 || is_whole) turn += 2 * M_PI;
  return side * fmin(turn, 2 * M_PI);
}

// The part of an edge with w ≥ 0; w along it is concave. False: there is none.
static bool find_part(const Region *region, Vec3 p, Vec3 q, double part[2]) {
  double from = excess(region->half, region->is_end, p), to = excess(region->half, region->is_end, q);
  double dx = q.x - p.x, dy = q.y - p.y;
  double bend = (dx * dx + dy * dy) / (2 * region->half->cylinder->round), b = to - from + bend;
  double square = b * b + 4 * bend * from;
  part[0] = 0, part[1] = 1;
  if (from >= 0 && to >= 0) return true;
  if (square <= 0 || (from < 0 && to < 0 && !(bend > 0))) return false;
  double sum = 0.5 * (b + copysign(sqrt(square), b));
  double first = -from / sum, second = bend > 0 ? sum / bend : INFINITY;
  if (sum == 0) return false;
  if (from < 0)
    part[0] = from < 0 && to < 0 ? fmin(first, second) : (first > 0 && first < 1 ? first : second);
  if (to < 0) part[1] = from < 0 && to < 0 ? fmax(first, second) : (first > 0 && first < 1 ? first : second);
  part[0] = fmax(part[0], 0), part[1] = fmin(part[1], 1);
  return part[0] < part[1];
}

static void find_circle(Region *region) {
  const ContactCylinder *cylinder = region->half->cylinder;
  Vec3 n = region->polygon->normal, o = region->polygon->corners[0], centre = {0, 0, 0};
  region->centre[0] = region->centre[1] = 0, region->square = cylinder->radius * cylinder->radius;
  if (!region->is_end || n.z == 0) return;
  centre = (Vec3){-cylinder->round * n.x / n.z, -cylinder->round * n.y / n.z, 0};
  centre.z = o.z - (n.x * (centre.x - o.x) + n.y * (centre.y - o.y)) / n.z;
  region->centre[0] = centre.x, region->centre[1] = centre.y;
  region->square = 2 * cylinder->round * excess(region->half, true, centre);
}

// The corners of the part in turn, and the segments beyond their chords.
static void walk(Region *region) {
  const Polygon *polygon = region->polygon;
  int last_edge = -1, first_edge = -1;
  for (int i = 0; i < polygon->count; i++) {
    Vec3 p = polygon->corners[i], q = polygon->corners[(i + 1) % polygon->count];
    double part[2];
    if (!find_part(region, p, q, part)) continue;
    Vec3 begin = vec3_add(p, vec3_scale(part[0], vec3_sub(q, p)));
    bool meets = part[0] == 0 && last_edge == i - 1 && i > 0;
    if (last_edge >= 0 && !meets && polygon->normal.z != 0)
      add_arc(region, turn_between(region, region->corners[region->count - 1], begin, false));
    if (first_edge < 0) first_edge = i;
    push(region, begin), push(region, vec3_add(p, vec3_scale(part[1], vec3_sub(q, p))));
    last_edge = i;
  }
  if (last_edge >= 0 && polygon->normal.z != 0)
    add_arc(region, turn_between(region, region->corners[region->count - 1], region->corners[0],
                                 first_edge == last_edge));
}

static void walk_circle(Region *region) {
  Vec3 n = region->polygon->normal, o = region->polygon->corners[0];
  Vec3 start = {region->centre[0] + sqrt(region->square), region->centre[1], 0};
  start.z = o.z - (n.x * (start.x - o.x) + n.y * (start.y - o.y)) / n.z;
  push(region, start);
  add_arc(region, n.z > 0 ? 2 * M_PI : -2 * M_PI);
}

static void add_region(Half *half, const Polygon *polygon, bool is_end) {
  Region region = {.half = half, .polygon = polygon, .is_end = is_end};
  find_circle(&region);
  walk(&region);
  if (region.count == 0 && polygon->normal.z != 0 && holds_centre(&region)) walk_circle(&region);
  for (int k = 1; k + 1 < region.count; k++) {
    const Vec3 corners[3] = {region.corners[0], region.corners[k], region.corners[k + 1]};
    add_triangle(half, is_end, polygon->is_face, corners);
  }
}

// ---- The polygons.

// Keeps side · (z − level) ≤ 0.
static void cut(Polygon *polygon, double level, double side) {
  Polygon kept = *polygon;
  kept.count = 0;
  for (int i = 0; i < polygon->count; i++) {
    Vec3 p = polygon->corners[i], q = polygon->corners[(i + 1) % polygon->count];
    double from = side * (p.z - level), to = side * (q.z - level);
    if (from <= 0 && kept.count < CORNER_COUNT) kept.corners[kept.count++] = p;
    if ((from <= 0) == (to <= 0) || kept.count == CORNER_COUNT) continue;
    Vec3 x = vec3_add(p, vec3_scale(from / (from - to), vec3_sub(q, p)));
    kept.corners[kept.count++] = (Vec3){x.x, x.y, level};
  }
  *polygon = kept;
}

static Polygon make_face(const Half *half, int f, bool is_mirrored) {
  const Vec3 *x = half->x;
  Polygon polygon = {.count = 3, .is_face = true};
  polygon.corners[0] = x[tet_faces[f][0]];
  polygon.corners[1] = x[tet_faces[f][1 + is_mirrored]],
  polygon.corners[2] = x[tet_faces[f][2 - is_mirrored]];
  Vec3 doubled = vec3_cross(vec3_sub(polygon.corners[1], polygon.corners[0]),
                            vec3_sub(polygon.corners[2], polygon.corners[0]));
  double length = vec3_length(doubled);
  if (!(length > 0)) polygon.count = 0;
  if (length > 0) polygon.normal = vec3_scale(1 / length, doubled);
  return polygon;
}

// The section at a level, seen from outside: from above (side 1) or below (−1).
static Polygon make_section(const Half *half, double level, double side) {
  int below[4], above[4], below_count = 0, above_count = 0;
  Polygon polygon = {.normal = {0, 0, side}};
  double doubled = 0;
  for (int v = 0; v < 4; v++)
    if (half->x[v].z > level)
      above[above_count++] = v;
    else
      below[below_count++] = v;
  for (int i = 0; i < below_count; i++)
    for (int j = 0; j < above_count; j++) {
      Vec3 p = half->x[below[i]], q = half->x[above[below_count == 2 && i == 1 ? 1 - j : j]];
      Vec3 x = vec3_add(p, vec3_scale((level - p.z) / (q.z - p.z), vec3_sub(q, p)));
      polygon.corners[polygon.count++] = (Vec3){x.x, x.y, level};
    }
  for (int i = 1; i + 1 < polygon.count; i++) {
    Vec3 a = vec3_sub(polygon.corners[i], polygon.corners[0]);
    doubled += vec3_cross(a, vec3_sub(polygon.corners[i + 1], polygon.corners[0])).z;
  }
  for (int i = 0, k = polygon.count - 1; i < k && doubled * side < 0; i++, k--) {
    Vec3 kept = polygon.corners[i];
    polygon.corners[i] = polygon.corners[k], polygon.corners[k] = kept;
  }
  return polygon;
}

static void add_polygon(Half *half, const Polygon *polygon) {
  if (polygon->count < 3) return;
  add_region(half, polygon, false);
  add_region(half, polygon, true);
}

// A face that lies at the level closes the body already.
static void add_section(Half *half, double low, double high, double level, double side) {
  if (!(low < level && level < high)) return;
  Polygon section = make_section(half, level, side);
  add_polygon(half, &section);
}

// A height in the part inside where there is one, so that differences of heights keep their digits.
static double height_inside(const Half *half) {
  double deepest = -INFINITY, z = 0;
  for (int v = 0; v < 4; v++) {
    double depth = side_depth(half->cylinder, half->x[v]);
    if (depth > deepest) deepest = depth, z = half->x[v].z;
  }
  return fmin(fmax(z, 0), half->cylinder->half_length);
}

static void add_half(const ContactCylinder *cylinder, const double tet[12], double mirror, Sums *sums) {
  Half half = {.cylinder = cylinder};
  double low = INFINITY, high = -INFINITY;
  for (int v = 0; v < 4; v++) {
    half.x[v] = (Vec3){tet[3 * v], tet[3 * v + 1], mirror * tet[3 * v + 2]};
    low = fmin(low, half.x[v].z), high = fmax(high, half.x[v].z);
  }
  if (!(high > 0) || !(low < cylinder->half_length)) return;
  Vec3 a = vec3_sub(half.x[1], half.x[0]), b = vec3_sub(half.x[2], half.x[0]),
       c = vec3_sub(half.x[3], half.x[0]);
  double det = vec3_dot(a, vec3_cross(b, c));
  if (det == 0) return;
  half.slope[1] = vec3_scale(1 / det, vec3_cross(b, c));
  half.slope[2] = vec3_scale(1 / det, vec3_cross(c, a));
  half.slope[3] = vec3_scale(1 / det, vec3_cross(a, b));
  half.slope[0] = vec3_scale(-1, vec3_add(half.slope[1], vec3_add(half.slope[2], half.slope[3])));
  half.from = height_inside(&half);
  for (int f = 0; f < 4; f++) {
    Polygon face = make_face(&half, f, det < 0);
    cut(&face, cylinder->half_length, 1), cut(&face, 0, -1);
    add_polygon(&half, &face);
  }
  add_section(&half, low, high, cylinder->half_length, 1);
  add_section(&half, low, high, 0, -1);
  sums->volume += half.sums.volume, sums->depth += half.sums.depth;
  for (int v = 0; v < 4; v++) {
    half.sums.slopes[v].z *= mirror, half.sums.sweeps[v].z *= mirror;
    sums->slopes[v] = vec3_add(sums->slopes[v], half.sums.slopes[v]);
    sums->sweeps[v] = vec3_add(sums->sweeps[v], half.sums.sweeps[v]);
  }
}

static Sums sum_halves(const ContactCylinder *cylinder, const double tet[12]) {
  Sums sums = {0};
  add_half(cylinder, tet, 1, &sums);
  add_half(cylinder, tet, -1, &sums);
  sums.volume = fmax(sums.volume, 0), sums.depth = fmax(sums.depth, 0);
  return sums;
}

// ---- What contact asks for.

double contact_cylinder_depth(const ContactCylinder *cylinder, Vec3 x) {
  return fmin(side_depth(cylinder, x), cylinder->half_length - fabs(x.z));
}

void contact_cylinder_overlap(const ContactCylinder *cylinder, const double tet[12], double *volume,
                              double gradient[12]) {
  *volume = 0;
  if (gradient) memset(gradient, 0, 12 * sizeof *gradient);
  if (contact_cylinder_separation(cylinder, tet) >= 0) return;
  Sums sums = sum_halves(cylinder, tet);
  *volume = sums.volume;
  for (int v = 0; v < 4 && gradient; v++) vec3_store(gradient + 3 * v, sums.sweeps[v]);
}

// U = s ∫ φ over material, so ∂U/∂x_a = s ∫ λ_a ∇φ.
static double press_with_gradient(const ContactCylinder *cylinder, const double tet[12], double rest_volume,
                                  double *volume, double gradient[12]) {
  Sums sums = sum_halves(cylinder, tet);
  double det = vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9));
  double s = det == 0 ? 0 : 6 * rest_volume / fabs(det);
  for (int v = 0; v < 4; v++) vec3_store(gradient + 3 * v, vec3_scale(s, sums.slopes[v]));
  *volume = sums.volume;
  return s * sums.depth;
}

// What a gradient is taken of, at a tetrahedron.
typedef struct Question {
  const ContactCylinder *cylinder;
  double rest_volume;
} Question;

static void find_gradient(const void *self, const double tet[12], double gradient[12]) {
  const Question *question = self;
  double volume;
  press_with_gradient(question->cylinder, tet, question->rest_volume, &volume, gradient);
}

void contact_cylinder_press(const ContactCylinder *cylinder, const double tet[12], double rest_volume,
                            double *volume, double *energy, double gradient[12], double hessian[144]) {
  *volume = *energy = 0;
  memset(gradient, 0, 12 * sizeof *gradient);
  if (hessian) memset(hessian, 0, 144 * sizeof *hessian);
  if (contact_cylinder_separation(cylinder, tet) >= 0) return;
  *energy = press_with_gradient(cylinder, tet, rest_volume, volume, gradient);
  if (!hessian) return;
  contact_definite_differentiate(find_gradient, &(Question){cylinder, rest_volume}, tet, hessian);
}

// The square of the distance of the axis from an edge, as seen along z.
static double square_to_edge(Vec3 p, Vec3 q) {
  double dx = q.x - p.x, dy = q.y - p.y, square = dx * dx + dy * dy;
  double share = square > 0 ? fmin(fmax(-(p.x * dx + p.y * dy) / square, 0), 1) : 0;
  double x = p.x + share * dx, y = p.y + share * dy;
  return x * x + y * y;
}

static bool face_holds_axis(const Vec3 corners[3]) {
  int left = 0, right = 0;
  for (int k = 0; k < 3; k++) {
    Vec3 p = corners[k], q = corners[(k + 1) % 3];
    double turn = p.x * q.y - p.y * q.x;
    left += turn >= 0, right += turn <= 0;
  }
  return left == 3 || right == 3;
}

double contact_cylinder_separation(const ContactCylinder *cylinder, const double tet[12]) {
  Vec3 x[4];
  double low = INFINITY, high = -INFINITY, nearest = INFINITY;
  for (int v = 0; v < 4; v++) {
    x[v] = vec3_at(tet + 3 * v);
    low = fmin(low, x[v].z), high = fmax(high, x[v].z);
    for (int w = 0; w < v; w++) nearest = fmin(nearest, square_to_edge(x[v], x[w]));
  }
  for (int f = 0; f < 4; f++) {
    const Vec3 corners[3] = {x[tet_faces[f][0]], x[tet_faces[f][1]], x[tet_faces[f][2]]};
    if (face_holds_axis(corners)) nearest = 0;
  }
  double ends = fmax(low, -high) - cylinder->half_length;
  return fmax(sqrt(nearest) - cylinder->radius, ends);
}
