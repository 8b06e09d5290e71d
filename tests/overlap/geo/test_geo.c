// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap model `geo` before any network: the analytic centre, the frame, the features, and how each of
// them changes with the coordinates.
#include "packs.h"
#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "datagen/hard.h"
#include "overlap/geo/centre.h"
#include "overlap/geo/features/features.h"
#include "overlap/geo/frame.h"
#include "overlap/model.h"
#include "overlap/pair/invariant.h"

static const double corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const int set_sizes[] = {36, 56, 70, 100, 120};

// The frame of the first members of a class that have one; false at the end of the class.
static bool next_frame(int class_index, int *member, DatagenHardPair *pair, OverlapGeoFrame *frame) {
  for (; *member < 200; (*member)++) {
    *pair = datagen_hard_make(class_index, *member);
    if (overlap_geo_frame(frame, pair->x) != OVERLAP_GEO_INSIDE) continue;
    (*member)++;
    return true;
  }
  return false;
}

static int class_named(const char *name) {
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++)
    if (strcmp(datagen_hard_classes[c].name, name) == 0) return c;
  ck_abort_msg("no class '%s'", name);
}

START_TEST(a_simplex_has_its_centroid_in_the_middle) {
  double x[24];
  memcpy(x, corner, sizeof corner);
  for (int i = 0; i < 12; i++)
    x[12 + i] = 0.25 + 1e4 * (corner[i] - 0.25); // the planes of the other far away
  OverlapGeoFrame frame;
  ck_assert_int_eq(overlap_geo_frame(&frame, x), OVERLAP_GEO_INSIDE);
  GeoMatrix onset;
  overlap_geo_frame_onset(&onset);
  ck_assert(frame.is_enclosed);
  ck_assert_near(frame.volume * 1.28, 1.0 / 6, 1e-7);
  for (int k = 0; k < 8; k++) {
    ck_assert_near(frame.slack[k], 0.25, 1e-7);
    for (int l = 0; l < 8; l++) ck_assert_near(frame.projector.row[k][l], onset.row[k][l], 2e-4);
  }
}
END_TEST

START_TEST(of_two_equal_tetrahedra_every_plane_counts_half) {
  double x[24];
  memcpy(x, corner, sizeof corner), memcpy(x + 12, corner, sizeof corner);
  OverlapGeoFrame frame;
  ck_assert_int_eq(overlap_geo_frame(&frame, x), OVERLAP_GEO_INSIDE);
  for (int k = 0; k < 8; k++) {
    ck_assert_near(frame.slack[k], 0.25, 1e-15);
    for (int l = 0; l < 8; l++)
      ck_assert_near(frame.projector.row[k][l], ((k % 4 == l % 4) - 0.25) / 2, 1e-15);
  }
  ck_assert_near(frame.volume, 100.0 / 6 / (128 * sqrt(8)), 1e-15);
}
END_TEST

// Scaled planes sum to zero, slacks are barycentric coordinates of one point, P is a projector of rank 3.
START_TEST(at_the_centre_the_logarithms_of_the_slacks_are_stationary) {
  int seen = 0;
  for (int c = 0; c < DATAGEN_HARD_CLASS_COUNT; c++) {
    DatagenHardPair pair;
    OverlapGeoFrame frame;
    for (int member = 0; next_frame(c, &member, &pair, &frame); seen++) {
      double least = INFINITY, trace = 0;
      for (int k = 0; k < 8; k++) least = fmin(least, frame.slack[k]);
      Vec3 point[2] = {{0, 0, 0}, {0, 0, 0}};
      for (int k = 0; k < 8; k++) {
        trace += frame.projector.row[k][k];
        point[k / 4] = vec3_add(
            point[k / 4], vec3_scale(frame.slack[k], vec3_sub(vec3_at(pair.x + 3 * k), vec3_at(pair.x))));
        double row = 0, square = 0;
        for (int l = 0; l < 8; l++) {
          row += frame.projector.row[k][l];
          square += frame.projector.row[k][l] * frame.projector.row[k][l];
        }
        ck_assert_near(row, 0, 1e-15 / least + 1e-13);
        ck_assert_near(square, frame.projector.row[k][k], 1e-14);
      }
      ck_assert_msg(least > 0, "%s: a slack of %g", datagen_hard_classes[c].name, least);
      ck_assert_near(trace, 3, 1e-14);
      ck_assert_int_le(frame.step_count, 12);
      ck_assert_near(vec3_length(vec3_sub(point[0], point[1])) / overlap_invariant_extent(pair.x), 0, 1e-12);
    }
  }
  ck_assert_int_gt(seen, 2000);
}
END_TEST

