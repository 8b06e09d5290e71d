// SPDX-License-Identifier: GPL-3.0-or-later
// What two tetrahedra have in common, proven: cases by hand, invariances, and the exact overlap model as a
// witness.
#include "suite.h"

#include <string.h>

#include "datagen/draw/proof.h"
#include "datagen/hard.h"
#include "overlap/exact/exact.h"
#include "overlap/pair/invariant.h"
#include "overlap/separation.h"

// Against the unit simplex 0, e₁, e₂, e₃.
typedef struct Hand {
  const char *name;
  double second[12];
  int dimension, first_carrier, second_carrier;
} Hand;

static const Hand hands[] = {
    {"far away", {5, 5, 5, 6, 5, 5, 5, 6, 5, 5, 5, 6}, -1, 3, 3},
    {"beside a vertex, boxes overlap", {0.9, 0.9, 0.9, 2, 0.9, 0.9, 0.9, 2, 0.9, 0.9, 0.9, 2}, -1, 3, 3},
    {"an edge passes an edge, no face between them",
     {0.75, 0.25, 1, 0.25, 1, -0.25, 1, 1, 1, 2, 1, 1},
     -1,
     3,
     3},
    {"a common vertex", {0, 0, 0, -1, 0, 0, 0, -1, 0, 0, 0, -1}, 0, 0, 0},
    {"a vertex in an edge", {0.5, 0, 0, 0, -1, -1, 1, -1, -1, 0.5, -1, -2}, 0, 1, 0},
    {"a vertex in a face", {0.25, 0.25, 0, 0, 0, -1, 1, 0, -1, 0, 1, -1}, 0, 2, 0},
    {"crossing edges", {0.5, 1, -1, 0.5, -1, 1, 0.5, -1, -2, 0.25, -2, -1}, 0, 1, 1},
    {"edges along each other", {0.5, 0, 0, 2, 0, 0, 0.5, -1, -1, 0.5, -2, -1}, 1, 1, 1},
    {"an edge in a face", {0.125, 0.125, 0, 0.25, 0.5, 0, 0, 0, -1, 1, 0, -1}, 1, 2, 1},
    {"an edge that sticks out of a face", {0.25, 0.25, 0, 3, 3, 0, 0, 0, -1, 1, 0, -1}, 1, 2, 1},
    {"faces back to back", {0.25, 0.25, 0, 2, 0.25, 0, 0.25, 2, 0, 0, 0, -1}, 2, 2, 2},
    {"a common face", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1}, 2, 2, 2},
    {"coplanar faces that share an edge only", {0, 0, 0, 1, 0, 0, 0, -1, 0, 0, -1, -1}, 1, 1, 1},
    {"coplanar faces that share a point only", {1, 0, 0, 2, 0, 0, 2, 1, 0, 2, 0, -1}, 0, 0, 0},
    {"identical", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 3, 3, 3},
    {"one inside the other", {0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.2}, 3, 3, 3},
    {"inside and touching a face", {0.1, 0.1, 0, 0.2, 0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.2}, 3, 3, 3},
    {"an edge through the middle", {-1, 0.2, 0.2, 2, 0.2, 0.2, 0.5, 3, 3, 0.5, 4, 3}, 3, 3, 3},
    {"an edge of the one pierces a face of the other",
     {0.2, 0.2, -1, 0.2, 0.2, 0.1, 3, 0.2, -1, 0.2, 3, -1},
     3,
     3,
     3},
};
enum { HAND_COUNT = sizeof hands / sizeof *hands };

static void place(const Hand *hand, double pair[24]) {
  static const double simplex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  memcpy(pair, simplex, sizeof simplex);
  memcpy(pair + 12, hand->second, sizeof simplex);
}

START_TEST(pairs_that_a_hand_can_place_are_what_they_seem) {
  const Hand *hand = &hands[_i];
  double pair[24];
  place(hand, pair);
  DatagenProof proof = datagen_proof_of(pair);
  ck_assert_msg(!proof.is_flat && proof.dimension == hand->dimension &&
                    proof.carrier[0] == hand->first_carrier && proof.carrier[1] == hand->second_carrier,
                "%s: dimension %d in faces of dimension %d and %d", hand->name, proof.dimension,
                proof.carrier[0], proof.carrier[1]);
}
END_TEST

static void exchange_points(double *a, double *b, int count) {
  for (int i = 0; i < 3 * count; i++) {
    double x = a[i];
    a[i] = b[i], b[i] = x;
  }
}

