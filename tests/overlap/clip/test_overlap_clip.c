// SPDX-License-Identifier: GPL-3.0-or-later
// The model `clip`: overlaps that a hand can compute, and how often it needs the exact model's help.
#include "suite.h"

#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "base/memory.h"
#include "base/random.h"
#include "datagen/hard.h"
#include "overlap/clip/clip.h"
#include "overlap/exact/exact.h"
#include "overlap/pair/invariant.h"

// As near as double precision must be.
static bool is_right(const double x[24], double volume, double exact) {
  return fabs(volume - exact) <= overlap_invariant_allowed(x, exact);
}

static const double corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

typedef struct Answer {
  double volume, gradient[24], hessian[576];
  unsigned flags;
} Answer;

static Answer ask(const double x[24]) {
  Answer answer;
  ck_assert_ok(overlap_clip_ops.eval_pair(NULL, x,
                                          &(OverlapAnswer){.volume = &answer.volume,
                                                           .gradient = answer.gradient,
                                                           .hessian = answer.hessian,
                                                           .flags = &answer.flags}));
  return answer;
}

// dV and d²V per unit of translation of tetrahedron t along `direction`.
static void ask_along(const Answer *answer, int t, const double direction[3], double *first, double *second) {
  *first = *second = 0;
  for (int i = 12 * t; i < 12 * t + 12; i++) {
    *first += answer->gradient[i] * direction[i % 3];
    for (int j = 12 * t; j < 12 * t + 12; j++)
      *second += direction[i % 3] * answer->hessian[24 * i + j] * direction[j % 3];
  }
}

START_TEST(two_regular_tetrahedra_in_a_cube_share_its_octahedron) {
  const double x[24] = {0, 0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0};
  Answer answer = ask(x);
  ck_assert_near(answer.volume, 1.0 / 6, 1e-16);
  ck_assert_uint_eq(answer.flags, 0);
  // by symmetry every vertex is pushed along its own diagonal: x·∇V about the centre, 3V over eight vertices
  for (int v = 0; v < 8; v++) {
    double radial = 0;
    for (int c = 0; c < 3; c++) {
      radial += answer.gradient[3 * v + c] * (x[3 * v + c] - 0.5);
      ck_assert_near(fabs(answer.gradient[3 * v + c]), 1.0 / 24, 1e-15);
    }
    ck_assert_near(radial, 3.0 / 6 / 8, 1e-15);
  }
}
END_TEST

START_TEST(a_corner_moved_along_an_axis_leaves_a_smaller_corner) {
  for (int k = 0; k < 8; k++) {
    double x[24], d = k / 8.0, first, second;
    const double axis[3] = {1, 0, 0};
    memcpy(x, corner, sizeof corner), memcpy(x + 12, corner, sizeof corner);
    for (int v = 4; v < 8; v++) x[3 * v] += d;
    Answer answer = ask(x);
    ck_assert_near(answer.volume, (1 - d) * (1 - d) * (1 - d) / 6, 1e-16);
    if (k == 0) continue; // identical: one-sided
    ask_along(&answer, 1, axis, &first, &second);
    ck_assert_near(first, -(1 - d) * (1 - d) / 2, 1e-15);
  }
}
END_TEST

// A tip at depth d under a large face: V = V_B d³ / height³, all along the motion known.
START_TEST(a_tip_under_a_face_has_the_cube_of_its_depth) {
  const double up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
  for (int decade = 0; decade <= 8; decade++) {
    double d = 0.5 * pow(10, -decade), first, second;
    const double x[24] = {-8, -8, 0,  16, -8, 0,     -8, 16, 0,     0,  0,  -16, // ground, its face z = 0
                          0,  0,  -d, 1,  0,  1 - d, 0,  1,  1 - d, -1, -1, 1 - d};
    Answer answer = ask(x);
    double whole = overlap_invariant_tet_volume(x + 12), depth = 0 - x[14];
    ck_assert_near(answer.volume, whole * depth * depth * depth,
                   1e-9 * whole * depth * depth * depth + 1e-15);
    if (answer.flags & OVERLAP_FALLBACK) continue;
    ask_along(&answer, 0, up, &first, &second);
    ck_assert_near(first, 3 * whole * depth * depth, 1e-14);
    ck_assert_near(second, 6 * whole * depth, 1e-13);
    ask_along(&answer, 1, down, &first, &second);
    ck_assert_near(second, 6 * whole * depth, 1e-13);
  }
}
END_TEST

