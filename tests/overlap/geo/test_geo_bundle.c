// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap model `geo` in vector lanes: every instruction set against the scalar form.
#include "packs.h"
#include "suite.h"

#include <string.h>

#include "datagen/hard.h"
#include "overlap/geo/bundle/bundle.h"
#include "overlap/geo/coplanar.h"
#include "overlap/geo/frame.h"
#include "overlap/geo/geo.h"
#include "overlap/pair/invariant.h"

enum { COUNT = OVERLAP_GEO_BUNDLE - 3 };

// Pairs of one class after another, from the member that is given.
static void draw_pairs(int member, double *pairs) {
  for (int i = 0; i < COUNT; i++) {
    DatagenHardPair pair =
        datagen_hard_make((i + member) % DATAGEN_HARD_CLASS_COUNT, member + i / DATAGEN_HARD_CLASS_COUNT);
    memcpy(pairs + 24 * i, pair.x, sizeof pair.x);
  }
}

// NULL: this processor has fewer, the portable one at least.
static const OverlapGeoBundleKernel *kernel_number(int index) {
  int count;
  const OverlapGeoBundleKernel *const *kernels = overlap_geo_bundle_kernels(&count);
  ck_assert_int_ge(count, 1);
  if (index < count) return kernels[index];
  suite_skip("kernel %d: this processor has the instructions of %d", index, count);
  return NULL;
}

