// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/pressure/trace.h"

#include <math.h>

#include "base/tet.h"
#include "base/vec3.h"
#include "contact/limits.h"
#include "contact/shape/shape.h"

// A value is at most this many times the mean of its samples: of one that falls to 0 within them it is 1.5.
static const double MOST = 2;

// Of no more samples than numbers a fit says nothing of their scatter. Of those round a vertex the count is a
// bound from below, as if its neighbours shared them all.
static const double FEW = 3; // not chosen: a linear function in a plane has three numbers
static const double FEW_ROUND = 2;

// ---- Samples.

typedef struct Sample {
  Vec3 x, force, pull; // on the side that is looked at
  double area, pressure, depth;
} Sample;

static void add_sample(const Sample *sample, double lambda, Vec3 vertex, ContactTrace *trace) {
  Vec3 r = vec3_sub(sample->x, vertex);
  double w = lambda * sample->area;
  const double values[CONTACT_TRACE_VALUES] = {sample->pressure, sample->depth},
               squares[6] = {r.x * r.x, r.y * r.y, r.z * r.z, r.x * r.y, r.y * r.z, r.x * r.z};
  trace->weight += w;
  trace->squares += w * w;
  trace->pressed += lambda * vec3_length(sample->force);
  vec3_accumulate(trace->force, vec3_scale(lambda, sample->force));
  vec3_accumulate(trace->rub, vec3_scale(lambda, sample->pull));
  vec3_accumulate(trace->arm, vec3_scale(w, r));
  for (int k = 0; k < 6; k++) trace->spread[k] += w * squares[k];
  for (int k = 0; k < CONTACT_TRACE_VALUES; k++) {
    trace->values[k] += w * values[k];
    vec3_accumulate(trace->moments[k], vec3_scale(w * values[k], r));
  }
}

// How far before x, against a direction, a cell begins; 0: x is within it or has passed it; INFINITY: the
// line through x misses it. Where it is in the cell, λ + t μ ≥ 0 for all four.
static double gap_to_cell(const ContactLayout *layout, const double *positions, int cell, Vec3 x,
                          Vec3 direction) {
  Vec3 c[4], e[3], across[3];
  double lambda[4], mu[4], least = -INFINITY, most = INFINITY;
  for (int v = 0; v < 4; v++) c[v] = vec3_at(positions + 3 * (size_t)layout->mesh.cells[cell][v]);
  for (int k = 0; k < 3; k++) e[k] = vec3_sub(c[k + 1], c[0]);
  for (int k = 0; k < 3; k++) across[k] = vec3_cross(e[(k + 1) % 3], e[(k + 2) % 3]);
  double whole = vec3_dot(e[0], across[0]);
  lambda[0] = 1, mu[0] = 0;
  for (int k = 0; k < 3; k++) {
    lambda[k + 1] = vec3_dot(across[k], vec3_sub(x, c[0])) / whole;
    mu[k + 1] = vec3_dot(across[k], direction) / whole;
    lambda[0] -= lambda[k + 1], mu[0] -= mu[k + 1];
  }
  for (int v = 0; v < 4; v++) {
    double at = -(lambda[v] + CONTACT_FLAT) / mu[v];
    if (mu[v] > 0) least = fmax(least, at);
    if (mu[v] < 0) most = fmin(most, at);
    if (mu[v] == 0 && !(lambda[v] >= -CONTACT_FLAT)) return INFINITY;
  }
  return least <= most ? fmax(0, -most) : INFINITY;
}

// How far a vertex at x is from what the pair has on the other side, against the force on it; 0: touched or
// passed; INFINITY: beside it.
static double gap_to_other(const ContactLayout *layout, const ContactEvaluation *evaluation, int k, int side,
                           Vec3 x, Vec3 force) {
  const ContactPair *pair = &evaluation->pairs[k];
  Vec3 inward = vec3_scale(1 / vec3_length(force), force);
  int other = pair->cells[1 - side];
  if (other >= 0) return gap_to_cell(layout, evaluation->positions, other, x, inward);
  const ContactShape *shape = &layout->def.shapes[layout->interfaces[pair->interface].shape];
  double size = cbrt(contact_layout_tet_volume(layout, pair->cells[side]));
  if (contact_shape_gap(shape, evaluation->time, vec3_sub(x, vec3_scale(size, inward))) > 0) return INFINITY;
  return fmax(0, contact_shape_gap(shape, evaluation->time, x));
}