START_TEST(neither_the_order_of_vertices_nor_of_tetrahedra_matters) {
  Random random = random_seeded(11, (uint64_t)_i);
  double pair[24];
  place(&hands[_i], pair);
  bool is_swapped = false;
  for (int repeat = 0; repeat < 60; repeat++) {
    int t = random_below(&random, 2);
    exchange_points(pair + 12 * t + 3 * random_below(&random, 4),
                    pair + 12 * t + 3 * random_below(&random, 4), 1);
    if (random_below(&random, 2)) exchange_points(pair, pair + 12, 4), is_swapped = !is_swapped;
    DatagenProof proof = datagen_proof_of(pair);
    ck_assert_int_eq(proof.dimension, hands[_i].dimension);
    ck_assert_int_eq(proof.carrier[is_swapped], hands[_i].first_carrier);
    ck_assert_int_eq(proof.carrier[!is_swapped], hands[_i].second_carrier);
  }
}
END_TEST

// Scaled by a power of two and moved by a whole number: exact.
START_TEST(size_and_place_do_not_matter) {
  double pair[24];
  place(&hands[_i], pair);
  for (int i = 0; i < 24; i++) pair[i] = 0x1p-70 * (pair[i] + 0x1p30);
  ck_assert_int_eq(datagen_proof_of(pair).dimension, hands[_i].dimension);
}
END_TEST

START_TEST(a_tetrahedron_without_volume_is_said_to_be_flat) {
  double pair[24];
  place(&hands[14], pair);
  memcpy(pair + 21, (double[]){0.5, 0.5, 0}, 3 * sizeof *pair);
  DatagenProof proof = datagen_proof_of(pair);
  ck_assert(proof.is_flat);
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) ck_assert(!datagen_proof_confirms(&proof, (DatagenKind)k));
}
END_TEST

// Dimension 3 is what the exact model calls a common interior; beyond a separating axis there is nothing.
START_TEST(the_exact_model_and_the_separating_axes_agree) {
  for (int member = 0; member < 150; member++) {
    DatagenHardPair c = datagen_hard_make(_i, member);
    double volume;
    unsigned flags;
    ck_assert_ok(
        overlap_exact_ops.eval_pair(NULL, c.x, &(OverlapAnswer){.volume = &volume, .flags = &flags}));
    DatagenProof proof = datagen_proof_of(c.x);
    ck_assert_int_eq(proof.is_flat, (flags & OVERLAP_FLAT) != 0);
    if (proof.is_flat) continue;
    ck_assert_msg((proof.dimension < 3) == ((flags & OVERLAP_DISJOINT) != 0), "%s %d: dimension %d",
                  datagen_hard_classes[_i].name, member, proof.dimension);
    double gap = overlap_separation_pair(c.x, INFINITY), extent = overlap_invariant_extent(c.x);
    if (gap > 1e-9 * extent) ck_assert_int_eq(proof.dimension, -1);
    if (gap < -1e-9 * extent) ck_assert_int_eq(proof.dimension, 3);
    if (overlap_separation_is_certain(c.x)) ck_assert_int_eq(proof.dimension, -1);
  }
}
END_TEST

// The touching classes of the overlap models' tests are built on another grid by another hand.
START_TEST(the_touching_classes_of_the_overlap_tests_have_the_dimensions_of_their_names) {
  static const struct {
    const char *name;
    int dimension, first, second;
  } expected[] = {{"vertex on face", 0, 2, 0},   {"edge on face", 1, 2, 1},   {"face on face", 2, 2, 2},
                  {"vertex on vertex", 0, 0, 0}, {"vertex on edge", 0, 1, 0}, {"edge on edge", 0, 1, 1},
                  {"shared edge", 1, 1, 1},      {"shared face", 2, 2, 2},    {"identical", 3, 3, 3}};
  int class_index = 0;
  while (strcmp(datagen_hard_classes[class_index].name, expected[_i].name) != 0) class_index++;
  for (int member = 0; member < 300; member++) {
    DatagenHardPair c = datagen_hard_make(class_index, member);
    DatagenProof proof = datagen_proof_of(c.x);
    ck_assert_msg(proof.dimension == expected[_i].dimension && proof.carrier[0] == expected[_i].first &&
                      proof.carrier[1] == expected[_i].second,
                  "%s %d: dimension %d in faces of dimension %d and %d", expected[_i].name, member,
                  proof.dimension, proof.carrier[0], proof.carrier[1]);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("proof");
  tcase_add_loop_test(cases, pairs_that_a_hand_can_place_are_what_they_seem, 0, HAND_COUNT);
  tcase_add_loop_test(cases, neither_the_order_of_vertices_nor_of_tetrahedra_matters, 0, HAND_COUNT);
  tcase_add_loop_test(cases, size_and_place_do_not_matter, 0, HAND_COUNT);
  tcase_add_test(cases, a_tetrahedron_without_volume_is_said_to_be_flat);
  tcase_add_loop_test(cases, the_exact_model_and_the_separating_axes_agree, 0, DATAGEN_HARD_CLASS_COUNT);
  tcase_add_loop_test(cases, the_touching_classes_of_the_overlap_tests_have_the_dimensions_of_their_names, 0,
                      9);
  return suite_run("datagen_proof", cases, 60);
}