// A thin or tiny overlap, down to V/v of 1e-18.
START_TEST(newton_finds_the_centre_of_the_smallest_overlaps) {
  Random random = random_seeded(5, 0);
  int most = 0, total = 0;
  for (int trial = 0; trial < 2000; trial++) {
    DatagenHardPair pair = datagen_hard_make(class_named("vertex on face"), trial);
    Vec3 n = datagen_hard_face_normal(&pair, 0);
    double depth = pow(10, random_between(&random, -6, -1));
    for (int i = 4; i < 8; i++)
      datagen_hard_set(&pair, i,
                       vec3_sub(datagen_hard_vertex(&pair, i), vec3_scale(depth / vec3_length(n), n)));
    OverlapGeoFrame frame;
    ck_assert_int_eq(overlap_geo_frame(&frame, pair.x), OVERLAP_GEO_INSIDE);
    if (frame.step_count > most) most = frame.step_count;
    total += frame.step_count;
  }
  ck_assert_int_le(most, 10);
  ck_assert_int_le(total, 6 * 2000);
}
END_TEST

static void map_affinely(const double map[12], const double x[24], double image[24]) {
  for (int i = 0; i < 24; i++) {
    const double *row = map + 4 * (i % 3), *p = x + i - i % 3;
    image[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
}

START_TEST(an_affine_map_changes_neither_slacks_nor_projector) {
  Random random = random_seeded(6, 0);
  DatagenHardPair pair;
  OverlapGeoFrame frame, image;
  int seen = 0;
  for (int member = 0; next_frame(class_named("uniform"), &member, &pair, &frame); seen++) {
    double map[12], x[24];
    for (int i = 0; i < 12; i++) map[i] = random_between(&random, -1, 1) + 2 * (i % 5 == 0);
    map_affinely(map, pair.x, x);
    double det = vec3_det4((Vec3){0, 0, 0}, (Vec3){map[0], map[4], map[8]}, (Vec3){map[1], map[5], map[9]},
                           (Vec3){map[2], map[6], map[10]});
    if (fabs(det) < 0.5) continue;
    ck_assert_int_eq(overlap_geo_frame(&image, x), OVERLAP_GEO_INSIDE);
    double allowed = 1e-11 * frame.step_count;
    for (int k = 0; k < 8; k++) ck_assert_near(frame.slack[k], image.slack[k], allowed);
    for (int k = 0; k < 64; k++)
      ck_assert_near((&frame.projector.row[0][0])[k], (&image.projector.row[0][0])[k], allowed);
    ck_assert_near(image.volume / frame.volume / fabs(det), 1, allowed);
  }
  ck_assert_int_gt(seen, 30);
}
END_TEST

// One P, alone in the last lane of a pack.
enum { LANE = GEO_PACK - 1 };

static void find_features(const OverlapGeoKernel *kernel, const OverlapGeoFeatureSet *set, const GeoMatrix *p,
                          OverlapGeoInvariants *invariants, double *features) {
  GeoSymmetric packed = {{{0}}};
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES];
  geo_pack_matrix(p, LANE, &packed);
  kernel->features(set, &packed, invariants, packs);
  geo_unpack_numbers(packs, set->count, LANE, features);
}

static void push_features(const OverlapGeoKernel *kernel, const OverlapGeoFeatureSet *set,
                          const OverlapGeoInvariants *invariants, const GeoMatrix *projector_change,
                          OverlapGeoInvariants *change, double *features_change) {
  GeoSymmetric packed = {{{0}}};
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES];
  geo_pack_matrix(projector_change, LANE, &packed);
  kernel->push(set, invariants, &packed, change, packs);
  geo_unpack_numbers(packs, set->count, LANE, features_change);
}

static void pull_features(const OverlapGeoKernel *kernel, const OverlapGeoFeatureSet *set,
                          const OverlapGeoInvariants *invariants, const double *weights,
                          OverlapGeoSweep *sweep, GeoMatrix *slope) {
  GeoSymmetric packed;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES] = {{0}};
  packs_put_numbers(weights, set->count, LANE, packs);
  kernel->pull(set, invariants, packs, sweep, &packed);
  packs_take_matrix(&packed, LANE, slope);
}

static void bend_features(const OverlapGeoKernel *kernel, const OverlapGeoFeatureSet *set,
                          const OverlapGeoInvariants *invariants, const double *weights,
                          const OverlapGeoSweep *sweep, const OverlapGeoInvariants *change,
                          GeoMatrix *slope_change) {
  GeoSymmetric packed;
  GeoPack packs[OVERLAP_GEO_MAX_FEATURES] = {{0}};
  packs_put_numbers(weights, set->count, LANE, packs);
  kernel->bend(set, invariants, packs, sweep, change, &packed);
  packs_take_matrix(&packed, LANE, slope_change);
}

