// SPDX-License-Identifier: GPL-3.0-or-later
// The two exact overlap models: `exact` (integer brackets) and `cgal` (Nef polyhedra). What a hand can
// compute is asked of both; then the invariants of `exact`; then one against the other, which share no line
// of code.
#include "suite.h"

#include <float.h>
#include <omp.h>
#include <string.h>

#include "datagen/hard.h"
#include "overlap/exact/cgal.h"
#include "overlap/exact/exact.h"
#include "overlap/exact/fixed.h"
#include "overlap/exact/integer.h"
#include "overlap/models.h"
#include "overlap/pair/invariant.h"

static const OverlapOps *const models[] = {&overlap_exact_ops, &overlap_cgal_ops};
enum { MODEL_COUNT = 2 };

// x, y, z ≥ 0, x + y + z ≤ 1
static const double simplex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

typedef struct Answer {
  double volume;
  double gradient[24];
  unsigned flags;
} Answer;

static Answer ask(const OverlapOps *model, const double x[24]) {
  Answer answer;
  ck_assert_ok(model->eval_pair(
      NULL, x,
      &(OverlapAnswer){.volume = &answer.volume, .gradient = answer.gradient, .flags = &answer.flags}));
  return answer;
}

// The simplex against `scale` times it, moved by (x, y, z).
static void pair_simplices(double pair[24], double scale, double x, double y, double z) {
  const double shift[3] = {x, y, z};
  memcpy(pair, simplex, sizeof simplex);
  for (int c = 0; c < 12; c++) pair[12 + c] = scale * simplex[c] + shift[c % 3];
}

// What V changes by if the second tetrahedron moves by one along an axis.
static double slope(const Answer *answer, int axis) {
  double sum = 0;
  for (int i = 4; i < 8; i++) sum += answer->gradient[3 * i + axis];
  return sum;
}

// The gradient of a tetrahedron's own volume: a third of the area of the face opposite, towards the vertex.
static void differentiate_volume(const double tet[12], double gradient[12]) {
  for (int i = 0; i < 4; i++) {
    const Vec3 a = vec3_at(tet + 3 * ((i + 1) % 4)), b = vec3_at(tet + 3 * ((i + 2) % 4)),
               c = vec3_at(tet + 3 * ((i + 3) % 4));
    Vec3 n = vec3_cross(vec3_sub(b, a), vec3_sub(c, a));
    if (vec3_dot(n, vec3_sub(vec3_at(tet + 3 * i), a)) < 0) n = vec3_scale(-1, n);
    vec3_store(gradient + 3 * i, vec3_scale(1 / 6.0, n));
  }
}

static double ulps_apart(double a, double b) {
  if (a == b) return 0;
  const double larger = fmax(fabs(a), fabs(b));
  return fabs(a - b) / (nextafter(larger, INFINITY) - larger);
}

static double furthest(const double *a, const double *b, int count) {
  double distance = 0;
  for (int c = 0; c < count; c++)
    if (!(fabs(a[c] - b[c]) <= distance)) distance = fabs(a[c] - b[c]);
  return distance;
}

static void assert_nothing(const Answer *answer, unsigned flag, const char *name) {
  ck_assert_msg(answer->flags == flag, "%s: flags %u, expected %u", name, answer->flags, flag);
  ck_assert_msg(answer->volume == 0, "%s: V = %g", name, answer->volume);
  for (int c = 0; c < 24; c++) ck_assert_msg(answer->gradient[c] == 0, "%s: gradient is not 0", name);
}

// --- by hand

