// SPDX-License-Identifier: GPL-3.0-or-later
// Faces in one plane: how `geo` turns to the exact volume there, and what that is for.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "overlap/geo/coplanar.h"
#include "overlap/geo/geo.h"
#include "overlap/models.h"

// The corner tetrahedron 0, e₁, e₂, e₃, and itself moved.
static void corner_pair(const double move[3], double pair[24]) {
  memset(pair, 0, 24 * sizeof *pair);
  for (int t = 0; t < 2; t++)
    for (int v = 1; v < 4; v++) pair[12 * t + 4 * v - 1] = 1;
  for (int i = 0; i < 12; i++) pair[12 + i] += move[i % 3];
}

static OverlapGeoCoplanar find(const double pair[24], OverlapGeoFrame *frame) {
  OverlapGeoCoplanar found;
  ck_assert_int_eq(overlap_geo_frame(frame, pair), OVERLAP_GEO_INSIDE);
  overlap_geo_coplanar_find(&frame->projector, &found);
  return found;
}

START_TEST(a_tetrahedron_and_itself_have_four_common_planes) {
  double pair[24];
  OverlapGeoFrame frame;
  corner_pair((double[3]){0, 0, 0}, pair);
  OverlapGeoCoplanar found = find(pair, &frame);
  ck_assert_int_eq(found.count, 4);
  for (int c = 0; c < 4; c++) {
    ck_assert_int_eq(found.close[c].l, found.close[c].k + 4);
    ck_assert(found.close[c].side == -1);
    ck_assert_near(found.close[c].ratio, 0, 1e-12);
  }
  ck_assert_near(found.share, 1, 1e-12);
}
END_TEST

// Moved by 0.01 along x: of the planes x = 0 and x = 0.01 one is cut off, the faces y = 0 and z = 0 stay.
START_TEST(planes_part_with_their_distance) {
  double pair[24], before = 1;
  OverlapGeoFrame frame;
  const double moves[] = {0.003, 0.01, 0.03};
  for (int m = 0; m < 3; m++) {
    corner_pair((double[3]){moves[m], 0, 0}, pair);
    OverlapGeoCoplanar found = find(pair, &frame);
    double along_x = 0;
    for (int c = 0; c < found.count; c++)
      if (found.close[c].k == 1) along_x = found.close[c].share;
    ck_assert(along_x > 0 && along_x < before);
    ck_assert_near(found.share, 1, 1e-12);
    before = along_x;
  }
}
END_TEST

START_TEST(tetrahedra_at_random_have_no_share_as_a_rule) {
  Random random = random_seeded(3, 0);
  int seen = 0, shared = 0;
  while (seen < 2000) {
    double pair[24];
    for (int i = 0; i < 24; i++) pair[i] = random_uniform(&random);
    OverlapGeoFrame frame;
    if (overlap_geo_frame(&frame, pair) != OVERLAP_GEO_INSIDE) continue;
    OverlapGeoCoplanar found;
    overlap_geo_coplanar_find(&frame.projector, &found);
    seen++, shared += found.share > 0;
  }
  ck_assert_int_gt(shared, 0);
  ck_assert_int_lt(shared, seen / 20);
}
END_TEST

// A model that knows nothing, V = V₀, so that the blend shows; faces nearly in a plane.
static void blend(const double pair[24], double *volume, double gradient[24], double hessian[576]) {
  OverlapGeoModel model;
  unsigned flags;
  ck_assert_ok(overlap_geo_create(&model, NULL));
  OverlapBatch batch = {.pair_count = 1,
                        .pairs = pair,
                        .volume = volume,
                        .gradient = gradient,
                        .hessian = hessian,
                        .flags = &flags};
  ck_assert_ok(overlap_geo_eval(&model, &batch));
  ck_assert_uint_ne(flags & OVERLAP_BLENDED, 0);
}