START_TEST(one_inside_the_other_moves_freely_and_grows_by_itself) {
  const double x[24] = {-8, -8, -8, 40, -8, -8, -8, 40, -8, -8, -8, 40, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  Answer answer = ask(x);
  ck_assert_near(answer.volume, 1.0 / 6, 1e-16);
  ck_assert_uint_eq(answer.flags, OVERLAP_ENCLOSED);
  for (int i = 0; i < 12; i++) ck_assert_near(answer.gradient[i], 0, 1e-15);
  for (int c = 0; c < 3; c++) ck_assert_near(answer.gradient[15 + 4 * c], 1.0 / 6, 1e-15);
}
END_TEST

// Faces parallel, nearly parallel, or coplanar: the bound of sin θ holds.
START_TEST(the_hessian_is_bounded_where_faces_are_parallel) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    for (int member = 0; member < 50; member++) {
      DatagenHardPair pair = datagen_hard_make(c, member);
      Answer answer = ask(pair.x);
      double bound = 12 * overlap_invariant_extent(pair.x) / OVERLAP_CLIP_LEAST_SINE;
      for (int i = 0; i < 576; i++)
        ck_assert_msg(fabs(answer.hessian[i]) <= bound, "%s, member %d: %g", datagen_hard_classes[c].name,
                      member, answer.hessian[i]);
    }
}
END_TEST

// Clip against exact on what a run meets: every volume within the demand, help for less than one in a
// thousand.
static void check_set(const char *set, int count) {
  double *pairs = memory_zeroed((size_t)count * 24, sizeof *pairs);
  ck_assert_ptr_nonnull(pairs);
  ck_assert_ok(app_bench_pairs_make(set, count, 7, pairs));
  int helped = 0;
  for (int i = 0; i < count; i++) {
    const double *x = pairs + 24 * i;
    double volume, gradient[24], expected, expected_gradient[24], extent = overlap_invariant_extent(x);
    unsigned flags;
    ck_assert_ok(overlap_clip_ops.eval_pair(
        NULL, x, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
    helped += (flags & OVERLAP_FALLBACK) != 0;
    ck_assert_ok(overlap_exact_ops.eval_pair(
        NULL, x, &(OverlapAnswer){.volume = &expected, .gradient = expected_gradient, .flags = &flags}));
    ck_assert_msg(is_right(x, volume, expected), "%s: pair %d", set, i);
    for (int c = 0; c < 24; c++)
      ck_assert_msg(fabs(gradient[c] - expected_gradient[c]) <= 1e-12 * extent * extent,
                    "%s: pair %d, gradient %d is %g, exact %g", set, i, c, gradient[c], expected_gradient[c]);
    ck_assert_int_eq(strcmp(set, "disjoint") == 0, expected == 0);
  }
  memory_free(pairs);
  ck_assert_int_lt(helped, count / 1000);
}

START_TEST(ordinary_pairs_are_right_and_hardly_ever_need_help) {
  check_set(app_bench_sets[_i], 10000);
}
END_TEST

// But for rounding: whether a volume is there, only `exact` can tell.
static bool is_touching(const char *name) {
  return strcmp(name, "touching, moved") == 0 || strcmp(name, "coplanar, opposite, rotated") == 0 ||
         strstr(name, " on ");
}

START_TEST(help_is_asked_for_slivers_touching_and_the_shallowest_only) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++) {
    const char *name = datagen_hard_classes[c].name;
    int helped = 0;
    for (int member = 0; member < 200; member++)
      helped += (ask(datagen_hard_make(c, member).x).flags & OVERLAP_FALLBACK) != 0;
    bool is_extreme = strncmp(name, "sliver", 6) == 0 || strcmp(name, "flat") == 0;
    int allowed = is_extreme ? 200 : is_touching(name) ? 200 : strcmp(name, "shallow") == 0 ? 50 : 4;
    ck_assert_msg(helped <= allowed, "%s: %d of 200", name, helped);
    if (is_extreme) ck_assert_int_gt(helped, 50);
  }
}
END_TEST