START_TEST(a_simplex_moved_along_an_edge_leaves_a_smaller_simplex) {
  for (double t = 1 / 64.0; t < 1; t += 5 / 64.0) {
    double x[24];
    pair_simplices(x, 1, t, 0, 0);
    const Answer answer = ask(models[_i], x);
    ck_assert(ulps_apart(answer.volume, (1 - t) * (1 - t) * (1 - t) / 6) <= 1);
    ck_assert_near(slope(&answer, 0), -(1 - t) * (1 - t) / 2, 1e-15);
    // The faces y = 0 and z = 0 coincide: the mean of moving in and moving out.
    ck_assert_near(slope(&answer, 1), -(1 - t) * (1 - t) / 2 + (1 - t) * (1 - t) / 4, 1e-15);
  }
}
END_TEST

START_TEST(a_simplex_moved_along_the_diagonal_leaves_a_smaller_simplex) {
  double x[24];
  pair_simplices(x, 1, 0.125, 0.125, 0.125);
  const Answer answer = ask(models[_i], x);
  ck_assert(ulps_apart(answer.volume, 0.625 * 0.625 * 0.625 / 6) <= 1);
  for (int axis = 0; axis < 3; axis++) ck_assert_near(slope(&answer, axis), -0.625 * 0.625 / 2, 1e-15);
}
END_TEST

// { x ≥ 0, Σ x ≤ 1 } and { x ≤ h, Σ x ≥ 3h − 1 } share the cube [0, h]³ if h ≤ 1/3.
START_TEST(opposed_corners_share_a_cube_down_to_any_size) {
  for (int power = 2; power <= 300; power += power < 8 ? 1 : 37) {
    const double h = ldexp(1, -power);
    double x[24];
    memcpy(x, simplex, sizeof simplex);
    for (int c = 0; c < 12; c++) x[12 + c] = (power <= 50 ? h : 0) - simplex[c];
    if (power > 50) // 1 − h is 1: begin at the corner and take the edges along the axes shorter
      for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) x[12 + 3 * i + c] = h - 4 * h * simplex[3 * i + c];
    const Answer answer = ask(models[_i], x);
    ck_assert(answer.volume == h * h * h);
    ck_assert_uint_eq(answer.flags, 0);
    for (int axis = 0; axis < 3; axis++) ck_assert(ulps_apart(slope(&answer, axis), h * h) <= 8);
  }
}
END_TEST

START_TEST(a_tetrahedron_inside_counts_whole_and_pushes_nothing) {
  double x[24], own[12];
  pair_simplices(x, 0.25, 0.125, 0.125, 0.125);
  const Answer answer = ask(models[_i], x);
  ck_assert(ulps_apart(answer.volume, 1 / 384.0) <= 1);
  ck_assert_uint_eq(answer.flags, OVERLAP_ENCLOSED);
  differentiate_volume(x + 12, own);
  for (int c = 0; c < 12; c++) ck_assert(answer.gradient[c] == 0);
  ck_assert_near(furthest(answer.gradient + 12, own, 12), 0, 1e-17);
}
END_TEST

START_TEST(identical_tetrahedra_share_the_gradient_half_and_half) {
  const int order[3] = {0, 5, 11}; // as it is, and two that are inside out
  for (int k = 0; k < 3; k++) {
    double x[24], own[12];
    memcpy(x, simplex, sizeof simplex);
    datagen_hard_permute(simplex, order[k], x + 12);
    const Answer answer = ask(models[_i], x);
    ck_assert(ulps_apart(answer.volume, 1 / 6.0) <= 1);
    ck_assert_uint_eq(answer.flags, OVERLAP_ENCLOSED);
    for (int t = 0; t < 2; t++) {
      differentiate_volume(x + 12 * t, own);
      for (int c = 0; c < 12; c++) ck_assert(ulps_apart(answer.gradient[12 * t + c], own[c] / 2) <= 1);
    }
  }
}
END_TEST

