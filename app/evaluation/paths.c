// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/evaluation/paths.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "app/dataset/source.h"
#include "base/random.h"
#include "base/vec3.h"

enum { SIZE = OVERLAP_PAIR_SIZE, INTERVALS = 64, KINDS = 3, RESERVE = 8 };

static const double FINEST = 5e-9, FLATTEST = 1e-3, TURN = 2;

const double app_evaluation_volume_jump = 1e-8, app_evaluation_gradient_jump = 1e-5;

// The pair at τ in [0, 1] is from + τ (to − from), its first tetrahedron then turned by τ · turn about
// `axis`.
typedef struct Path {
  double from[SIZE], to[SIZE];
  double turn, centre[3];
  int axis;
} Path;

typedef struct Point {
  double volume, gradient[SIZE];
  double rate;     // dV/dτ
  double flatness; // of the flatter tetrahedron, negative where it is inside out
} Point;

typedef struct Jumps {
  double volume, gradient; // by the largest of the path
  bool is_usable;
} Jumps;

static void turn_along_path(const Path *path, double tau, double x[SIZE], double velocity[SIZE]) {
  int i = (path->axis + 1) % 3, j = (path->axis + 2) % 3;
  double c = cos(path->turn * tau), s = sin(path->turn * tau);
  for (int v = 0; v < 12; v += 3) {
    double p = x[v + i] - path->centre[i], q = x[v + j] - path->centre[j];
    double dp = velocity[v + i], dq = velocity[v + j];
    x[v + i] = path->centre[i] + c * p - s * q;
    x[v + j] = path->centre[j] + s * p + c * q;
    velocity[v + i] = c * dp - s * dq - path->turn * (s * p + c * q);
    velocity[v + j] = s * dp + c * dq + path->turn * (c * p - s * q);
  }
}

static double det(const double *tet) {
  return vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9));
}

static double longest_edge(const double *tet) {
  double longest = 0;
  for (int a = 0; a < 12; a += 3)
    for (int b = 0; b < a; b += 3)
      longest = fmax(longest, vec3_length(vec3_sub(vec3_at(tet + a), vec3_at(tet + b))));
  return longest;
}

static double flatness_of(const Path *path, const double x[SIZE]) {
  double least = INFINITY;
  for (int t = 0; t < SIZE; t += 12) {
    double sign = det(path->from + t) > 0 ? 1 : -1;
    least = fmin(least, sign * det(x + t) / pow(longest_edge(x + t), 3));
  }
  return least;
}

static Status look(const OverlapModel *model, const Path *path, double tau, Point *point) {
  double x[SIZE], velocity[SIZE];
  for (int i = 0; i < SIZE; i++) {
    velocity[i] = path->to[i] - path->from[i];
    x[i] = path->from[i] + tau * velocity[i];
  }
  turn_along_path(path, tau, x, velocity);
  OverlapBatch one = {.pair_count = 1, .pairs = x, .volume = &point->volume, .gradient = point->gradient};
  TRY(overlap_model_eval(model, &one));
  point->flatness = flatness_of(path, x);
  point->rate = 0;
  for (int i = 0; i < SIZE; i++) point->rate += point->gradient[i] * velocity[i];
  return STATUS_OK;
}

static double length_of(const double x[SIZE]) {
  double sum = 0;
  for (int i = 0; i < SIZE; i++) sum += x[i] * x[i];
  return sqrt(sum);
}

static double change_of(const Point *a, const Point *b, bool of_gradient) {
  double difference[SIZE];
  if (!of_gradient) return fabs(b->volume - a->volume);
  for (int i = 0; i < SIZE; i++) difference[i] = b->gradient[i] - a->gradient[i];
  return length_of(difference);
}

// What is left of the change between two points, `span` of τ apart.
static Status bisect(const OverlapModel *model, const Path *path, double tau, double span, Point low,
                     Point high, bool of_gradient, double *jump) {
  while (span > FINEST) {
    Point middle;
    span /= 2;
    TRY(look(model, path, tau + span, &middle));
    if (change_of(&low, &middle, of_gradient) > change_of(&middle, &high, of_gradient))
      high = middle;
    else
      low = middle, tau += span;
  }
  *jump = of_gradient ? change_of(&low, &high, true)
                      : fabs(high.volume - low.volume - span * (low.rate + high.rate) / 2);
  return STATUS_OK;
}