START_TEST(the_gate_decides_as_the_scalar_one_to_the_bit) {
  const OverlapGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle;
  bundle.has_across = true;
  int inside = 0;
  for (int round = 0; round < 60; round++) {
    draw_pairs(7 * round, pairs);
    kernel->gate(COUNT, pairs, &bundle);
    int at = 0;
    for (int i = 0; i < COUNT; i++) {
      OverlapGeoGate gate;
      OverlapGeoOutcome outcome = overlap_geo_gate(&gate, pairs + 24 * i);
      ck_assert_msg(bundle.outcome[i] == outcome, "%s, round %d, pair %d: %d, scalar %d", kernel->name, round,
                    i, bundle.outcome[i], outcome);
      if (outcome != OVERLAP_GEO_INSIDE) continue;
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
  const OverlapGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle;
  bundle.has_across = true;
  OverlapGeoBlock block;
  int seen = 0;
  for (int round = 0; round < 30; round++) {
    draw_pairs(11 * round, pairs);
    kernel->gate(COUNT, pairs, &bundle);
    for (int at = 0; at < bundle.count; at++) {
      int column = at % OVERLAP_GEO_BLOCK;
      if (column == 0) {
        kernel->frame(&bundle, at, &block);
        for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block.factor[j] = 3;
        kernel->pull(NULL, &block);
      }
      OverlapGeoFrame frame;
      OverlapGeoAdjoint adjoint;
      GeoMatrix slope = {{{0}}};
      OverlapGeoOutcome outcome = overlap_geo_frame(&frame, pairs + 24 * bundle.pair[at]);
      ck_assert_int_eq(block.is_fit[column] > 0, outcome == OVERLAP_GEO_INSIDE);
      if (outcome != OVERLAP_GEO_INSIDE) continue;
      OverlapGeoCoplanar coplanar;
      overlap_geo_coplanar_find(&frame.projector, &coplanar);
      ck_assert_int_eq(block.is_close[column] > 0, coplanar.count > 0);
      overlap_geo_frame_pull(&frame, &slope, 1, &adjoint);
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
  const OverlapGeoBundleKernel *kernel = kernel_number(_i / 5);
  if (!kernel) return;
  static const int set_sizes[] = {36, 56, 70, 100, 120};
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i % 5]);
  const OverlapGeoKernel *one = &overlap_geo_features_kernel_portable;
  Random random = random_seeded(21, 0);
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle;
  bundle.has_across = true;
  OverlapGeoBlock block;
  draw_pairs(5, pairs);
  kernel->gate(COUNT, pairs, &bundle);
  ck_assert_int_gt(bundle.count, OVERLAP_GEO_BLOCK);
  kernel->frame(&bundle, 0, &block);
  kernel->features(set, &block);
  for (int f = 0; f < set->count; f++)
    for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block.weights[f][j] = suite_normal(&random);
  for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block.factor[j] = 1 + j;
  kernel->pull(set, &block);
  for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) {
    OverlapGeoFrame frame;
    OverlapGeoInvariants invariants;
    OverlapGeoSweep sweep;
    OverlapGeoAdjoint adjoint;
    GeoSymmetric projector = {{{0}}}, packed;
    GeoPack features[OVERLAP_GEO_MAX_FEATURES], weights[OVERLAP_GEO_MAX_FEATURES] = {{0}};
    GeoMatrix slope;
    ck_assert_int_eq(overlap_geo_frame(&frame, pairs + 24 * bundle.pair[j]), OVERLAP_GEO_INSIDE);
    geo_pack_matrix(&frame.projector, 0, &projector);
    one->features(set, &projector, &invariants, features);
    for (int f = 0; f < set->count; f++) weights[f][0] = block.weights[f][j];
    one->pull(set, &invariants, weights, &sweep, &packed);
    packs_take_matrix(&packed, 0, &slope);
    overlap_geo_frame_pull(&frame, &slope, 1, &adjoint);
    double largest = 0;
    for (int k = 0; k < 24; k++) largest = fmax(largest, fabs(adjoint.gradient[k]));
    for (int f = 0; f < set->count; f++)
      ck_assert_near(block.features[f][j], features[f][0], 1e-12 * (1 + fabs(features[f][0])));
    for (int k = 0; k < 24; k++)
      ck_assert_near(block.gradient[j][k], (1 + j) * adjoint.gradient[k], 1e-12 * (1 + j) * largest);
  }
}
END_TEST

// Σ_m c_m e_mk by the kernel for single pairs, which lists the planes' features one by one. The coefficients
// are such that some centroids would leave the overlap.
START_TEST(centroids_are_the_scalar_ones) {
  const OverlapGeoBundleKernel *kernel = kernel_number(_i / 5);
  if (!kernel) return;
  static const int set_sizes[] = {36, 56, 70, 100, 120};
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i % 5]);
  int count = overlap_geo_features_plane_count(set), held = 0;
  Random random = random_seeded(22, 0);
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle;
  bundle.has_across = true;
  OverlapGeoBlock block;
  draw_pairs(5, pairs);
  kernel->gate(COUNT, pairs, &bundle);
  kernel->frame(&bundle, 0, &block);
  kernel->features(set, &block);
  for (int m = 0; m < count; m++)
    for (int j = 0; j < OVERLAP_GEO_BLOCK; j++)
      block.outputs[1 + m][j] = suite_normal(&random) * (j % 2 ? 3 : 0.1);
  kernel->centroid(set, &block);
  for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) {
    OverlapGeoFrame frame;
    double features[OVERLAP_GEO_MAX_FEATURES], vectors[OVERLAP_GEO_MAX_PLANE_FEATURES][3], unused[3],
        z[3] = {0};
    const double *pair = pairs + 24 * bundle.pair[j];
    ck_assert_int_eq(overlap_geo_frame(&frame, pair), OVERLAP_GEO_INSIDE);
    ck_assert_int_eq(overlap_geo_features_centroid(set, pair, pair, features, unused, vectors),
                     OVERLAP_GEO_INSIDE);
    for (int m = 0; m < count; m++)
      for (int c = 0; c < 3; c++) z[c] += block.outputs[1 + m][j] * vectors[m][c];
    double change[8], lowest = 0;
    for (int k = 0; k < 8; k++) {
      change[k] = 0;
      for (int c = 0; c < 3; c++) change[k] += frame.basis.column[c][k] * z[c];
      lowest = fmin(lowest, change[k]);
    }
    double scale = lowest < -OVERLAP_GEO_LONGEST_SHIFT ? OVERLAP_GEO_LONGEST_SHIFT / -lowest : 1;
    held += scale < 1;
    for (int k = 0; k < 8; k++)
      ck_assert_near(block.place[k][j], frame.slack[k] * (1 + scale * change[k]), 1e-11 * frame.slack[k]);
  }
  ck_assert_int_ge(held, 1);
}
END_TEST