START_TEST(touching_is_disjoint) {
  static const double other[][12] = {
      {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1},               // a whole face, back to back
      {0, 0, 0, 2, 0, 0, 0, 3, 0, 1, 1, -1},               // part of a face's plane, back to back
      {0, 0, 0, 1, 0, 0, 0, -1, 0, 0, 0, -1},              // an edge
      {0, 0, 0, -1, 0, 0, 0, -1, 0, 0, 0, -1},             // a vertex
      {.25, .25, 0, 0, 0, -1, 1, 0, -1, 0, 1, -1},         // a vertex on a face
      {.5, 0, 0, 0, -1, -1, 1, -1, -1, 0, -2, -3},         // a vertex on an edge
      {.5, .5, -.5, .5, -.5, .5, 0, -1, -2, 1, -1, -1},    // an edge across the middle of an edge
      {.25, -.25, 0, .25, .25, 0, 1, 0, -1, 0, 0.125, -1}, // an edge in a face
  };
  for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
    double x[24], swapped[24];
    memcpy(x, simplex, sizeof simplex), memcpy(x + 12, other[k], sizeof other[k]);
    overlap_ops_swap(x, swapped);
    Answer answer = ask(models[_i], x);
    assert_nothing(&answer, OVERLAP_DISJOINT, "touching");
    answer = ask(models[_i], swapped);
    assert_nothing(&answer, OVERLAP_DISJOINT, "touching, swapped");
  }
}
END_TEST

START_TEST(no_volume_is_flat) {
  double x[24];
  pair_simplices(x, 1, 0.125, 0.125, 0.125);
  for (int t = 0; t < 2; t++) {
    double flat[24];
    memcpy(flat, x, sizeof flat);
    for (int c = 0; c < 3; c++) flat[12 * t + 9 + c] = (flat[12 * t + 3 + c] + flat[12 * t + 6 + c]) / 2;
    const Answer answer = ask(models[_i], flat);
    assert_nothing(&answer, OVERLAP_FLAT, "flat");
  }
}
END_TEST

// A simplex of size s cut in half by a face of another that is 2^664 times larger: { x ≥ ½ s } leaves s³/48.
START_TEST(sizes_may_differ_by_two_hundred_decades) {
  const double large = 0x1p332, small = 0x1p-332;
  double x[24];
  for (int c = 0; c < 12; c++) {
    x[c] = large * (4 * simplex[c] - (c % 3 ? 1 : 0));
    x[12 + c] = small * (simplex[c] - (c % 3 ? 0 : 0.5));
  }
  const Answer answer = ask(&overlap_exact_ops, x);
  ck_assert(ulps_apart(answer.volume, small * small * small / 48) <= 1);
  ck_assert_uint_eq(answer.flags, 0);
  ck_assert(ulps_apart(slope(&answer, 0), small * small / 8) <= 2);
}
END_TEST

// --- invariants of `exact`, over all classes of pairs

START_TEST(every_class_obeys_the_invariants) {
  int overlapping = 0;
  for (int m = 0; m < 100; m++) {
    const DatagenHardPair pair = datagen_hard_make(_i, m);
    const double *x = pair.x, smaller = overlap_invariant_smaller_volume(x);
    const Answer answer = ask(&overlap_exact_ops, x);
    overlapping += answer.volume > 0;
    ck_assert_msg(overlap_invariant_bounds(x, answer.volume) <= 1e-3 * (smaller < 1e-9) + 1e-13, "%d: V = %g",
                  m, answer.volume);
    ck_assert_near(overlap_invariant_translation(x, answer.gradient), 0, 2e-15);
    ck_assert_near(overlap_invariant_rotation(x, answer.gradient), 0, 4e-15);
    ck_assert_near(overlap_invariant_scaling(x, answer.volume, answer.gradient), 0, 4e-15);
    if (!isnan(pair.volume)) ck_assert_near(answer.volume, pair.volume, pair.slack);
    if (pair.is_flat) assert_nothing(&answer, OVERLAP_FLAT, datagen_hard_classes[_i].name);
    if (!pair.is_flat && answer.volume == 0)
      assert_nothing(&answer, OVERLAP_DISJOINT, datagen_hard_classes[_i].name);
    if (pair.volume > 0) ck_assert(answer.volume > 0);
  }
  if (strcmp(datagen_hard_classes[_i].name, "uniform") == 0) ck_assert_int_ge(overlapping, 30);
}
END_TEST