static int carrier_count(const ContactStars *stars, int vertex) {
  return stars->is_needed ? stars->begin[vertex + 1] - stars->begin[vertex] : 1;
}

static int carrier(const ContactStars *stars, int vertex, int k, double *weight) {
  *weight = stars->is_needed ? stars->weights[stars->begin[vertex] + k] : 1;
  return stars->is_needed ? stars->nodes[stars->begin[vertex] + k] : vertex;
}

// Carriers of less than half of the largest weight are not beside the vertex.
static double least_weight(const ContactStars *stars, int vertex) {
  double weight, largest = 0;
  int count = carrier_count(stars, vertex);
  for (int c = 0; c < count; c++) {
    carrier(stars, vertex, c, &weight);
    largest = fmax(largest, weight);
  }
  return 0.5 * largest;
}

// Where a given vertex is.
static Vec3 place_of(const ContactStars *stars, const double *positions, int given) {
  int vertex = stars->is_needed ? stars->place[given] : given;
  return vec3_at(positions + 3 * (size_t)vertex);
}

static void add_side(const ContactLayout *layout, const ContactStars *stars,
                     const ContactEvaluation *evaluation, int k, int side, const Sample *sample,
                     ContactTrace *traces) {
  const ContactPair *pair = &evaluation->pairs[k];
  const int *vertices = contact_layout_vertices(layout, pair->cells[side]);
  for (int v = 0; v < 4; v++) {
    double lambda = fmax(evaluation->fields[k].weights[side][v], 0), weight;
    if (layout->mesh.depths[vertices[v]] > 0) continue;
    int count = carrier_count(stars, vertices[v]);
    double least = least_weight(stars, vertices[v]);
    for (int c = 0; c < count; c++) {
      int given = carrier(stars, vertices[v], c, &weight);
      if (!(weight >= least)) continue;
      Vec3 x = place_of(stars, evaluation->positions, given);
      add_sample(sample, lambda * weight, x, &traces[given]);
    }
  }
}

// The vertices of a side that stand for given ones; their forces are summed up.
static void face_side(const ContactLayout *layout, const ContactStars *stars,
                      const ContactEvaluation *evaluation, int k, int side, ContactTrace *traces) {
  const int *vertices = contact_layout_vertices(layout, evaluation->pairs[k].cells[side]);
  for (int v = 0; v < 4; v++) {
    int given = contact_stars_given(stars, vertices[v]);
    if (layout->mesh.depths[vertices[v]] > 0 || given < 0) continue;
    ContactTrace *trace = &traces[given];
    if (!(trace->pressed > 0) || (trace->is_faced && trace->gap == 0)) continue;
    Vec3 x = place_of(stars, evaluation->positions, given);
    double gap = gap_to_other(layout, evaluation, k, side, x, vec3_at(trace->force));
    if (gap == INFINITY) continue;
    trace->gap = trace->is_faced ? fmin(trace->gap, gap) : gap;
    trace->is_faced = true;
  }
}

void contact_trace_add(const ContactLayout *layout, const ContactStars *stars,
                       const ContactEvaluation *evaluation, const bool *is_wanted, const double (*pulls)[3],
                       ContactTrace *traces) {
  for (int k = 0; k < evaluation->pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    const ContactFieldPair *field = &evaluation->fields[k];
    double area = contact_field_area(field);
    if ((is_wanted && !is_wanted[pair->interface]) || !(area > 0)) continue;
    for (int side = 0; side < 2 && pair->cells[side] >= 0; side++) {
      double sign = side == 0 ? 1 : -1;
      Sample sample = {.x = vec3_at(field->centroid),
                       .force = vec3_scale(sign, vec3_at(field->force)),
                       .area = area,
                       .pressure = vec3_length(vec3_at(field->force)) / area,
                       .depth = field->volume / area};
      if (pulls) sample.pull = vec3_scale(sign, vec3_at(pulls[k]));
      add_side(layout, stars, evaluation, k, side, &sample, traces);
    }
  }
  for (int k = 0; k < evaluation->pair_count; k++)
    for (int side = 0; side < 2 && evaluation->pairs[k].cells[side] >= 0; side++)
      if (!is_wanted || is_wanted[evaluation->pairs[k].interface])
        face_side(layout, stars, evaluation, k, side, traces);
}