// ∇² log V at fixed weights along all 24 directions, one at a time.
static void bend_alone(const OverlapGeoFeatureSet *set, const OverlapGeoFrame *frame, const double *weights,
                       double *gradient, double feature_changes[24][OVERLAP_GEO_MAX_FEATURES],
                       double *hessian) {
  const OverlapGeoKernel *one = &overlap_geo_features_kernel_portable;
  OverlapGeoInvariants invariants, change;
  OverlapGeoSweep sweep;
  OverlapGeoAdjoint adjoint;
  GeoSymmetric projector = {{{0}}}, packed;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES], weight_packs[OVERLAP_GEO_MAX_FEATURES] = {{0}};
  GeoMatrix slope;
  geo_pack_matrix(&frame->projector, 0, &projector);
  packs_put_numbers(weights, set->count, 0, weight_packs);
  one->features(set, &projector, &invariants, packs);
  one->pull(set, &invariants, weight_packs, &sweep, &packed);
  packs_take_matrix(&packed, 0, &slope);
  overlap_geo_frame_pull(frame, &slope, 1, &adjoint);
  memcpy(gradient, adjoint.gradient, sizeof adjoint.gradient);
  for (int j = 0; j < 24; j++) {
    double direction[24] = {0}, column[24];
    OverlapGeoTangent tangent;
    GeoMatrix slope_change;
    direction[j] = 1;
    overlap_geo_frame_push(frame, direction, &tangent);
    geo_pack_matrix(&tangent.projector, 0, &projector);
    one->push(set, &invariants, &projector, &change, packs);
    geo_unpack_numbers(packs, set->count, 0, feature_changes[j]);
    one->bend(set, &invariants, weight_packs, &sweep, &change, &packed);
    packs_take_matrix(&packed, 0, &slope_change);
    overlap_geo_frame_bend(frame, &adjoint, &slope, &tangent, &slope_change, column);
    for (int i = 0; i < 24; i++) hessian[24 * i + j] = column[i];
  }
}

static void check_bends(const OverlapGeoFeatureSet *set, const OverlapGeoBlock *block,
                        const OverlapGeoBends *bends, int at, const OverlapGeoFrame *frame) {
  double weights[OVERLAP_GEO_MAX_FEATURES], gradient[24], hessian[576];
  double changes[24][OVERLAP_GEO_MAX_FEATURES], largest = 0;
  for (int f = 0; f < set->count; f++) weights[f] = block->weights[f][at];
  bend_alone(set, frame, weights, gradient, changes, hessian);
  for (int k = 0; k < 576; k++) {
    hessian[k] = block->factor[at] * (hessian[k] + gradient[k / 24] * gradient[k % 24]);
    largest = fmax(largest, fabs(hessian[k]));
  }
  int own = bends->is_second[at] > 0 ? 12 : 0;
  for (int k = 0; k < 24; k++)
    ck_assert_near(bends->gradient[k][at], gradient[(k + own) % 24], 1e-10 * sqrt(largest));
  for (int k = 0; k < 576; k++)
    ck_assert_near(bends->hessian[at][k], hessian[(k / 24 + own) % 24 * 24 + (k % 24 + own) % 24],
                   1e-10 * largest);
  for (int j = 0; j < 12; j++) {
    double most = 1e-3 * sqrt(largest / block->factor[at]);
    for (int f = 0; f < set->count; f++) most = fmax(most, fabs(changes[own + j][f]));
    for (int f = 0; f < set->count; f++)
      ck_assert_near(bends->features[f][1 + j][at], changes[own + j][f], 1e-10 * most);
  }
}