static void features_of(int count, const double x[24], double *features) {
  OverlapGeoFrame frame;
  OverlapGeoInvariants invariants;
  ck_assert_int_eq(overlap_geo_frame(&frame, x), OVERLAP_GEO_INSIDE);
  find_features(overlap_geo_features_kernel(), overlap_geo_features_set(count), &frame.projector, &invariants,
                features);
}

// The features of the header's definition, by plain loops in their order.
static int define_features(const OverlapGeoFeatureSet *set, const GeoMatrix *p, double *f) {
  int n_features = 0;
  for (int k = 2; k <= 5; k++) {
    f[n_features] = 0;
    for (int i = 0; i < 8; i++) f[n_features] += pow(p->row[i][i], k);
    n_features++;
  }
  for (int n = 1; n <= set->power_count; n++)
    for (int a = n <= 2 ? 1 : 0; a <= 3; a++)
      for (int b = a; b <= 3; b++, n_features++) {
        f[n_features] = 0;
        for (int i = 0; i < 8; i++)
          for (int j = 0; j < 8; j++)
            f[n_features] += pow(p->row[i][i], a) * pow(p->row[j][j], b) * pow(p->row[i][j], n);
      }
  double link[4][8][8];
  for (int e = 0; e < set->link_count; e++)
    for (int i = 0; i < 8; i++)
      for (int j = 0; j < 8; j++) {
        link[e][i][j] = 0;
        for (int k = 0; k < 8; k++)
          link[e][i][j] +=
              pow(p->row[k][k], set->links[e].degree) * pow(p->row[i][k] * p->row[j][k], set->links[e].power);
      }
  for (int e = 0; e < set->link_count; e++)
    for (int a = 1; a <= 3; a++)
      for (int rs = e == 0 || e == 2 ? a == 1 : 0; rs < 3; rs++, n_features++) { // links 0 and 2 have b = 1
        f[n_features] = 0;
        for (int i = 0; i < 8; i++)
          for (int j = 0; j < 8; j++)
            f[n_features] +=
                pow(p->row[i][i], rs == 2) * pow(p->row[j][j], rs > 0) * link[e][i][j] * pow(p->row[i][j], a);
      }
  for (int e = 0; e < set->link_count && set->has_squares; e++)
    for (int g = 0; g <= e; g++)
      for (int a = 0; a <= 2; a++, n_features++) {
        f[n_features] = 0;
        for (int i = 0; i < 8; i++)
          for (int j = 0; j < 8; j++) f[n_features] += link[e][i][j] * link[g][i][j] * pow(p->row[i][j], a);
      }
  return n_features;
}

START_TEST(features_are_what_the_header_says) {
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i]);
  ck_assert_ptr_nonnull(set);
  ck_assert_ptr_null(overlap_geo_features_set(37));
  DatagenHardPair pair;
  OverlapGeoFrame frame;
  int seen = 0;
  for (int member = 0; next_frame(class_named("uniform"), &member, &pair, &frame); seen++) {
    double expected[OVERLAP_GEO_MAX_FEATURES], features[OVERLAP_GEO_MAX_FEATURES];
    OverlapGeoInvariants invariants;
    ck_assert_int_eq(define_features(set, &frame.projector, expected), set->count);
    find_features(overlap_geo_features_kernel(), set, &frame.projector, &invariants, features);
    for (int f = 0; f < set->count; f++) ck_assert_near(features[f], expected[f], 1e-14 * (1 + expected[f]));
  }
  ck_assert_int_gt(seen, 30);
}
END_TEST

START_TEST(no_order_of_vertices_or_tetrahedra_changes_a_feature) {
  DatagenHardPair pair;
  OverlapGeoFrame frame;
  int count = set_sizes[_i], seen = 0;
  for (int member = 0; next_frame(class_named("uniform"), &member, &pair, &frame) && seen < 40; seen++)
    for (int k = 0; k < 24; k++) {
      double permuted[24], swapped[24], one[OVERLAP_GEO_MAX_FEATURES], other[OVERLAP_GEO_MAX_FEATURES];
      datagen_hard_permute(pair.x, k, permuted);
      datagen_hard_permute(pair.x + 12, (7 * k + 5) % 24, permuted + 12);
      overlap_ops_swap(permuted, swapped);
      features_of(count, pair.x, one);
      features_of(count, swapped, other);
      for (int f = 0; f < count; f++) ck_assert_near(one[f], other[f], 1e-12);
    }
}
END_TEST