START_TEST(order_of_tetrahedra_and_vertices_does_not_matter) {
  for (int m = 0; m < 24; m++) {
    const DatagenHardPair pair = datagen_hard_make(_i, m);
    const Answer answer = ask(&overlap_exact_ops, pair.x);
    double swapped[24], moved[24], expected[24];
    overlap_ops_swap(pair.x, swapped);
    datagen_hard_permute(swapped, m, moved);
    datagen_hard_permute(swapped + 12, 23 - m, moved + 12);
    overlap_ops_swap(answer.gradient, swapped);
    datagen_hard_permute(swapped, m, expected);
    datagen_hard_permute(swapped + 12, 23 - m, expected + 12);
    const Answer again = ask(&overlap_exact_ops, moved);
    const double extent = overlap_invariant_extent(pair.x);
    ck_assert(ulps_apart(again.volume, answer.volume) <= 1);
    ck_assert_uint_eq(again.flags, answer.flags);
    ck_assert_near(furthest(again.gradient, expected, 24), 0, 2e-16 * extent * extent);
  }
}
END_TEST

// Powers of two and shifts that the coordinates allow exactly change no bit of the significand.
START_TEST(scaling_by_powers_of_two_and_grid_shifts_change_no_bit) {
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int m = 0; m < 20; m++) {
    const DatagenHardPair pair = datagen_hard_make(_i, m);
    const Answer answer = ask(&overlap_exact_ops, pair.x);
    for (int power = -200; power <= 200; power += 100) {
      double x[24];
      memcpy(x, pair.x, sizeof x);
      datagen_hard_transform(x, 8, identity, ldexp(1, power), (Vec3){0, 0, 0});
      const Answer scaled = ask(&overlap_exact_ops, x);
      ck_assert(scaled.volume == ldexp(answer.volume, 3 * power));
      for (int c = 0; c < 24; c++) ck_assert(scaled.gradient[c] == ldexp(answer.gradient[c], 2 * power));
    }
  }
  for (int m = 0; m < 20; m++) {
    DatagenHardPair pair = {.volume = NAN};
    Random random = random_seeded(7, (uint64_t)m);
    datagen_hard_fat(&random, &pair, 0), datagen_hard_fat(&random, &pair, 1);
    const Answer answer = ask(&overlap_exact_ops, pair.x);
    datagen_hard_transform(pair.x, 8, identity, 1, (Vec3){1e6, -3e6, 12345678});
    const Answer shifted = ask(&overlap_exact_ops, pair.x);
    ck_assert(shifted.volume == answer.volume);
    ck_assert(memcmp(shifted.gradient, answer.gradient, sizeof answer.gradient) == 0);
  }
}
END_TEST

START_TEST(parts_add_up_to_the_whole) {
  const double weights[4] = {0.125, 0.375, 0.25, 0.25}; // exact on the grid
  int overlapping = 0;
  for (int m = 0; m < 200; m++) {
    DatagenHardPair pair = {.volume = NAN};
    Random random = random_seeded(11, (uint64_t)m);
    datagen_hard_fat(&random, &pair, 0), datagen_hard_fat(&random, &pair, 1);
    const double whole = ask(&overlap_exact_ops, pair.x).volume;
    double parts[4][12], sum = 0;
    datagen_hard_subdivide(pair.x + 12, weights, parts);
    for (int part = 0; part < 4; part++) {
      memcpy(pair.x + 12, parts[part], sizeof parts[part]);
      sum += ask(&overlap_exact_ops, pair.x).volume;
    }
    overlapping += whole > 0;
    ck_assert(ulps_apart(sum, whole) <= 6);
  }
  ck_assert_int_ge(overlapping, 100);
}
END_TEST