static Status search(const OverlapModel *model, const Path *path, const Point points[INTERVALS + 1],
                     Jumps *jumps) {
  const double span = 1.0 / INTERVALS;
  double volume = 0, gradient = 0;
  for (int k = 0; k <= INTERVALS; k++) {
    volume = fmax(volume, points[k].volume);
    gradient = fmax(gradient, length_of(points[k].gradient));
  }
  for (int k = 0; k < INTERVALS; k++) {
    double jump;
    if (change_of(&points[k], &points[k + 1], true) == 0) continue; // nothing there
    TRY(bisect(model, path, k * span, span, points[k], points[k + 1], false, &jump));
    jumps->volume = fmax(jumps->volume, jump / volume);
    TRY(bisect(model, path, k * span, span, points[k], points[k + 1], true, &jump));
    jumps->gradient = fmax(jumps->gradient, jump / gradient);
  }
  return STATUS_OK;
}

static Status try(const OverlapModel *model, const Path *path, Jumps *jumps) {
  Point points[INTERVALS + 1];
  double volume = 0;
  *jumps = (Jumps){0};
  for (int k = 0; k <= INTERVALS; k++) {
    TRY(look(model, path, k / (double)INTERVALS, &points[k]));
    if (!(points[k].flatness > FLATTEST)) return STATUS_OK;
    volume = fmax(volume, points[k].volume);
  }
  jumps->is_usable = volume > 0;
  return jumps->is_usable ? search(model, path, points, jumps) : STATUS_OK;
}

// `number` chooses pair, kind of path and directions.
static Path make(const DatagenPairs *pairs, size_t pair_count, uint64_t seed, int number) {
  Random random = random_seeded(seed, (uint64_t)number);
  const double *pair = pairs->coordinates + SIZE * ((size_t)number % pair_count);
  const double *other = pairs->coordinates + SIZE * (((size_t)number + 1) % pair_count);
  Path path = {.axis = random_below(&random, 3)};
  memcpy(path.from, pair, sizeof path.from), memcpy(path.to, pair, sizeof path.to);
  int kind = number % KINDS;
  double direction[3];
  random_direction(&random, direction);
  for (int i = 0; i < 12 && kind == 0; i++) {
    path.from[i] -= direction[i % 3];
    path.to[i] += direction[i % 3];
  }
  for (int i = 0; i < 12; i++) path.centre[i % 3] += 0.25 * pair[i];
  if (kind == 1) path.turn = TURN;
  for (int i = 0; i < SIZE && kind == 2; i++) path.to[i] += 0.5 * (other[i] - pair[i]);
  return path;
}

static void add(AppEvaluationPaths *result, const Jumps *jumps) {
  result->count++;
  result->volume_jump = fmax(result->volume_jump, jumps->volume);
  result->gradient_jump = fmax(result->gradient_jump, jumps->gradient);
  result->jumping +=
      !(jumps->volume <= app_evaluation_volume_jump) || !(jumps->gradient <= app_evaluation_gradient_jump);
}

// `count` usable paths that start from these pairs.
static Status follow(const OverlapModel *model, const DatagenPairs *pairs, size_t pair_count, int count,
                     uint64_t seed, AppEvaluationPaths *result) {
  int wanted = result->count + count;
  for (int number = 0; result->count < wanted; number++) {
    if ((size_t)number == pair_count)
      return status_fail(STATUS_SOLVER, "of %zu paths only %d are usable, %d are wanted", pair_count,
                         result->count - wanted + count, count);
    Path path = make(pairs, pair_count, seed, number);
    Jumps jumps;
    TRY(try(model, &path, &jumps));
    if (jumps.is_usable)
      add(result, &jumps);
    else
      result->replaced++;
  }
  return STATUS_OK;
}

Status app_evaluation_paths(const OverlapModel *model, int count, uint64_t seed, AppEvaluationPaths *result) {
  const AppSourceDef sources[2] = {
      {.law = "scene", .mix = "scene=1", .count = RESERVE * (long long)count, .seed = seed},
      {.law = "uniform", .mix = "volumetric=1", .count = RESERVE * (long long)count, .seed = seed}};
  *result = (AppEvaluationPaths){0};
  for (int s = 0; s < 2; s++) {
    DatagenPairs pairs;
    size_t pair_count;
    TRY(app_dataset_source_load(&sources[s], &pairs, &pair_count));
    int share = s == 0 ? count / 2 : count - count / 2;
    Status status = follow(model, &pairs, pair_count, share, seed, result);
    datagen_pairs_destroy(&pairs);
    TRY(status);
  }
  return STATUS_OK;
}
