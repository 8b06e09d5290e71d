// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap model `geo` as a whole, with the constant φ and with random networks that are pinned at the
// onset: whatever the weights, V must have these properties. How accurate V is, is a matter of training; here
// only the constant's figures are held.
#include "suite.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "datagen/hard.h"
#include "geo_network.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/geo/model.h"
#include "overlap/pair/invariant.h"

enum { MODEL_COUNT = 6 };

typedef struct Subject {
  GeoNetwork network;
  OverlapGeoOverlap overlap;
} Subject;

// The constant, then a network for each feature set.
static void make_subject(int index, Subject *subject) {
  const int sizes[MODEL_COUNT] = {0, 36, 56, 70, 100, 120};
  if (index == 0) {
    ck_assert_ok(overlap_geo_create(&subject->overlap.model, NULL));
    return;
  }
  subject->network = geo_network_random(sizes[index], 3);
  OverlapGeoNetwork interface = geo_network_interface(&subject->network);
  ck_assert_ok(overlap_geo_create(&subject->overlap.model, &interface));
}

typedef struct Answer {
  double volume, gradient[24], hessian[576];
  unsigned flags;
} Answer;

static Answer ask(const Subject *subject, const double x[24], bool wants_hessian) {
  Answer answer;
  ck_assert_ok(overlap_geo_model_eval_pair(&subject->overlap, x,
                                           &(OverlapAnswer){.volume = &answer.volume,
                                                            .gradient = answer.gradient,
                                                            .hessian = wants_hessian ? answer.hessian : NULL,
                                                            .flags = &answer.flags}));
  return answer;
}

static int class_named(const char *name) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    if (strcmp(datagen_hard_classes[c].name, name) == 0) return c;
  ck_abort_msg("no class '%s'", name);
}

static double largest_of(const double *values, int count) {
  double largest = 0;
  for (int i = 0; i < count; i++) largest = fmax(largest, fabs(values[i]));
  return largest;
}