START_TEST(gradient_is_the_derivative_of_the_volume) {
  int compared = 0;
  for (int k = 0; k < DATAGEN_HARD_CLASS_COUNT; k++)
    for (int m = 0; m < 20; m++) {
      const DatagenHardPair pair = datagen_hard_make(k, m);
      const double extent = overlap_invariant_extent(pair.x), step = extent * 0x1p-20;
      if (!pair.is_smooth) continue;
      const Answer answer = ask(&overlap_exact_ops, pair.x);
      for (int c = 0; c < 24; c++) {
        double up[24], down[24];
        memcpy(up, pair.x, sizeof up), memcpy(down, pair.x, sizeof down);
        up[c] += step, down[c] -= step;
        const double rise = ask(&overlap_exact_ops, up).volume - ask(&overlap_exact_ops, down).volume;
        ck_assert_near(rise / (up[c] - down[c]), answer.gradient[c], 1e-9 * extent * extent);
      }
      compared += answer.volume > 0;
    }
  ck_assert_int_ge(compared, 40);
}
END_TEST

// Every coordinate its own magnitude, denormals and the largest double among them.
START_TEST(scattered_magnitudes_give_numbers) {
  Random random = random_seeded(13, 0);
  int disjoint = 0;
  for (int m = 0; m < 500; m++) {
    double x[24];
    for (int c = 0; c < 24; c++) {
      const int power = random_below(&random, 2) ? random_below(&random, 2090) - 1070 : c % 2 ? 1023 : -1060;
      x[c] = ldexp(random_between(&random, -1, 1), power);
    }
    const Answer answer = ask(&overlap_exact_ops, x);
    ck_assert(answer.volume >= 0);
    for (int c = 0; c < 24; c++) ck_assert(!isnan(answer.gradient[c]));
    disjoint += answer.flags == OVERLAP_DISJOINT;
  }
  ck_assert(disjoint > 50 && disjoint < 450);
}
END_TEST

// --- one against the other

START_TEST(exact_equals_cgal_in_every_class) {
  for (int m = 0; m < 12; m++) {
    const DatagenHardPair pair = datagen_hard_make(_i, m);
    const Answer ours = ask(&overlap_exact_ops, pair.x), theirs = ask(&overlap_cgal_ops, pair.x);
    const double extent = overlap_invariant_extent(pair.x);
    ck_assert_msg(ulps_apart(ours.volume, theirs.volume) <= 1, "member %d: %.17g, %.17g", m, ours.volume,
                  theirs.volume);
    ck_assert_uint_eq(ours.flags, theirs.flags);
    ck_assert_near(furthest(ours.gradient, theirs.gradient, 24), 0, 2e-16 * extent * extent);
  }
}
END_TEST

// --- threads, memory, integers

START_TEST(threads_give_identical_results) {
  enum { MEMBERS = 6, PAIRS = MEMBERS * DATAGEN_HARD_CLASS_COUNT };
  static double x[PAIRS][24], volume[2][PAIRS], gradient[2][PAIRS][24];
  static unsigned flags[2][PAIRS];
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, models[_i]->name));
  for (int k = 0; k < PAIRS; k++) {
    const DatagenHardPair pair =
        datagen_hard_make(k % DATAGEN_HARD_CLASS_COUNT, k / DATAGEN_HARD_CLASS_COUNT);
    memcpy(x[k], pair.x, sizeof x[k]);
  }
  for (int round = 0; round < 2; round++) {
    omp_set_num_threads(round ? 4 : 1);
    const OverlapBatch batch = {.pair_count = PAIRS,
                                .pairs = x[0],
                                .volume = volume[round],
                                .gradient = gradient[round][0],
                                .flags = flags[round]};
    ck_assert_ok(overlap_model_eval(&model, &batch));
  }
  overlap_model_destroy(&model);
  ck_assert(memcmp(volume[0], volume[1], sizeof volume[0]) == 0);
  ck_assert(memcmp(gradient[0], gradient[1], sizeof gradient[0]) == 0);
  ck_assert(memcmp(flags[0], flags[1], sizeof flags[0]) == 0);
}
END_TEST