// Along random directions, against central differences.
START_TEST(the_changes_of_frame_and_features_are_their_derivatives) {
  Random random = random_seeded(8, 0);
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i]);
  DatagenHardPair pair;
  OverlapGeoFrame frame, up, down;
  for (int member = 0, seen = 0; next_frame(class_named("uniform"), &member, &pair, &frame); seen++) {
    double h = 1e-6 * cbrt(frame.volume), direction[24], x[24];
    for (int i = 0; i < 24; i++) x[i] = pair.x[i] + h * (direction[i] = suite_normal(&random));
    ck_assert_int_eq(overlap_geo_frame(&up, x), OVERLAP_GEO_INSIDE);
    for (int i = 0; i < 24; i++) x[i] = pair.x[i] - h * direction[i];
    ck_assert_int_eq(overlap_geo_frame(&down, x), OVERLAP_GEO_INSIDE);
    OverlapGeoTangent tangent;
    overlap_geo_frame_push(&frame, direction, &tangent);
    double scale = 1 / cbrt(frame.volume), allowed = 1e-6 * scale;
    ck_assert_near((log(up.volume) - log(down.volume)) / (2 * h), tangent.log_volume, allowed);
    for (int k = 0; k < 8; k++)
      ck_assert_near(log(up.slack[k] / down.slack[k]) / (2 * h), tangent.rate[k], allowed);
    for (int k = 0; k < 64; k++)
      ck_assert_near(((&up.projector.row[0][0])[k] - (&down.projector.row[0][0])[k]) / (2 * h),
                     (&tangent.projector.row[0][0])[k], allowed);

    double f[OVERLAP_GEO_MAX_FEATURES], plus[OVERLAP_GEO_MAX_FEATURES], minus[OVERLAP_GEO_MAX_FEATURES];
    double change[OVERLAP_GEO_MAX_FEATURES];
    OverlapGeoInvariants invariants, other;
    find_features(overlap_geo_features_kernel(), set, &up.projector, &other, plus);
    find_features(overlap_geo_features_kernel(), set, &down.projector, &other, minus);
    find_features(overlap_geo_features_kernel(), set, &frame.projector, &invariants, f);
    push_features(overlap_geo_features_kernel(), set, &invariants, &tangent.projector, &other, change);
    for (int i = 0; i < set->count; i++)
      ck_assert_near((plus[i] - minus[i]) / (2 * h), change[i], 5e-6 * scale * (1 + fabs(f[i])));
  }
}
END_TEST

static void random_matrix(Random *random, GeoMatrix *matrix) {
  for (int i = 0; i < 8; i++)
    for (int j = 0; j <= i; j++) matrix->row[i][j] = matrix->row[j][i] = suite_normal(random);
}

static double inner_product(const GeoMatrix *a, const GeoMatrix *b) {
  double sum = 0;
  for (int i = 0; i < 64; i++) sum += (&a->row[0][0])[i] * (&b->row[0][0])[i];
  return sum;
}