#define ck_assert_at_most(value, bound)                                                                      \
  do {                                                                                                       \
    double ck_value_ = (value), ck_bound_ = (bound);                                                         \
    ck_assert_msg(ck_value_ <= ck_bound_, "%s, member %d: %s = %.3g > %.3g", datagen_hard_classes[c].name,   \
                  member, #value, ck_value_, ck_bound_);                                                     \
  } while (0)

START_TEST(numbers_and_flags_fit_in_every_class) {
  Subject subject;
  make_subject(_i, &subject);
  int fallbacks = 0, positive = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 100; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      Answer answer = ask(&subject, pair.x, true);
      bool is_nothing = (answer.flags & (OVERLAP_DISJOINT | OVERLAP_FLAT)) != 0;
      ck_assert_int_eq(is_nothing, answer.volume == 0);
      ck_assert(isfinite(answer.volume) && answer.volume >= 0);
      ck_assert(isfinite(largest_of(answer.gradient, 24)) && isfinite(largest_of(answer.hessian, 576)));
      if (is_nothing) {
        ck_assert(largest_of(answer.gradient, 24) == 0 && largest_of(answer.hessian, 576) == 0);
        continue;
      }
      positive++;
      ck_assert_int_eq((answer.flags & OVERLAP_FLAT) != 0, pair.is_flat);
      if (!(answer.flags & OVERLAP_FALLBACK)) continue;
      fallbacks++;
      double volume, gradient[24];
      unsigned flags;
      ck_assert_ok(overlap_exact_ops.eval_pair(
          NULL, pair.x, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
      ck_assert(answer.volume == volume);
      ck_assert_mem_eq(answer.gradient, gradient, sizeof gradient);
    }
  ck_assert_int_gt(positive, 1000);
  ck_assert_int_gt(fallbacks, 50);
}
END_TEST

// Net force and torque and the degree of homogeneity, relative to the gradient.
START_TEST(gradients_balance_to_rounding) {
  Subject subject;
  make_subject(_i, &subject);
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 100; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      Answer answer = ask(&subject, pair.x, false);
      if (answer.volume == 0 || (answer.flags & OVERLAP_FALLBACK)) continue;
      double extent = overlap_invariant_extent(pair.x), size = largest_of(answer.gradient, 24);
      double forces = overlap_invariant_translation(pair.x, answer.gradient) * pow(extent, 2);
      double torques = overlap_invariant_rotation(pair.x, answer.gradient) * pow(extent, 3);
      double degree = overlap_invariant_scaling(pair.x, answer.volume, answer.gradient) * pow(extent, 3);
      ck_assert_at_most(forces, 1e-12 * size);
      ck_assert_at_most(torques, 1e-12 * size * extent);
      ck_assert_at_most(degree, 1e-12 * size * extent);
    }
}
END_TEST

// Vertex order, exchange, rigid motion, scale.
START_TEST(volumes_have_the_symmetries_of_the_true_one) {
  Subject subject;
  make_subject(_i, &subject);
  Random random = random_seeded(21, 0);
  const char *names[] = {"uniform", "shared vertex, overlapping", "inside", "inverted"};
  for (int n = 0; n < 4; n++)
    for (int c = class_named(names[n]), member = 0; member < 50; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      double volume = ask(&subject, pair.x, false).volume, x[24], swapped[24], rotation[9];
      if (volume == 0) continue;
      for (int k = 1; k < 24; k++) {
        datagen_hard_permute(pair.x, k, x);
        datagen_hard_permute(pair.x + 12, (5 * k + 3) % 24, x + 12);
        overlap_ops_swap(x, swapped);
        ck_assert_at_most(fabs(ask(&subject, swapped, false).volume / volume - 1), 1e-12);
      }
      memcpy(x, pair.x, sizeof x);
      random_rotation(&random, rotation);
      datagen_hard_transform(x, 8, rotation, 1, (Vec3){1, -2, 1});
      ck_assert_at_most(fabs(ask(&subject, x, false).volume / volume - 1), 1e-12 / cbrt(volume));
      const double scales[] = {1e-9, 3, 1e9};
      for (int s = 0; s < 3; s++) {
        for (int i = 0; i < 24; i++) x[i] = scales[s] * pair.x[i];
        ck_assert_at_most(fabs(ask(&subject, x, false).volume / volume / pow(scales[s], 3) - 1), 1e-12);
      }
    }
}
END_TEST

// Against central differences with a step that is small beside the overlap.
START_TEST(gradient_and_hessian_are_derivatives) {
  Subject subject;
  make_subject(_i, &subject);
  const char *names[] = {"uniform", "inside", "shallow", "scale 1e9", "inverted"};
  int seen = 0;
  for (int n = 0; n < 5; n++)
    for (int c = class_named(names[n]), member = 0; member < 15; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      OverlapGeoFrame frame;
      Answer answer = ask(&subject, pair.x, true);
      if (overlap_geo_frame(&frame, pair.x) != OVERLAP_GEO_INSIDE) continue;
      double least = 1;
      for (int k = 0; k < 8; k++) least = fmin(least, frame.slack[k]);
      if (least < 1e-5) continue; // no step is small beside it and large beside rounding
      seen++;
      double h = 3e-5 * least * overlap_invariant_extent(pair.x), size = largest_of(answer.gradient, 24);
      double bend = largest_of(answer.hessian, 576);
      for (int i = 0; i < 24; i++) {
        double x[24];
        memcpy(x, pair.x, sizeof x);
        x[i] = pair.x[i] + h;
        Answer up = ask(&subject, x, false);
        x[i] = pair.x[i] - h;
        Answer down = ask(&subject, x, false);
        ck_assert_at_most(fabs((up.volume - down.volume) / (2 * h) - answer.gradient[i]), 1e-7 * size);
        for (int j = 0; j < 24; j++) {
          double difference = (up.gradient[j] - down.gradient[j]) / (2 * h);
          ck_assert_at_most(fabs(difference - answer.hessian[24 * i + j]), 1e-6 * bend);
          ck_assert(answer.hessian[24 * i + j] == answer.hessian[24 * j + i]);
        }
      }
    }
  ck_assert_int_gt(seen, 30);
}
END_TEST

// A vertex enters a face, or an edge crosses an edge: V / V_exact → 1 whatever the network, by the pinning.
START_TEST(a_vanishing_overlap_has_the_true_volume) {
  Subject subject;
  make_subject(_i, &subject);
  const char *names[] = {"vertex on face", "edge on edge"};
  for (int n = 0; n < 2; n++)
    for (int c = class_named(names[n]), member = 0; member < 40; member++)
      for (int level = 0; level < 2; level++) {
        DatagenHardPair pair = datagen_hard_make(c, member);
        Vec3 push = n == 0 ? datagen_hard_face_normal(&pair, 0) : (Vec3){0, 0, 0};
        if (n == 1) { // towards the other's centroid
          for (int i = 0; i < 4; i++)
            push = vec3_add(push, vec3_sub(datagen_hard_vertex(&pair, 4 + i), datagen_hard_vertex(&pair, i)));
        }
        double depth = level ? 1e-4 : 1e-3, exact;
        unsigned flags;
        push = vec3_scale(depth / vec3_length(push), push);
        for (int i = 4; i < 8; i++) datagen_hard_set(&pair, i, vec3_sub(datagen_hard_vertex(&pair, i), push));
        ck_assert_ok(
            overlap_exact_ops.eval_pair(NULL, pair.x, &(OverlapAnswer){.volume = &exact, .flags = &flags}));
        Answer answer = ask(&subject, pair.x, false);
        if (answer.flags & OVERLAP_FALLBACK) continue;
        ck_assert(answer.volume > 0 && exact > 0);
        ck_assert_at_most(fabs(answer.volume / exact - 1), level ? 0.01 : 0.3);
      }
}
END_TEST

// V and its slope along a path x(τ) of two tetrahedra.
typedef struct Path {
  double from[24], to[24]; // straight, plus a rotation of the first about the origin by `turn` radians
  double turn;
} Path;

static void follow(const Path *path, double tau, double x[24], double velocity[24]) {
  for (int i = 0; i < 24; i++) {
    x[i] = path->from[i] + tau * (path->to[i] - path->from[i]);
    velocity[i] = path->to[i] - path->from[i];
  }
  double c = cos(path->turn * tau), s = sin(path->turn * tau);
  for (int v = 0; v < 4; v++) {
    double *p = x + 3 * v, *q = velocity + 3 * v, px = p[0], py = p[1], qx = q[0], qy = q[1];
    p[0] = c * px - s * py, p[1] = s * px + c * py;
    q[0] = c * qx - s * qy - path->turn * p[1], q[1] = s * qx + c * qy + path->turn * p[0];
  }
}

typedef struct Point {
  double volume, slope;
  double shape; // shape_of
} Point;

// det / (longest edge of the pair)³ of the flatter one, negative where one is not as it was at `from`.
static double shape_of(const double from[24], const double x[24]) {
  double least = INFINITY;
  for (int t = 0; t < 24; t += 12) {
    double was =
        vec3_det4(vec3_at(from + t), vec3_at(from + t + 3), vec3_at(from + t + 6), vec3_at(from + t + 9));
    double is = vec3_det4(vec3_at(x + t), vec3_at(x + t + 3), vec3_at(x + t + 6), vec3_at(x + t + 9));
    least = fmin(least, was > 0 ? is : -is);
  }
  return least / pow(overlap_invariant_extent(x), 3);
}

static Point point_at(const Subject *subject, const Path *path, double tau) {
  double x[24], velocity[24];
  follow(path, tau, x, velocity);
  Answer answer = ask(subject, x, false);
  Point point = {.volume = answer.volume, .shape = shape_of(path->from, x)};
  for (int i = 0; i < 24; i++) point.slope += answer.gradient[i] * velocity[i];
  return point;
}

static Path make_path(Random *random, int kind) {
  DatagenHardPair pair = datagen_hard_make(class_named("uniform"), random_below(random, 10000)), other;
  Path path = {.turn = kind == 1 ? 2 : 0};
  memcpy(path.from, pair.x, sizeof path.from), memcpy(path.to, pair.x, sizeof path.to);
  other = datagen_hard_make(class_named("uniform"), random_below(random, 10000));
  for (int i = 0; i < 24 && kind == 2; i++) path.to[i] += 0.5 * (other.x[i] - pair.x[i]); // deformation
  if (kind == 0) { // approach and beyond
    double d[3];
    random_direction(random, d);
    for (int i = 0; i < 12; i++) path.from[i] -= d[i % 3], path.to[i] += d[i % 3];
  }
  return path;
}

enum { PATH_POINTS = 64 };

// What is left of a change once the interval is 5e-10 long: the half that the larger part is in, again and
// again.
static double bisect(const Subject *subject, const Path *path, double low, double high, bool of_slope) {
  Point a = point_at(subject, path, low), b = point_at(subject, path, high);
  while (high - low > 5e-10) {
    double middle = (low + high) / 2;
    Point m = point_at(subject, path, middle);
    double left = of_slope ? m.slope - a.slope : m.volume - a.volume;
    double right = of_slope ? b.slope - m.slope : b.volume - m.volume;
    if (fabs(left) > fabs(right))
      high = middle, b = m;
    else
      low = middle, a = m;
  }
  return of_slope ? b.slope - a.slope : b.volume - a.volume - (high - low) * (a.slope + b.slope) / 2;
}

START_TEST(nothing_jumps_along_a_path) {
  Subject subject;
  make_subject(_i, &subject);
  Random random = random_seeded(31, 0);
  int contacts = 0;
  for (int trial = 0; trial < 60; trial++) {
    Path path = make_path(&random, trial % 3);
    Point points[PATH_POINTS + 1];
    double volume_scale = 0, slope_scale = 0;
    double shape = INFINITY;
    for (int k = 0; k <= PATH_POINTS; k++) {
      points[k] = point_at(&subject, &path, k / (double)PATH_POINTS);
      volume_scale = fmax(volume_scale, points[k].volume);
      slope_scale = fmax(slope_scale, fabs(points[k].slope));
      shape = fmin(shape, points[k].shape);
    }
    if (!(shape > 1e-3) || volume_scale == 0) continue; // through flat V has a kink
    contacts++;
    for (int k = 0; k < PATH_POINTS; k++) {
      double low = k / (double)PATH_POINTS, high = (k + 1) / (double)PATH_POINTS;
      if (points[k].volume == 0 && points[k + 1].volume == 0) continue;
      if (fabs(points[k + 1].volume - points[k].volume) > 0.03 * volume_scale)
        ck_assert_near(bisect(&subject, &path, low, high, false) / volume_scale, 0, 1e-10);
      if (fabs(points[k + 1].slope - points[k].slope) > 0.1 * slope_scale)
        ck_assert_near(bisect(&subject, &path, low, high, true) / slope_scale, 0, 1e-5);
    }
  }
  ck_assert_int_gt(contacts, 20);
}
END_TEST

// The best constant φ: the mean of ln V/V₀ over pairs of pressed meshes. (V/V₀ itself lies between 1
// and 2.5.)
static const double mean_phi = 0.407;

// Pairs uniform in the unit cube whose volumes are uniform in 0 … 0.02: equally many in each of 20 bins.
static int draw_test_law(int per_bin, double *pairs, double *volumes) {
  enum { BINS = 20 };
  int filled[BINS] = {0}, count = 0;
  Random random = random_seeded(41, 0);
  while (count < BINS * per_bin) {
    double x[24], volume;
    unsigned flags;
    for (int i = 0; i < 24; i++) x[i] = random_uniform(&random);
    ck_assert_ok(overlap_clip_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    int bin = (int)(volume / 1e-3);
    if (!(volume > 0) || bin >= BINS || filled[bin] == per_bin) continue;
    filled[bin]++;
    memcpy(pairs + 24 * count, x, sizeof x);
    volumes[count++] = volume;
  }
  return count;
}

START_TEST(without_a_network_the_error_on_the_uniform_law_is_the_known_one) {
  enum { PER_BIN = 50, COUNT = 20 * PER_BIN };
  static double pairs[COUNT * 24], exact[COUNT], volumes[COUNT];
  Subject subject;
  make_subject(0, &subject);
  subject.overlap.model.offset = mean_phi;
  ck_assert_int_eq(draw_test_law(PER_BIN, pairs, exact), COUNT);
  OverlapBatch batch = {.pair_count = COUNT, .pairs = pairs, .volume = volumes};
  ck_assert_ok(overlap_geo_eval(&subject.overlap.model, &batch));
  double sum = 0;
  for (int i = 0; i < COUNT; i++) sum += fabs(volumes[i] - exact[i]);
  ck_assert_near(sum / COUNT, 2.21e-3, 0.3e-3);
}
END_TEST

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

START_TEST(without_a_network_forces_of_pressed_meshes_are_off_by_a_few_degrees) {
  enum { COUNT = 4000 };
  static double pairs[COUNT * 24], angles[COUNT];
  Subject subject;
  make_subject(0, &subject);
  subject.overlap.model.offset = mean_phi;
  ck_assert_ok(app_bench_pairs_make("near", COUNT, 1, pairs));
  double volume_error = 0, volume_sum = 0, gradient_error = 0, gradient_sum = 0;
  for (int n = 0; n < COUNT; n++) {
    const double *x = pairs + 24 * n;
    double volume, gradient[24];
    unsigned flags;
    ck_assert_ok(overlap_clip_ops.eval_pair(
        NULL, x, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
    Answer answer = ask(&subject, x, false);
    volume_error += fabs(answer.volume - volume), volume_sum += volume;
    Vec3 force = {0, 0, 0}, true_force = {0, 0, 0};
    for (int i = 0; i < 24; i++) {
      gradient_error += pow(answer.gradient[i] - gradient[i], 2), gradient_sum += pow(gradient[i], 2);
      if (i % 3 == 0 && i < 12) {
        force = vec3_add(force, vec3_at(answer.gradient + i));
        true_force = vec3_add(true_force, vec3_at(gradient + i));
      }
    }
    angles[n] =
        180 / acos(-1) * atan2(vec3_length(vec3_cross(force, true_force)), vec3_dot(force, true_force));
  }
  qsort(angles, COUNT, sizeof *angles, compare_doubles);
  char text[160];
  snprintf(text, sizeof text, "V %.4f, gradient %.4f, angle %.3f %.3f", volume_error / volume_sum,
           sqrt(gradient_error / gradient_sum), angles[COUNT / 2], angles[COUNT * 9 / 10]);
  ck_assert_msg(fabs(volume_error / volume_sum - 0.137) <= 0.04, "%s", text);
  ck_assert_msg(fabs(sqrt(gradient_error / gradient_sum) - 0.26) <= 0.08, "%s", text);
  ck_assert_msg(fabs(angles[COUNT / 2] - 1.7) <= 0.6 && fabs(angles[COUNT * 9 / 10] - 7) <= 2, "%s", text);
}
END_TEST

// t = ln V − ln V₀ and its changes along directions, as a loss is made of them, are those of the model.
START_TEST(what_training_is_given_is_what_the_model_computes) {
  Subject subject;
  make_subject(MODEL_COUNT - 1, &subject);
  const OverlapGeoFeatureSet *set = subject.overlap.model.set;
  Random random = random_seeded(51, 0);
  int seen = 0;
  for (int member = 0; member < 60; member++) {
    DatagenHardPair pair = datagen_hard_make(class_named("uniform"), member);
    double directions[2 * 24], features[120], changes[2 * 120], log_volume, log_changes[2], rho, slope[120];
    for (int i = 0; i < 48; i++) directions[i] = suite_normal(&random);
    Answer answer = ask(&subject, pair.x, false);
    OverlapGeoOutcome outcome =
        overlap_geo_features_tangent(set, pair.x, 2, directions, features, changes, &log_volume, log_changes);
    ck_assert_int_eq(outcome == OVERLAP_GEO_INSIDE, answer.volume > 0);
    if (outcome != OVERLAP_GEO_INSIDE || answer.flags & OVERLAP_BLENDED) continue;
    seen++;
    ck_assert_ok(geo_network_eval(&subject.network, 1, features, &rho, slope));
    ck_assert_near(log_volume + subject.overlap.model.offset + rho, log(answer.volume),
                   1e-13 * fabs(log_volume));
    for (int d = 0; d < 2; d++) {
      double change = log_changes[d], along = 0, size = 0;
      for (int f = 0; f < set->count; f++) change += slope[f] * changes[set->count * d + f];
      for (int i = 0; i < 24; i++) {
        along += answer.gradient[i] * directions[24 * d + i] / answer.volume;
        size += fabs(answer.gradient[i] * directions[24 * d + i] / answer.volume);
      }
      ck_assert_near(change, along, 1e-11 * size);
    }
  }
  ck_assert_int_gt(seen, 20);
}
END_TEST

static Status fail_eval(const void *self, int count, const double *features, double *value,
                        double *gradient) {
  (void)self, (void)count, (void)features, (void)value, (void)gradient;
  return status_fail(STATUS_SOLVER, "no");
}

START_TEST(a_batch_gives_what_its_pairs_give_alone) {
  enum { COUNT = 12 * OVERLAP_GEO_CHUNK + 5 };
  static double pairs[COUNT * 24], volumes[COUNT], gradients[COUNT * 24], hessians[COUNT * 576];
  static unsigned flags[COUNT];
  Subject subject;
  make_subject(MODEL_COUNT - 1, &subject);
  for (int n = 0; n < COUNT; n++)
    memcpy(pairs + 24 * n, datagen_hard_make(n % DATAGEN_HARD_CLASS_COUNT, n).x, 24 * sizeof *pairs);
  OverlapBatch batch = {.pair_count = COUNT,
                        .pairs = pairs,
                        .volume = volumes,
                        .gradient = gradients,
                        .hessian = hessians,
                        .flags = flags};
  int threads = omp_get_max_threads();
  omp_set_num_threads(3);
  ck_assert_ok(overlap_geo_model_eval_batch(&subject.overlap, &batch));
  omp_set_num_threads(threads);
  for (int n = 0; n < COUNT; n++) {
    Answer answer = ask(&subject, pairs + 24 * n, true);
    ck_assert_mem_eq(&answer.volume, volumes + n, sizeof *volumes);
    ck_assert_mem_eq(answer.gradient, gradients + 24 * n, sizeof answer.gradient);
    ck_assert_mem_eq(answer.hessian, hessians + 576 * n, sizeof answer.hessian);
    ck_assert_uint_eq(answer.flags, flags[n]);
  }
  // and what a network fails with comes through
  subject.overlap.model.network.eval = fail_eval;
  ck_assert_int_eq(overlap_geo_model_eval_batch(&subject.overlap, &batch), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "pairs 0 to 127: no"));
}
END_TEST

static Status answer_nan(const void *self, int count, const double *features, double *value,
                         double *gradient) {
  (void)self, (void)features, (void)gradient;
  for (int n = 0; n < count; n++) value[n] = NAN;
  return STATUS_OK;
}

START_TEST(a_network_that_does_not_fit_or_fails_is_refused) {
  OverlapGeoModel model;
  OverlapGeoNetwork network = {.feature_count = 37, .eval = fail_eval};
  ck_assert_int_eq(overlap_geo_create(&model, &network), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "37"));
  network.feature_count = 36;
  ck_assert_int_eq(overlap_geo_create(&model, &network), STATUS_SOLVER);
  network.eval = answer_nan;
  ck_assert_int_eq(overlap_geo_create(&model, &network), STATUS_INPUT);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_volume");
  tcase_add_loop_test(cases, numbers_and_flags_fit_in_every_class, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, gradients_balance_to_rounding, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, volumes_have_the_symmetries_of_the_true_one, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, gradient_and_hessian_are_derivatives, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, a_vanishing_overlap_has_the_true_volume, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, nothing_jumps_along_a_path, 0, MODEL_COUNT);
  tcase_add_test(cases, without_a_network_the_error_on_the_uniform_law_is_the_known_one);
  tcase_add_test(cases, without_a_network_forces_of_pressed_meshes_are_off_by_a_few_degrees);
  tcase_add_test(cases, what_training_is_given_is_what_the_model_computes);
  tcase_add_test(cases, a_batch_gives_what_its_pairs_give_alone);
  tcase_add_test(cases, a_network_that_does_not_fit_or_fails_is_refused);
  return suite_run("geo volume", cases, 60);
}
