// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap model `geo` in vector lanes: every instruction set against the scalar form.
#include "suite.h"

#include <string.h>

#include "contact/geo_bundle.h"
#include "contact/geo_coplanar.h"
#include "contact/geo_frame.h"
#include "contact/invariant.h"
#include "datagen/hard.h"

enum { COUNT = CONTACT_GEO_BUNDLE - 3 };

// Pairs of one class after another, from the member that is given.
static void draw_pairs(int member, double *pairs) {
  for (int i = 0; i < COUNT; i++) {
    DatagenHardPair pair =
        datagen_hard_make((i + member) % DATAGEN_HARD_CLASS_COUNT, member + i / DATAGEN_HARD_CLASS_COUNT);
    memcpy(pairs + 24 * i, pair.x, sizeof pair.x);
  }
}

static const ContactGeoBundleKernel *kernel_number(int index) {
  int count;
  const ContactGeoBundleKernel *const *kernels = contact_geo_bundle_kernels(&count);
  return index < count ? kernels[index] : NULL;
}

START_TEST(the_gate_decides_as_the_scalar_one_to_the_bit) {
  const ContactGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  double pairs[24 * COUNT];
  ContactGeoBundle bundle;
  int inside = 0;
  for (int round = 0; round < 60; round++) {
    draw_pairs(7 * round, pairs);
    kernel->gate(COUNT, pairs, &bundle);
    int at = 0;
    for (int i = 0; i < COUNT; i++) {
      ContactGeoGate gate;
      ContactGeoOutcome outcome = contact_geo_gate(&gate, pairs + 24 * i);
      ck_assert_msg(bundle.outcome[i] == outcome, "%s, round %d, pair %d: %d, scalar %d", kernel->name, round,
                    i, bundle.outcome[i], outcome);
      if (outcome != CONTACT_GEO_INSIDE) continue;
      ck_assert_int_eq(bundle.pair[at], i);
      ck_assert(bundle.is_enclosed[at] == gate.is_enclosed);
      ck_assert(bundle.least_volume[at] == gate.least_volume);
      for (int k = 0; k < 8; k++) ck_assert(bundle.slack[k][at] == gate.slack[k]);
      for (int k = 0; k < 24; k++) ck_assert(bundle.normal[k][at] == gate.normal.column[k / 8][k % 8]);
      at++, inside++;
    }
    ck_assert_int_eq(at, bundle.count);
  }
  ck_assert_int_gt(inside, 2000);
}
END_TEST

// Centre, frame and the pull of a slope Φ = 0. Where the overlap is thin rounding counts by its thickness.
START_TEST(frames_and_gradients_are_the_scalar_ones) {
  const ContactGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  double pairs[24 * COUNT];
  ContactGeoBundle bundle;
  ContactGeoBlock block;
  int seen = 0;
  for (int round = 0; round < 30; round++) {
    draw_pairs(11 * round, pairs);
    kernel->gate(COUNT, pairs, &bundle);
    for (int at = 0; at < bundle.count; at++) {
      int column = at % CONTACT_GEO_BLOCK;
      if (column == 0) {
        kernel->frame(&bundle, at, &block);
        for (int j = 0; j < CONTACT_GEO_BLOCK; j++) block.factor[j] = 3;
        kernel->pull(NULL, &block);
      }
      ContactGeoFrame frame;
      ContactGeoAdjoint adjoint;
      GeoMatrix slope = {{{0}}};
      ContactGeoOutcome outcome = contact_geo_frame(&frame, pairs + 24 * bundle.pair[at]);
      ck_assert_int_eq(block.is_fit[column] > 0, outcome == CONTACT_GEO_INSIDE);
      if (outcome != CONTACT_GEO_INSIDE) continue;
      ContactGeoCoplanar coplanar;
      contact_geo_coplanar_find(&frame.projector, &coplanar);
      ck_assert_int_eq(block.is_close[column] > 0, coplanar.count > 0);
      contact_geo_frame_pull(&frame, &slope, &adjoint);
      double largest = 0, least = 1;
      for (int k = 0; k < 24; k++) largest = fmax(largest, fabs(adjoint.gradient[k]));
      for (int k = 0; k < 8; k++) least = fmin(least, frame.slack[k]);
      double allowed = 1e-12 + 1e-15 / least;
      ck_assert_near(block.volume[column] / frame.volume, 1, allowed);
      for (int k = 0; k < 8; k++) ck_assert_near(block.slack[k][column] / frame.slack[k], 1, allowed);
      for (int k = 0; k < 8; k++)
        for (int l = 0; l <= k; l++)
          ck_assert_near(block.projector[geo_entry(k, l)][column], frame.projector.row[k][l], allowed);
      for (int k = 0; k < 24; k++)
        ck_assert_near(block.gradient[column][k], 3 * adjoint.gradient[k], 3 * allowed * largest);
      seen++;
    }
  }
  ck_assert_int_gt(seen, 1000);
}
END_TEST