// w·δf = Φ : δP for any symmetric δP, and the change of that: with δ'P, δ'Φ : δP = δ'δ(w·f), which is
// symmetric in δ and δ'. Holds for any P, not only for projectors.
START_TEST(the_backward_sweep_is_the_transpose_and_its_change_is_symmetric) {
  Random random = random_seeded(9, 0);
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i]);
  for (int trial = 0; trial < 50; trial++) {
    GeoMatrix p, direction[2], slope, bent[2];
    double f[OVERLAP_GEO_MAX_FEATURES], w[OVERLAP_GEO_MAX_FEATURES], df[OVERLAP_GEO_MAX_FEATURES];
    random_matrix(&random, &p);
    for (int i = 0; i < 64; i++) (&p.row[0][0])[i] *= 0.3;
    for (int i = 0; i < set->count; i++) w[i] = suite_normal(&random);
    OverlapGeoInvariants invariants, change;
    OverlapGeoSweep sweep;
    find_features(overlap_geo_features_kernel(), set, &p, &invariants, f);
    pull_features(overlap_geo_features_kernel(), set, &invariants, w, &sweep, &slope);
    for (int d = 0; d < 2; d++) {
      random_matrix(&random, &direction[d]);
      push_features(overlap_geo_features_kernel(), set, &invariants, &direction[d], &change, df);
      bend_features(overlap_geo_features_kernel(), set, &invariants, w, &sweep, &change, &bent[d]);
      double sum = 0, size = 0;
      for (int i = 0; i < set->count; i++) sum += w[i] * df[i], size += fabs(w[i] * df[i]);
      ck_assert_near(inner_product(&slope, &direction[d]), sum, 1e-13 * size);
    }
    double one = inner_product(&bent[0], &direction[1]), other = inner_product(&bent[1], &direction[0]);
    ck_assert_near(one, other, 1e-11 * (1 + fabs(one)));
    // against differences of the sweep
    double h = 1e-5;
    GeoMatrix moved = p, plus, minus;
    OverlapGeoSweep unused;
    for (int i = 0; i < 64; i++) (&moved.row[0][0])[i] += h * (&direction[0].row[0][0])[i];
    find_features(overlap_geo_features_kernel(), set, &moved, &change, f);
    pull_features(overlap_geo_features_kernel(), set, &change, w, &unused, &plus);
    for (int i = 0; i < 64; i++) (&moved.row[0][0])[i] -= 2 * h * (&direction[0].row[0][0])[i];
    find_features(overlap_geo_features_kernel(), set, &moved, &change, f);
    pull_features(overlap_geo_features_kernel(), set, &change, w, &unused, &minus);
    double largest = sqrt(inner_product(&bent[0], &bent[0]));
    for (int i = 0; i < 64; i++)
      ck_assert_near(((&plus.row[0][0])[i] - (&minus.row[0][0])[i]) / (2 * h), (&bent[0].row[0][0])[i],
                     1e-7 * largest);
  }
}
END_TEST

// Lanes of eight different pairs, in all operations.
START_TEST(every_kernel_gives_the_same_bits) {
  int kernel_count;
  const OverlapGeoKernel *const *kernels = overlap_geo_features_kernels(&kernel_count);
  const OverlapGeoFeatureSet *set = overlap_geo_features_set(set_sizes[_i]);
  Random random = random_seeded(10, 0);
  for (int trial = 0; trial < 20; trial++) {
    GeoSymmetric p, dp, slope[2], bent[2];
    GeoPack weights[OVERLAP_GEO_MAX_FEATURES], f[2][OVERLAP_GEO_MAX_FEATURES],
        df[2][OVERLAP_GEO_MAX_FEATURES];
    for (int lane = 0; lane < GEO_PACK; lane++) {
      GeoMatrix matrix;
      random_matrix(&random, &matrix);
      geo_pack_matrix(&matrix, lane, &p);
      random_matrix(&random, &matrix);
      geo_pack_matrix(&matrix, lane, &dp);
      for (int i = 0; i < set->count; i++) weights[i][lane] = suite_normal(&random);
    }
    for (int k = 0; k < kernel_count; k++) {
      OverlapGeoInvariants invariants, change;
      OverlapGeoSweep sweep;
      int at = k > 0;
      kernels[k]->features(set, &p, &invariants, f[at]);
      kernels[k]->push(set, &invariants, &dp, &change, df[at]);
      kernels[k]->pull(set, &invariants, weights, &sweep, &slope[at]);
      kernels[k]->bend(set, &invariants, weights, &sweep, &change, &bent[at]);
      if (k == 0) continue;
      ck_assert_mem_eq(f[0], f[1], sizeof *f[0] * (size_t)set->count);
      ck_assert_mem_eq(df[0], df[1], sizeof *df[0] * (size_t)set->count);
      ck_assert_mem_eq(&slope[0], &slope[1], sizeof slope[0]);
      ck_assert_mem_eq(&bent[0], &bent[1], sizeof bent[0]);
    }
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("geo");
  tcase_add_test(cases, a_simplex_has_its_centroid_in_the_middle);
  tcase_add_test(cases, of_two_equal_tetrahedra_every_plane_counts_half);
  tcase_add_test(cases, at_the_centre_the_logarithms_of_the_slacks_are_stationary);
  tcase_add_test(cases, newton_finds_the_centre_of_the_smallest_overlaps);
  tcase_add_test(cases, an_affine_map_changes_neither_slacks_nor_projector);
  tcase_add_loop_test(cases, features_are_what_the_header_says, 0, 5);
  tcase_add_loop_test(cases, no_order_of_vertices_or_tetrahedra_changes_a_feature, 0, 5);
  tcase_add_loop_test(cases, the_changes_of_frame_and_features_are_their_derivatives, 0, 5);
  tcase_add_loop_test(cases, the_backward_sweep_is_the_transpose_and_its_change_is_symmetric, 0, 5);
  tcase_add_loop_test(cases, every_kernel_gives_the_same_bits, 0, 5);
  return suite_run("geo", cases, 60);
}