// ---- Rings.

// Whether there are no more samples than these.
static bool has_few(const ContactTrace *trace, double count) {
  return !(trace->weight * trace->weight > count * trace->squares);
}

// Adds a share of a trace whose vertex is that way from the one of `to`. The same sample may be in both, so
// their Σ w² is at most (√Σ w₁² + √Σ w₂²)².
static void add_trace(const ContactTrace *from, Vec3 way, double share, ContactTrace *to) {
  const double w = share * from->weight, products[6] = {way.x * way.x, way.y * way.y, way.z * way.z,
                                                        way.x * way.y, way.y * way.z, way.x * way.z};
  Vec3 arm = vec3_scale(share, vec3_at(from->arm));
  const double crosses[6] = {2 * arm.x * way.x,
                             2 * arm.y * way.y,
                             2 * arm.z * way.z,
                             arm.x * way.y + arm.y * way.x,
                             arm.y * way.z + arm.z * way.y,
                             arm.x * way.z + arm.z * way.x};
  double root = sqrt(to->squares) + share * sqrt(from->squares);
  to->weight += w;
  to->squares = root * root;
  vec3_accumulate(to->arm, vec3_add(arm, vec3_scale(w, way)));
  for (int k = 0; k < 6; k++) to->spread[k] += share * from->spread[k] + crosses[k] + w * products[k];
  for (int k = 0; k < CONTACT_TRACE_VALUES; k++) {
    double value = share * from->values[k];
    to->values[k] += value;
    vec3_accumulate(to->moments[k],
                    vec3_add(vec3_scale(share, vec3_at(from->moments[k])), vec3_scale(value, way)));
  }
}

// Adds the trace of a neighbour as far as it is pressed the same way.
static void add_neighbour(const ContactStars *stars, const double *positions, const ContactTrace *traces,
                          int given, int neighbour, ContactTrace *ring) {
  const ContactTrace *own = &traces[given], *other = &traces[neighbour];
  Vec3 force = vec3_at(own->force), push = vec3_at(other->force);
  double lengths = vec3_length(force) * vec3_length(push);
  if (given == neighbour || !(other->weight > 0) || !(lengths > 0)) return;
  Vec3 way = vec3_sub(place_of(stars, positions, neighbour), place_of(stars, positions, given));
  add_trace(other, way, fmax(0, vec3_dot(force, push) / lengths), ring);
}

// To the rings of a contact vertex's carriers, from the carriers of another one on the same face.
static void add_neighbours(const ContactStars *stars, const double *positions, const ContactTrace *traces,
                           int vertex, int other, ContactTrace *rings) {
  double weight, least = least_weight(stars, vertex), least_other = least_weight(stars, other);
  for (int c = 0; c < carrier_count(stars, vertex); c++) {
    int given = carrier(stars, vertex, c, &weight);
    if (!(weight >= least) || !(traces[given].weight > 0) || !has_few(&traces[given], FEW)) continue;
    for (int d = 0; d < carrier_count(stars, other); d++) {
      int neighbour = carrier(stars, other, d, &weight);
      if (weight >= least_other) add_neighbour(stars, positions, traces, given, neighbour, &rings[given]);
    }
  }
}

void contact_trace_ring(const ContactLayout *layout, const ContactStars *stars, const double *positions,
                        const ContactTrace *traces, ContactTrace *rings) {
  for (int cell = 0; cell < layout->mesh.cell_count; cell++)
    for (int f = 0; f < 4; f++) {
      if (!(layout->mesh.outer[cell] >> f & 1)) continue;
      for (int v = 0; v < 3; v++)
        for (int w = 0; w < 3; w++)
          add_neighbours(stars, positions, traces, layout->mesh.cells[cell][tet_faces[f][v]],
                         layout->mesh.cells[cell][tet_faces[f][w]], rings);
    }
}

// ---- Values.