// Against the kernel for single pairs, by random weights.
START_TEST(features_and_their_gradients_are_the_scalar_ones) {
  const ContactGeoBundleKernel *kernel = kernel_number(_i / 3);
  if (!kernel) return;
  static const int set_sizes[] = {36, 70, 100};
  const ContactGeoFeatureSet *set = contact_geo_feature_set(set_sizes[_i % 3]);
  const ContactGeoKernel *one = &contact_geo_kernel_portable;
  Random random = random_seeded(21, 0);
  double pairs[24 * COUNT];
  ContactGeoBundle bundle;
  ContactGeoBlock block;
  draw_pairs(5, pairs);
  kernel->gate(COUNT, pairs, &bundle);
  ck_assert_int_gt(bundle.count, CONTACT_GEO_BLOCK);
  kernel->frame(&bundle, 0, &block);
  kernel->features(set, &block);
  for (int f = 0; f < set->count; f++)
    for (int j = 0; j < CONTACT_GEO_BLOCK; j++) block.weights[f][j] = random_normal(&random);
  for (int j = 0; j < CONTACT_GEO_BLOCK; j++) block.factor[j] = 1 + j;
  kernel->pull(set, &block);
  for (int j = 0; j < CONTACT_GEO_BLOCK; j++) {
    ContactGeoFrame frame;
    ContactGeoInvariants invariants;
    ContactGeoSweep sweep;
    ContactGeoAdjoint adjoint;
    GeoSymmetric projector = {{{0}}}, packed;
    GeoPack features[CONTACT_GEO_MAX_FEATURES], weights[CONTACT_GEO_MAX_FEATURES] = {{0}};
    GeoMatrix slope;
    ck_assert_int_eq(contact_geo_frame(&frame, pairs + 24 * bundle.pair[j]), CONTACT_GEO_INSIDE);
    geo_pack_matrix(&frame.projector, 0, &projector);
    one->features(set, &projector, &invariants, features);
    for (int f = 0; f < set->count; f++) weights[f][0] = block.weights[f][j];
    one->pull(set, &invariants, weights, &sweep, &packed);
    geo_unpack_matrix(&packed, 0, &slope);
    contact_geo_frame_pull(&frame, &slope, &adjoint);
    double largest = 0;
    for (int k = 0; k < 24; k++) largest = fmax(largest, fabs(adjoint.gradient[k]));
    for (int f = 0; f < set->count; f++)
      ck_assert_near(block.features[f][j], features[f][0], 1e-12 * (1 + fabs(features[f][0])));
    for (int k = 0; k < 24; k++)
      ck_assert_near(block.gradient[j][k], (1 + j) * adjoint.gradient[k], 1e-12 * (1 + j) * largest);
  }
}
END_TEST

// The same pairs from another one on, so that each is in another lane beside others.
START_TEST(a_pair_gives_the_same_bits_in_every_lane) {
  const ContactGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  enum { SKIPPED = 5 };
  const ContactGeoFeatureSet *set = contact_geo_feature_set(100);
  double pairs[24 * COUNT];
  ContactGeoBundle bundle[2];
  ContactGeoBlock block[2];
  draw_pairs(3, pairs);
  for (int b = 0; b < 2; b++) kernel->gate(COUNT - b * SKIPPED, pairs + b * SKIPPED * 24, &bundle[b]);
  int skipped = bundle[0].count - bundle[1].count;
  ck_assert_int_gt(skipped, 0);
  for (int b = 0; b < 2; b++) {
    kernel->frame(&bundle[b], 0, &block[b]);
    kernel->features(set, &block[b]);
    for (int j = 0; j < CONTACT_GEO_BLOCK; j++) block[b].factor[j] = 1;
    for (int f = 0; f < set->count; f++)
      for (int j = 0; j < CONTACT_GEO_BLOCK; j++) block[b].weights[f][j] = f % 7 - 3;
    kernel->pull(set, &block[b]);
  }
  for (int j = 0; j < CONTACT_GEO_BLOCK - skipped; j++) {
    ck_assert_int_eq(bundle[0].pair[j + skipped], bundle[1].pair[j] + SKIPPED);
    ck_assert(block[0].volume[j + skipped] == block[1].volume[j]);
    for (int f = 0; f < set->count; f++)
      ck_assert(block[0].features[f][j + skipped] == block[1].features[f][j]);
    ck_assert_mem_eq(block[0].gradient[j + skipped], block[1].gradient[j], sizeof block[0].gradient[j]);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_bundle");
  tcase_add_loop_test(cases, the_gate_decides_as_the_scalar_one_to_the_bit, 0, 3);
  tcase_add_loop_test(cases, frames_and_gradients_are_the_scalar_ones, 0, 3);
  tcase_add_loop_test(cases, features_and_their_gradients_are_the_scalar_ones, 0, 9);
  tcase_add_loop_test(cases, a_pair_gives_the_same_bits_in_every_lane, 0, 3);
  return suite_run("geo_bundle", cases, 60);
}