START_TEST(the_blend_has_the_derivatives_of_its_volume) {
  Random random = random_seeded(5, 0);
  for (int trial = 0; trial < 20; trial++) {
    double pair[24], volume, gradient[24], hessian[576];
    corner_pair((double[3]){0.05, -0.06, 0.04}, pair);
    for (int i = 0; i < 24; i++) pair[i] += 0.01 * suite_normal(&random);
    blend(pair, &volume, gradient, hessian);
    const double h = 1e-6;
    for (int i = 0; i < 24; i++) {
      double x[24], up, down, gradient_up[24], gradient_down[24];
      memcpy(x, pair, sizeof x);
      x[i] = pair[i] + h, blend(x, &up, gradient_up, NULL);
      x[i] = pair[i] - h, blend(x, &down, gradient_down, NULL);
      ck_assert_near((up - down) / (2 * h), gradient[i], 1e-8);
      for (int j = 0; j < 24; j++)
        ck_assert_near((gradient_up[j] - gradient_down[j]) / (2 * h), hessian[24 * i + j], 2e-5);
    }
  }
}
END_TEST

// A cube of six tetrahedra around the diagonal, edge 1, its lowest corner at `at`.
static void cube(const double at[3], double tets[6][12]) {
  static const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int p = 0; p < 6; p++) {
    double corner[3] = {at[0], at[1], at[2]};
    for (int v = 0; v < 4; v++) {
      memcpy(tets[p] + 3 * v, corner, sizeof corner);
      if (v < 3) corner[axes[p][v]]++;
    }
  }
}

// dV/d(motion) of a cube that stands on a floor of 3 × 3 cubes, its diagonal planes x = y apart by `offset`.
static void push_cube(const OverlapModel *model, double depth, double offset, double force[3]) {
  double upper[6][12], lower[6][12], pair[24], volume, gradient[24];
  unsigned flags;
  memset(force, 0, 3 * sizeof *force);
  cube((double[3]){1.3 + offset, 1.3 - offset, 1 - depth}, upper);
  for (int column = 0; column < 9; column++) {
    cube((double[3]){column % 3, column / 3, 0}, lower);
    for (int k = 0; k < 36; k++) {
      memcpy(pair, lower[k / 6], sizeof lower[0]);
      memcpy(pair + 12, upper[k % 6], sizeof upper[0]);
      ck_assert_ok(model->ops->eval_pair(
          model->self, pair, &(OverlapAnswer){.volume = &volume, .gradient = gradient, .flags = &flags}));
      for (int i = 0; i < 12; i++) force[i % 3] += gradient[12 + i];
    }
  }
}

// Inside of the bodies the diagonal planes coincide at offset 0. The true force is (0, 0, −1) at every
// offset.
START_TEST(coinciding_planes_inside_of_bodies_do_not_attract_each_other) {
  const char *names[] = {"geo", "geo-small"};
  OverlapModel model;
  ck_assert_ok(overlap_models_create(&model, names[_i]));
  for (double depth = 0.02; depth < 0.4; depth += 0.14) {
    double before[3], after[3], force[3];
    push_cube(&model, depth, -1e-9, before);
    push_cube(&model, depth, 1e-9, after);
    for (int c = 0; c < 3; c++) ck_assert_near(before[c], after[c], 1e-4);
    for (int step = -8; step <= 8; step++) {
      push_cube(&model, depth, 2e-3 * step, force);
      for (int c = 0; c < 2; c++) ck_assert_near(force[c], 0, 0.03);
      ck_assert_near(force[2], -1, 0.02);
    }
  }
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("geo_coplanar");
  tcase_add_test(tests, a_tetrahedron_and_itself_have_four_common_planes);
  tcase_add_test(tests, planes_part_with_their_distance);
  tcase_add_test(tests, tetrahedra_at_random_have_no_share_as_a_rule);
  tcase_add_test(tests, the_blend_has_the_derivatives_of_its_volume);
  tcase_add_loop_test(tests, coinciding_planes_inside_of_bodies_do_not_attract_each_other, 0, 2);
  return suite_run("geo_coplanar", tests, 60);
}