static int class_named(const char *name) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    if (strcmp(datagen_hard_classes[c].name, name) == 0) return c;
  ck_abort_msg("no class '%s'", name);
}

// Where `exact` finds nothing in common, V and all derivatives are 0, not what rounding leaves of a face that
// lies on another; by itself and in a batch.
START_TEST(pairs_that_only_touch_get_nothing) {
  enum { PAIRS = 4000 };
  int class_index = class_named("touching, moved"), disjoint = 0;
  double *pairs = memory_zeroed(PAIRS * 24, sizeof *pairs), *volume = memory_zeroed(PAIRS, sizeof *volume);
  double *gradient = memory_zeroed(PAIRS * 24, sizeof *gradient);
  ck_assert(pairs && volume && gradient);
  for (int k = 0; k < PAIRS; k++)
    memcpy(pairs + 24 * k, datagen_hard_make(class_index, k).x, 24 * sizeof *pairs);
  OverlapBatch batch = {.pair_count = PAIRS, .pairs = pairs, .volume = volume, .gradient = gradient};
  ck_assert_ok(overlap_clip_ops.eval_batch(NULL, &batch));
  for (int k = 0; k < PAIRS; k++) {
    double exact;
    unsigned flags;
    ck_assert_ok(overlap_exact_ops.eval_pair(NULL, pairs + 24 * k,
                                             &(OverlapAnswer){.volume = &exact, .flags = &flags}));
    if (exact > 0) continue;
    disjoint++;
    double largest = volume[k];
    for (int i = 0; i < 24; i++) largest = suite_larger(largest, fabs(gradient[24 * k + i]));
    ck_assert_msg(largest == 0, "pair %d: V = %g, largest of ∇V and V %g", k, volume[k], largest);
    Answer answer = ask(pairs + 24 * k);
    largest = answer.volume;
    for (int i = 0; i < 24; i++) largest = suite_larger(largest, fabs(answer.gradient[i]));
    for (int i = 0; i < 576; i++) largest = suite_larger(largest, fabs(answer.hessian[i]));
    ck_assert_msg(largest == 0, "pair %d: %g with derivatives", k, largest);
  }
  ck_assert_int_gt(disjoint, PAIRS / 4);
  memory_free(pairs), memory_free(volume), memory_free(gradient);
}
END_TEST

// Flattened step by step from fat to exactly flat: the demand holds all the way, with help where it must.
START_TEST(accuracy_holds_from_fat_to_flat) {
  int helped = 0, alone = 0;
  for (int decade = 0; decade <= 20; decade++)
    for (int member = 0; member < 20; member++) {
      DatagenHardPair pair = datagen_hard_make(4, member);
      Vec3 face =
          vec3_scale(1.0 / 3, vec3_add(vec3_at(pair.x), vec3_add(vec3_at(pair.x + 3), vec3_at(pair.x + 6))));
      Vec3 apex = vec3_sub(vec3_at(pair.x + 9), face);
      vec3_store(pair.x + 9, vec3_add(face, vec3_scale(pow(10, -decade), apex)));
      double expected;
      unsigned flags;
      Answer answer = ask(pair.x);
      ck_assert_ok(
          overlap_exact_ops.eval_pair(NULL, pair.x, &(OverlapAnswer){.volume = &expected, .flags = &flags}));
      ck_assert_msg(is_right(pair.x, answer.volume, expected), "decade %d: %g, exact %g", decade,
                    answer.volume, expected);
      if (answer.flags & OVERLAP_FALLBACK)
        helped++;
      else
        alone++;
    }
  ck_assert_int_gt(helped, 50);
  ck_assert_int_gt(alone, 50);
}
END_TEST