// The changes of features and, with random weights, the Hessian of V. Thin overlaps, where rounding counts by
// their thickness, are left out.
START_TEST(second_derivatives_are_the_scalar_ones) {
  const OverlapGeoBundleKernel *kernel = kernel_number(_i / 5);
  if (!kernel) return;
  static const int set_sizes[] = {36, 56, 70, 100, 120};
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i % 5]);
  Random random = random_seeded(22, 0);
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle;
  bundle.has_across = true;
  OverlapGeoBlock block;
  OverlapGeoBends bends;
  int seen[2] = {0};
  for (int round = 0; round < 10; round++) {
    draw_pairs(5 + 9 * round, pairs);
    kernel->gate(COUNT, pairs, &bundle);
    kernel->frame(&bundle, 0, &block);
    kernel->features(set, &block);
    for (int f = 0; f < set->count; f++)
      for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block.weights[f][j] = suite_normal(&random);
    for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block.factor[j] = 1 + j;
    kernel->bend(set, &bundle, 0, &block, &bends);
    kernel->finish(true, &block, &bends);
    for (int at = 0; at < OVERLAP_GEO_BLOCK; at++) {
      OverlapGeoFrame frame;
      ck_assert_int_eq(overlap_geo_frame(&frame, pairs + 24 * bundle.pair[at]), OVERLAP_GEO_INSIDE);
      double least = 1;
      for (int k = 0; k < 8; k++) least = fmin(least, frame.slack[k]);
      if (least < 1e-3) continue;
      check_bends(set, &block, &bends, at, &frame);
      seen[bends.is_second[at] > 0]++;
    }
  }
  ck_assert_int_gt(seen[0], 20);
  ck_assert_int_gt(seen[1], 20);
}
END_TEST

// The same pairs from another one on, so that each is in another lane beside others.
START_TEST(a_pair_gives_the_same_bits_in_every_lane) {
  const OverlapGeoBundleKernel *kernel = kernel_number(_i);
  if (!kernel) return;
  enum { SKIPPED = 5 };
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(100);
  double pairs[24 * COUNT];
  OverlapGeoBundle bundle[2];
  bundle[0].has_across = bundle[1].has_across = true;
  OverlapGeoBlock block[2];
  OverlapGeoBends bends[2];
  draw_pairs(3, pairs);
  for (int b = 0; b < 2; b++) kernel->gate(COUNT - b * SKIPPED, pairs + b * SKIPPED * 24, &bundle[b]);
  int skipped = bundle[0].count - bundle[1].count;
  ck_assert_int_gt(skipped, 0);
  for (int b = 0; b < 2; b++) {
    kernel->frame(&bundle[b], 0, &block[b]);
    kernel->features(set, &block[b]);
    for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block[b].factor[j] = 1;
    for (int f = 0; f < set->count; f++)
      for (int j = 0; j < OVERLAP_GEO_BLOCK; j++) block[b].weights[f][j] = f % 7 - 3;
    kernel->pull(set, &block[b]);
    kernel->bend(set, &bundle[b], 0, &block[b], &bends[b]);
    kernel->finish(true, &block[b], &bends[b]);
  }
  for (int j = 0; j < OVERLAP_GEO_BLOCK - skipped; j++) {
    ck_assert_int_eq(bundle[0].pair[j + skipped], bundle[1].pair[j] + SKIPPED);
    ck_assert(block[0].volume[j + skipped] == block[1].volume[j]);
    for (int f = 0; f < set->count; f++)
      ck_assert(block[0].features[f][j + skipped] == block[1].features[f][j]);
    ck_assert_mem_eq(block[0].gradient[j + skipped], block[1].gradient[j], sizeof block[0].gradient[j]);
    ck_assert_mem_eq(bends[0].hessian[j + skipped], bends[1].hessian[j], sizeof bends[0].hessian[j]);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo_bundle");
  tcase_add_loop_test(cases, the_gate_decides_as_the_scalar_one_to_the_bit, 0, 3);
  tcase_add_loop_test(cases, frames_and_gradients_are_the_scalar_ones, 0, 3);
  tcase_add_loop_test(cases, features_and_their_gradients_are_the_scalar_ones, 0, 15);
  tcase_add_loop_test(cases, centroids_are_the_scalar_ones, 0, 15);
  tcase_add_loop_test(cases, second_derivatives_are_the_scalar_ones, 0, 15);
  tcase_add_loop_test(cases, a_pair_gives_the_same_bits_in_every_lane, 0, 3);
  return suite_run("geo_bundle", cases, 60);
}