START_TEST(volume_alone_is_the_same_volume) {
  for (int k = 0; k < DATAGEN_HARD_CLASS_COUNT; k++) {
    const DatagenHardPair pair = datagen_hard_make(k, 3);
    const Answer answer = ask(models[_i], pair.x);
    double volume;
    unsigned flags;
    ck_assert_ok(models[_i]->eval_pair(NULL, pair.x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    ck_assert(volume == answer.volume && flags == answer.flags);
  }
}
END_TEST

START_TEST(integers_are_exact) {
  static mp_limb_t limbs[2000];
  Random random = random_seeded(17, 0);
  for (int round = 0; round < 2000; round++) {
    ExactArena arena = {limbs, limbs + 2000};
    const int spread = round % 2 ? 30 : 1000; // the second terms lie far below the first, or near
    const double x = ldexp(random_between(&random, -1, 1), random_below(&random, spread)),
                 y = ldexp(random_between(&random, -1, 1), -random_below(&random, spread));
    const int exponent = overlap_exact_integer_exponent(x) < overlap_exact_integer_exponent(y)
                             ? overlap_exact_integer_exponent(x)
                             : overlap_exact_integer_exponent(y);
    const ExactInteger a = overlap_exact_integer_from_double(&arena, x, exponent),
                       b = overlap_exact_integer_from_double(&arena, y, exponent);
    ck_assert_int_eq(overlap_exact_integer_sign(a), (x > 0) - (x < 0));
    ck_assert((double)ldexpl(overlap_exact_integer_value(a, 0), exponent) == x);
    ck_assert((double)ldexpl(overlap_exact_integer_value(b, 1), exponent + 64) == y);
    // (a + b)(a − b) = a² − b², and dropping one of the two breaks it
    const ExactInteger product = overlap_exact_integer_mul(&arena, overlap_exact_integer_add(&arena, a, b),
                                                           overlap_exact_integer_sub(&arena, a, b));
    const ExactInteger squares = overlap_exact_integer_minor(&arena, a, a, b, b);
    ck_assert_int_eq(overlap_exact_integer_sign(overlap_exact_integer_sub(&arena, product, squares)), 0);
    const ExactInteger square = overlap_exact_integer_mul(&arena, a, a);
    ck_assert_int_eq(overlap_exact_integer_sign(overlap_exact_integer_sub(&arena, square, squares)), 1);
    const ExactInteger u[3] = {a, b, product}, v[3] = {b, squares, a};
    ExactInteger w[3];
    overlap_exact_integer_cross(&arena, u, v, w);
    ck_assert_int_eq(overlap_exact_integer_sign(overlap_exact_integer_dot(&arena, u, w)), 0);
    ck_assert_int_eq(overlap_exact_integer_sign(overlap_exact_integer_dot(&arena, w, w)), 1);
  }
}
END_TEST

// A number of up to that many limbs, or 0.
static ExactInteger draw(ExactArena *arena, Random *random, int limbs) {
  ExactInteger number = {arena->next, 0};
  for (int k = 0; k < limbs; k++) {
    const double part = ldexp(random_between(random, -1, 1), 64 * k + random_below(random, 64));
    number =
        overlap_exact_integer_add(arena, number, overlap_exact_integer_from_double(arena, trunc(part), 0));
  }
  return random_below(random, 20) ? number : (ExactInteger){arena->next, 0};
}

static bool are_equal(ExactInteger a, ExactInteger b) {
  return overlap_exact_integer_compare(a, b) == 0 && overlap_exact_integer_compare(b, a) == 0 &&
         overlap_exact_integer_sign(a) == overlap_exact_integer_sign(b);
}

// Times 2^640 every number is long.
START_TEST(short_numbers_follow_the_rules_of_long_ones) {
  static mp_limb_t limbs[4000];
  Random random = random_seeded(19, (uint64_t)_i);
  for (int round = 0; round < 3000; round++) {
    ExactArena arena = {limbs, limbs + 4000};
    ExactInteger x[4], y[4], far_x[4], far_y[4];
    const ExactInteger far = overlap_exact_integer_from_double(&arena, 1, -640),
                       twice = overlap_exact_integer_mul(&arena, far, far);
    for (int k = 0; k < 4; k++) {
      x[k] = draw(&arena, &random, 1 + random_below(&random, 1 + _i));
      y[k] = draw(&arena, &random, 1 + random_below(&random, 1 + 2 * _i));
      far_x[k] = overlap_exact_integer_mul(&arena, x[k], far),
      far_y[k] = overlap_exact_integer_mul(&arena, y[k], far);
    }
    ck_assert(are_equal(overlap_exact_integer_mul(&arena, overlap_exact_integer_add(&arena, x[0], x[1]), far),
                        overlap_exact_integer_add(&arena, far_x[0], far_x[1])));
    ck_assert(are_equal(overlap_exact_integer_mul(&arena, overlap_exact_integer_sum(&arena, y), far),
                        overlap_exact_integer_sum(&arena, far_y)));
    ck_assert(are_equal(
        overlap_exact_integer_mul(&arena, overlap_exact_integer_minor(&arena, x[0], x[1], x[2], x[3]), twice),
        overlap_exact_integer_minor(&arena, far_x[0], far_x[1], far_x[2], far_x[3])));
    ck_assert(are_equal(overlap_exact_integer_mul(&arena, overlap_exact_integer_dot(&arena, x, y), twice),
                        overlap_exact_integer_dot(&arena, far_x, far_y)));
    const int order = overlap_exact_integer_compare(x[0], y[0]),
              sign = overlap_exact_integer_sign(overlap_exact_integer_sub(&arena, x[0], y[0]));
    ck_assert_int_eq((order > 0) - (order < 0), sign);
  }
}
END_TEST

typedef struct Corner {
  ExactInteger coordinate[3], weight;
} Corner;

static Corner draw_corner(ExactArena *arena, Random *random, int limbs) {
  Corner corner = {.weight = {arena->next, 0}};
  for (int c = 0; c < 3; c++) {
    const ExactInteger number = draw(arena, random, limbs);
    corner.coordinate[c] = overlap_exact_integer_signed(number, overlap_exact_integer_sign(number));
    corner.weight = overlap_exact_integer_add(arena, corner.weight, corner.coordinate[c]);
  }
  return corner;
}

// The second corner moved towards the first until the triangle is as thin as 2^−depth.
static void approach(ExactArena *arena, const Corner *first, Corner *second, int depth) {
  const ExactInteger large = overlap_exact_integer_from_double(arena, 1, -depth);
  for (int c = 0; c < 3; c++)
    second->coordinate[c] = overlap_exact_integer_add(
        arena, overlap_exact_integer_mul(arena, first->coordinate[c], large), second->coordinate[c]);
  second->weight = overlap_exact_integer_add(arena, overlap_exact_integer_mul(arena, first->weight, large),
                                             second->weight);
}

START_TEST(fixed_points_are_right_wherever_they_say_so) {
  static mp_limb_t limbs[4000];
  Random random = random_seeded(23, (uint64_t)_i);
  const int depth = 10 * _i;
  int certain = 0, tried = 0;
  for (int round = 0; round < 1000; round++) {
    ExactArena arena = {limbs, limbs + 4000};
    Corner corners[3];
    ExactFixed fixed[3];
    ExactInteger cross[3];
    for (int k = 0; k < 3; k++)
      corners[k] = draw_corner(&arena, &random, k == 1 ? 1 : 1 + random_below(&random, 5));
    approach(&arena, &corners[0], &corners[1], depth);
    bool is_corner = true;
    for (int k = 0; k < 3; k++) is_corner = is_corner && overlap_exact_integer_sign(corners[k].weight) > 0;
    if (!is_corner) continue;
    long double weights = 1, found, value;
    for (int k = 0; k < 3; k++) {
      fixed[k] = overlap_exact_fixed_from(corners[k].coordinate, corners[k].weight);
      const long double weight = overlap_exact_fixed_weight(corners[k].weight);
      const long double ratio = ldexpl(1, fixed[k].bits);
      ck_assert(weight >= 0.5L && weight <= 1);
      ck_assert(fabsl(overlap_exact_integer_value(corners[k].weight, 0) / ratio - weight) <= 0x1p-62L);
      weights *= ratio;
      for (int c = 0; c < 3; c++) {
        const long double coordinate = overlap_exact_integer_value(corners[k].coordinate[c], 0) / ratio;
        if (overlap_exact_fixed_value(&fixed[k], c, &value))
          ck_assert(fabsl(value - coordinate) <= 0x1p-61L * coordinate);
        else
          ck_assert(coordinate < 0x1p-63L);
      }
    }
    overlap_exact_integer_cross(&arena, corners[1].coordinate, corners[2].coordinate, cross);
    const long double wanted =
        overlap_exact_integer_value(overlap_exact_integer_dot(&arena, corners[0].coordinate, cross), 0) /
        weights;
    tried++;
    if (overlap_exact_fixed_determinant(&fixed[0], &fixed[1], &fixed[2], &found)) {
      ck_assert(fabsl(found - wanted) <= 0x1p-61L * wanted);
      certain++;
    } else {
      ck_assert(wanted < 0x1p-60L); // a turn the wrong way round is not certain either
    }
  }
  ck_assert_int_ge(tried, 800);
  if (_i == 0) ck_assert_int_ge(certain, 50);
  if (depth >= 130) ck_assert_int_eq(certain, 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("overlap_exact");
  tcase_add_loop_test(cases, a_simplex_moved_along_an_edge_leaves_a_smaller_simplex, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, a_simplex_moved_along_the_diagonal_leaves_a_smaller_simplex, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, opposed_corners_share_a_cube_down_to_any_size, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, a_tetrahedron_inside_counts_whole_and_pushes_nothing, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, identical_tetrahedra_share_the_gradient_half_and_half, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, touching_is_disjoint, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, no_volume_is_flat, 0, MODEL_COUNT);
  tcase_add_test(cases, sizes_may_differ_by_two_hundred_decades);
  tcase_add_loop_test(cases, every_class_obeys_the_invariants, 0, DATAGEN_HARD_CLASS_COUNT);
  tcase_add_loop_test(cases, order_of_tetrahedra_and_vertices_does_not_matter, 0, DATAGEN_HARD_CLASS_COUNT);
  tcase_add_loop_test(cases, scaling_by_powers_of_two_and_grid_shifts_change_no_bit, 0,
                      DATAGEN_HARD_CLASS_COUNT);
  tcase_add_test(cases, parts_add_up_to_the_whole);
  tcase_add_test(cases, gradient_is_the_derivative_of_the_volume);
  tcase_add_test(cases, scattered_magnitudes_give_numbers);
  tcase_add_loop_test(cases, exact_equals_cgal_in_every_class, 0, DATAGEN_HARD_CLASS_COUNT);
  tcase_add_loop_test(cases, threads_give_identical_results, 0, MODEL_COUNT);
  tcase_add_loop_test(cases, volume_alone_is_the_same_volume, 0, MODEL_COUNT);
  tcase_add_test(cases, integers_are_exact);
  tcase_add_loop_test(cases, short_numbers_follow_the_rules_of_long_ones, 0, 4);
  tcase_add_loop_test(cases, fixed_points_are_right_wherever_they_say_so, 0, 16);
  return suite_run("overlap_exact", cases, 60);
}