// A tetrahedron of random directions about a point, as thick as `share` of its size along one.
static void draw_about(Random *random, const double middle[3], double size, double share, double tet[12]) {
  double rotation[9];
  random_rotation(random, rotation);
  for (int v = 0; v < 4; v++) {
    double at[3];
    random_direction(random, at);
    at[2] *= share;
    for (int c = 0; c < 3; c++)
      tet[3 * v + c] = middle[c] + size * (rotation[3 * c] * at[0] + rotation[3 * c + 1] * at[1] +
                                           rotation[3 * c + 2] * at[2]);
  }
}

// A cell of the ground, of some metres, and a small element about a point of one of its faces.
static void draw_on_ground(Random *random, double small, double flat, double x[24]) {
  double middle[3], share[4], sum = 0;
  for (int c = 0; c < 3; c++) middle[c] = random_between(random, -5, 5);
  draw_about(random, middle, random_between(random, 1, 7), random_between(random, 0.01, 1), x);
  for (int v = 1; v < 4; v++) sum += share[v] = random_uniform(random);
  for (int c = 0; c < 3; c++)
    middle[c] = (share[1] * x[3 + c] + share[2] * x[6 + c] + share[3] * x[9 + c]) / sum;
  draw_about(random, middle, small, flat, x + 12);
}

START_TEST(small_elements_on_large_cells_are_right_and_seldom_need_help) {
  enum { PAIRS = 2000 };
  static const double flats[3] = {1, 0.1, 0.001};
  Random random = random_seeded(11, 0);
  int helped = 0, met = 0;
  for (int size = 0; size <= 6; size++)
    for (int k = 0; k < PAIRS; k++) {
      double x[24], expected, small = pow(10, -size / 3.0);
      unsigned flags;
      draw_on_ground(&random, small, flats[k % 3], x);
      Answer answer = ask(x);
      ck_assert_ok(
          overlap_exact_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &expected, .flags = &flags}));
      ck_assert_msg(is_right(x, answer.volume, expected), "size %g, pair %d: %.17g, exact %.17g", small, k,
                    answer.volume, expected);
      if (small > 0.05 || k % 3 == 2 || !(expected > 1e-6 * overlap_invariant_smaller_volume(x))) continue;
      met++;
      helped += (answer.flags & OVERLAP_FALLBACK) != 0;
    }
  ck_assert_int_gt(met, PAIRS / 2);
  ck_assert_int_lt(helped, met / 2);
}
END_TEST

START_TEST(numbers_too_large_or_small_for_double_products_get_help) {
  for (int power = -340; power <= 340; power += 680) {
    DatagenHardPair pair = datagen_hard_make(2, 1);
    double unit = ask(pair.x).volume;
    for (int i = 0; i < 24; i++) pair.x[i] = ldexp(pair.x[i], power);
    Answer answer = ask(pair.x);
    ck_assert_uint_ne(answer.flags & OVERLAP_FALLBACK, 0);
    if (power < 0)
      ck_assert_near(answer.volume, ldexp(unit, 3 * power), 1e-9 * ldexp(unit, 3 * power) + 0x1p-1074);
  }
}
END_TEST