// The samples of a vertex in its tangent plane, along the axes of their spread.
typedef struct Plane {
  Vec3 axes[2];
  double mean[2];   // m along them [m]
  double spread[2]; // of C [m²]
} Plane;

static Vec3 spread_times(const double s[6], Vec3 a) {
  return (Vec3){s[0] * a.x + s[3] * a.y + s[5] * a.z, s[3] * a.x + s[1] * a.y + s[4] * a.z,
                s[5] * a.x + s[4] * a.y + s[2] * a.z};
}

static Plane find_plane(const ContactTrace *trace, Vec3 normal) {
  Vec3 t = vec3_cross(normal, fabs(normal.x) < 0.5 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0});
  t = vec3_scale(1 / vec3_length(t), t);
  const Vec3 axes[2] = {t, vec3_cross(normal, t)};
  Vec3 mean = vec3_scale(1 / trace->weight, vec3_at(trace->arm));
  double c[2][2], m[2];
  for (int i = 0; i < 2; i++) m[i] = vec3_dot(mean, axes[i]);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      c[i][j] = vec3_dot(axes[i], spread_times(trace->spread, axes[j])) / trace->weight - m[i] * m[j];
  double angle = 0.5 * atan2(2 * c[0][1], c[0][0] - c[1][1]), cosine = cos(angle), sine = sin(angle);
  double middle = 0.5 * (c[0][0] + c[1][1]), half = hypot(0.5 * (c[0][0] - c[1][1]), c[0][1]);
  return (Plane){.axes = {vec3_add(vec3_scale(cosine, axes[0]), vec3_scale(sine, axes[1])),
                          vec3_sub(vec3_scale(cosine, axes[1]), vec3_scale(sine, axes[0]))},
                 .mean = {cosine * m[0] + sine * m[1], cosine * m[1] - sine * m[0]},
                 .spread = {fmax(0, middle + half), fmax(0, middle - half)}};
}

static double value_at(const ContactTrace *trace, const Plane *plane, int value) {
  double mean = trace->values[value] / trace->weight, at = mean;
  for (int k = 0; k < 2; k++) {
    double together = vec3_dot(vec3_at(trace->moments[value]), plane->axes[k]) / trace->weight -
                      mean * plane->mean[k],
           spread = plane->spread[k] + CONTACT_FLAT * plane->mean[k] * plane->mean[k];
    if (spread > 0) at -= together / spread * plane->mean[k];
  }
  return fmin(fmax(at, 0), MOST * mean);
}

static void find(const ContactTrace *trace, const ContactTrace *ring, double *pressure, double *depth,
                 double traction[3]) {
  double *values[CONTACT_TRACE_VALUES] = {pressure, depth};
  *pressure = *depth = 0;
  for (int c = 0; c < 3; c++) traction[c] = 0;
  double length = vec3_length(vec3_at(trace->force));
  if (!(trace->is_faced && trace->weight > 0 && length > 0)) return;
  double left = 1 - trace->gap * trace->weight / trace->values[CONTACT_TRACE_DEPTH];
  if (!(left > 0)) return; // beyond the rim
  Vec3 towards = vec3_scale(1 / length, vec3_at(trace->force));
  ContactTrace fitted = *trace;
  bool is_few = has_few(trace, FEW), is_fit = !is_few || !has_few(ring, FEW_ROUND);
  if (is_few && is_fit) add_trace(ring, (Vec3){0, 0, 0}, trace->weight / ring->weight, &fitted);
  Plane plane = find_plane(&fitted, towards);
  for (int k = 0; k < CONTACT_TRACE_VALUES; k++) {
    double mean = trace->values[k] / trace->weight, most = is_few ? left * mean : INFINITY;
    *values[k] = fmin(is_fit ? value_at(&fitted, &plane, k) : mean, most);
  }
  vec3_store(traction,
             vec3_scale(*pressure, vec3_add(towards, vec3_scale(1 / trace->pressed, vec3_at(trace->rub)))));
}

void contact_trace_find(int count, const ContactTrace *traces, const ContactTrace *rings,
                        const ContactTraceResult *result) {
  for (int v = 0; v < count; v++) {
    double own[3];
    find(&traces[v], &rings[v], &result->pressures[v], &result->depths[v],
         result->tractions ? result->tractions[v] : own);
  }
}