// Found by tools/fuzz pairs. Two slivers that cross: the planes of the one tell places along it badly, across
// the other's thickness; and the tip of a sliver at another's corner, so small that its faces are as wrong as
// V.
START_TEST(slivers_that_cross_are_as_exact_as_stated) {
  static const double pairs[2][24] = {
      {0x1.c9f2e2a334f5cp+10, 0x1.c3c5bf38ac6f0p+7,  0x1.fd10e8fdf4871p+11, 0x1.226c3dfdcfd26p+11,
       0x1.31e0df5903749p+11, 0x1.770a404c96a5ap+5,  0x1.cbb38e4c2ab59p+11, 0x1.253f9507f7074p+10,
       0x1.6358c4458120bp+11, 0x1.465dbf33e0429p+11, 0x1.407e03e02a40dp+10, 0x1.222768e54c5fap+11,
       0x1.c9f2e2a334f5cp+10, 0x1.2441a7ec9f79ep+11, 0x1.fd10e8fdf4871p+11, 0x1.226c3dfdcfd26p+11,
       0x1.d3a490e4d9880p+6,  0x1.770a404c96a5ap+5,  0x1.cbb38e4c2ab59p+11, 0x1.5bbc72b85d7a6p+10,
       0x1.6358c4458120bp+11, 0x1.465dbf33e0429p+11, 0x1.407e03e02a40dp+10, 0x1.222768e54c5fap+11},
      {0x1.defba36b6099ep+6, 0x1.be41d9f12a0a6p+5,  0x1.fd911da2f3e7dp+7, 0x1.f014aa92d27acp+6,
       0x1.c5636959fd6fcp+4, -0x1.9b70a8e185b41p+5, 0x1.d637eeb040879p+7, 0x1.cc0175094e4afp+6,
       0x1.63dddd0047b37p+7, 0x1.defc8ee559ef6p+6,  0x1.7795c276568a4p+7, 0x1.fdb2ebc26cc4fp+7,
       0x1.50e21f97f6144p+7, 0x1.e72638f3995adp+6,  0x1.22a79d8a4bc71p+7, 0x1.2cf09e61e5a46p+7,
       0x1.87c50a883cafcp+5, 0x1.9717698c6ed08p+1,  0x1.058f2f2da2978p+8, 0x1.32f6a94b18df9p+7,
       0x1.d10fe96fdb548p+7, 0x1.defc8ee559ef6p+6,  0x1.7795c276568a4p+7, 0x1.fdb2ebc26cc4fp+7},
  };
  for (int k = 0; k < 2; k++)
    for (int order = 0; order < 24; order++) {
      double x[24], expected;
      unsigned flags;
      datagen_hard_permute(pairs[k], order, x);
      datagen_hard_permute(pairs[k] + 12, (7 * order) % 24, x + 12);
      Answer answer = ask(x);
      ck_assert_ok(
          overlap_exact_ops.eval_pair(NULL, x, &(OverlapAnswer){.volume = &expected, .flags = &flags}));
      ck_assert_double_gt(expected, 0);
      ck_assert_msg(is_right(x, answer.volume, expected), "pair %d, order %d: %.17g, exact %.17g", k, order,
                    answer.volume, expected);
    }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("overlap_clip");
  tcase_add_test(cases, two_regular_tetrahedra_in_a_cube_share_its_octahedron);
  tcase_add_test(cases, a_corner_moved_along_an_axis_leaves_a_smaller_corner);
  tcase_add_test(cases, a_tip_under_a_face_has_the_cube_of_its_depth);
  tcase_add_test(cases, one_inside_the_other_moves_freely_and_grows_by_itself);
  tcase_add_test(cases, the_hessian_is_bounded_where_faces_are_parallel);
  tcase_add_loop_test(cases, ordinary_pairs_are_right_and_hardly_ever_need_help, 0, APP_BENCH_SET_COUNT);
  tcase_add_test(cases, help_is_asked_for_slivers_touching_and_the_shallowest_only);
  tcase_add_test(cases, pairs_that_only_touch_get_nothing);
  tcase_add_test(cases, accuracy_holds_from_fat_to_flat);
  tcase_add_test(cases, small_elements_on_large_cells_are_right_and_seldom_need_help);
  tcase_add_test(cases, numbers_too_large_or_small_for_double_products_get_help);
  tcase_add_test(cases, slivers_that_cross_are_as_exact_as_stated);
  return suite_run("overlap clip", cases, 30);
}
