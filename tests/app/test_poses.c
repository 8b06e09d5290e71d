// SPDX-License-Identifier: GPL-3.0-or-later
// Many poses of a body: volumes that a hand can compute, wrenches against differences of V, the same bits
// from vectors and kernels of every device there is, and files of poses.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/poses/candidates.h"
#include "app/poses/poses.h"
#include "base/memory.h"
#include "fem/model/build.h"
#include "overlap/clip/lanes.h"
#include "scene_text.h"

// A block of 4 × 4 × 4 cubes, 1 m wide, on one of 3 × 3 × 3 that is 2 m wide and begins at z = −2.
static const char text[] =
    "bodies:\n"
    "- {name: upper, mesh: {box: {size: [1, 1, 1], cells: 4}}, place: {translate: [-0.4, -0.3, 0]},\n"
    "   material: {young: 1e5, poisson: 0.3, density: 1000}}\n"
    "- {name: lower, mesh: {box: {size: [2, 2, 2], cells: 3}}, place: {translate: [-1, -1, -2]},\n"
    "   material: {young: 1e5, poisson: 0.3, density: 1000}}\n"
    "time: {end: 1}\n";

static FemSceneDef scene;
static FemModel model;

static void open_model(void) {
  Status status = scene_text_read("test.yaml", text, sizeof text - 1, &scene);
  if (!status) status = fem_model_create(&model, &scene);
  if (!status) return;
  fprintf(stderr, "%s\n", status_message());
  exit(EXIT_FAILURE);
}

static void shift_to(double pose[12], double x, double y, double z) {
  const double moved[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z};
  memcpy(pose, moved, sizeof moved);
}

static AppPosesResult run(int count, double *poses, const Device *device) {
  AppPosesResult result;
  const AppPosesList list = {.count = count, .poses = poses};
  ck_assert_ok(app_poses_run(&result, &model, 0, &list, device));
  return result;
}

START_TEST(blocks_overlap_as_a_hand_computes) {
  double poses[3 * 12];
  shift_to(poses, 0, 0, 0.5);
  shift_to(poses + 12, 0.01, -0.02, -0.2);
  shift_to(poses + 24, 0, 0, -1.5);
  AppPosesResult result = run(3, poses, NULL);
  ck_assert(result.sums[0] == 0); // 0.5 m above
  for (int k = 1; k < 7; k++) ck_assert(result.sums[k] == 0);
  ck_assert_near(result.sums[7], 0.2, 1e-12); // 1 m² by 0.2 m
  // V grows as it sinks: f = −∂V/∂t points up, 1 m² of area; no more in the other directions
  ck_assert_near(result.sums[8], 0, 1e-12);
  ck_assert_near(result.sums[9], 0, 1e-12);
  ck_assert_near(result.sums[10], 1, 1e-12);
  for (int k = 11; k < 14; k++) ck_assert_near(result.sums[k], 0, 1e-12); // through the centre
  ck_assert_near(result.sums[14], 1, 1e-12);                              // wholly inside
  for (int k = 15; k < 21; k++) ck_assert_near(result.sums[k], 0, 1e-12);
  app_poses_destroy(&result);
}
END_TEST

START_TEST(far_from_all_there_is_no_pair_and_no_volume) {
  double poses[12];
  shift_to(poses, 0, 0, 50);
  AppPosesResult result = run(1, poses, NULL);
  ck_assert_int_eq(result.pair_count, 0);
  for (int k = 0; k < 7; k++) ck_assert(result.sums[k] == 0);
  app_poses_destroy(&result);
}
END_TEST

// A turn about an axis through the moved centre, after `pose`.
static void turn_further(const double pose[12], const double centre[3], int axis, double angle,
                         double turned[12]) {
  double r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, moved[3];
  int d = (axis + 1) % 3, e = (axis + 2) % 3;
  r[3 * d + d] = r[3 * e + e] = cos(angle);
  r[3 * d + e] = -sin(angle), r[3 * e + d] = sin(angle);
  for (int i = 0; i < 3; i++) {
    moved[i] = pose[9 + i];
    for (int k = 0; k < 3; k++) moved[i] += pose[3 * i + k] * centre[k];
  }
  for (int i = 0; i < 3; i++) {
    turned[9 + i] = moved[i];
    for (int j = 0; j < 3; j++) {
      turned[3 * i + j] = 0;
      for (int k = 0; k < 3; k++) turned[3 * i + j] += r[3 * i + k] * pose[3 * k + j];
      turned[9 + i] += r[3 * i + j] * (pose[9 + j] - moved[j]);
    }
  }
}

START_TEST(the_wrench_is_minus_the_slope_of_v) {
  enum { COUNT = 6, STEPS = 12 };
  const double step = 1e-5;
  double centre[3];
  AppPosesList list;
  app_poses_centre(&model, 0, centre);
  ck_assert_ok(app_poses_list_draw(&list, COUNT, 5, centre, 0.2, 0.3));
  for (int i = 0; i < COUNT; i++) list.poses[12 * i + 11] -= 0.4;
  AppPosesResult at = run(COUNT, list.poses, NULL);
  for (int i = 0; i < COUNT; i++) {
    double moved[STEPS * 12];
    const double *pose = list.poses + 12 * i, *sums = at.sums + 7 * i;
    for (int k = 0; k < STEPS; k++) {
      double way = k % 2 ? -step : step;
      memcpy(moved + 12 * k, pose, 12 * sizeof *pose);
      if (k < 6)
        moved[12 * k + 9 + k / 2] += way;
      else
        turn_further(pose, centre, (k - 6) / 2, way, moved + 12 * k);
    }
    AppPosesResult around = run(STEPS, moved, NULL);
    ck_assert_double_gt(sums[0], 0.05);
    for (int k = 0; k < 6; k++) {
      double slope = (around.sums[7 * (2 * k)] - around.sums[7 * (2 * k + 1)]) / (2 * step);
      ck_assert_near(sums[1 + k], -slope,
                     1e-8); // V is smooth to the third order in pieces: step² and rounding/step
    }
    app_poses_destroy(&around);
  }
  app_poses_destroy(&at);
  app_poses_list_destroy(&list);
}
END_TEST

START_TEST(every_device_gives_the_same_bits) {
  static const char *const names[] = {"host", "opencl", "cuda"};
  enum { COUNT = 40 };
  double centre[3];
  Device device;
  AppPosesList list;
  if (device_open(&device, names[_i]) != STATUS_OK) {
    suite_skip("%s: %s", names[_i], status_message());
    return;
  }
  app_poses_centre(&model, 0, centre);
  ck_assert_ok(app_poses_list_draw(&list, COUNT, 7, centre, 0.3, 0.2));
  for (int i = 0; i < COUNT; i++) list.poses[12 * i + 11] -= 0.3;
  // faces in one plane: doubtful pairs, left to the processor
  shift_to(list.poses, 0.4, 0.3, -1);
  AppPosesResult vectors = run(COUNT, list.poses, NULL), kernels = run(COUNT, list.poses, &device);
  if (overlap_clip_lanes())
    ck_assert_mem_eq(vectors.sums, kernels.sums, COUNT * 7 * sizeof(double));
  else
    suite_skip("%s: without vector lanes this processor clips in another order", names[_i]);
  ck_assert_int_gt(kernels.handed_on, 100);
  ck_assert_int_gt(kernels.pair_count, 10000);
  app_poses_destroy(&vectors), app_poses_destroy(&kernels);
  app_poses_list_destroy(&list);
  device_close(&device);
}
END_TEST

START_TEST(no_pair_that_overlaps_is_left_out) {
  enum { COUNT = 5 };
  double centre[3];
  AppPosesList list;
  app_poses_centre(&model, 0, centre);
  ck_assert_ok(app_poses_list_draw(&list, COUNT, 9, centre, 0.5, 3));
  AppPosesResult some = run(COUNT, list.poses, NULL);
  // all pairs there are
  const FemModelBody *body = &model.bodies[0];
  const DevicePosesDef def = {.vertex_count = model.vertex_count,
                              .tet_count = model.tet_count,
                              .positions = model.rest,
                              .tets = (const int(*)[4])model.tets,
                              .centre = {centre[0], centre[1], centre[2]}};
  int own = body->tet_end - body->tet_begin, others = model.tet_count - own, count = 0;
  int(*pairs)[2] = memory_zeroed((size_t)own * (size_t)others, sizeof *pairs);
  for (int a = body->tet_begin; a < body->tet_end; a++)
    for (int b = body->tet_end; b < model.tet_count; b++) pairs[count][0] = a, pairs[count++][1] = b;
  DevicePoses all;
  double sums[COUNT * 7];
  ck_assert_ok(device_poses_create(&all, NULL, &def));
  ck_assert_ok(device_poses_set_pairs(&all, count, (const int(*)[2])pairs));
  ck_assert_ok(device_poses_run(&all, COUNT, list.poses, sums));
  double largest = 0;
  for (int k = 0; k < COUNT * 7; k++) {
    ck_assert_near(some.sums[k], sums[k], 1e-13); // in another order
    largest = suite_larger(largest, fabs(sums[k]));
  }
  ck_assert_double_gt(largest, 0.1);
  device_poses_destroy(&all);
  memory_free(pairs);
  app_poses_destroy(&some);
  app_poses_list_destroy(&list);
}
END_TEST

typedef struct File {
  const char *text, *word; // word: of the message
} File;

START_TEST(files_of_poses_are_read_or_refused) {
  static const File files[] = {
      {"1 0 0 0 1 0 0 0 1 0 0 0\n# a word\n1,0,0, 0,1,0, 0,0,1, 1e-3,-2,0 # why\n", NULL},
      {"\xef\xbb\xbf"
       "1 0 0 0 1 0 0 0 1 0 0 0\n1 0 0 0 1 0 0 0 1 1e-3 -2 0",
       NULL},
      {"1 0 0 0 1 0 0 0 1 0 0\n", "line 1: a pose is 12 numbers"},
      {"\n1 0 0 0 1 0 0 0 1 0 0 0 0\n", "line 2: a pose is 12 numbers"},
      {"1 0 0 0 1 0 0 0 1 0 0 x\n", "something else"},
      {"1 0 0 0 1 0 0 0 1 0 0 nan\n", "number 12 must be finite"},
      {"1 0 0 0 1 0 0 0 -1 0 0 0\n", "not a rotation"},
      {"1 0 0 0 1 0 0 0 2 0 0 0\n", "not a rotation"},
      {"# nothing\n", "no poses"}};
  char path[] = "/tmp/tetlap-poses-XXXXXX";
  int descriptor = mkstemp(path);
  ck_assert_int_ge(descriptor, 0);
  FILE *stream = fdopen(descriptor, "w");
  fputs(files[_i].text, stream);
  fclose(stream);
  AppPosesList list;
  Status status = app_poses_list_read(&list, path);
  unlink(path);
  ck_assert_int_eq(status, files[_i].word ? STATUS_INPUT : STATUS_OK);
  if (files[_i].word) {
    ck_assert_msg(strstr(status_message(), files[_i].word) != NULL, "%s", status_message());
    return;
  }
  ck_assert_int_eq(list.count, 2);
  ck_assert(list.poses[12 + 9] == 1e-3 && list.poses[12 + 10] == -2 && list.poses[11] == 0);
  app_poses_list_destroy(&list);
}
END_TEST

int main(void) {
  setenv("CK_FORK", "no", 1); // a driver's threads do not survive a fork
  open_model();
  TCase *cases = tcase_create("poses");
  tcase_add_test(cases, blocks_overlap_as_a_hand_computes);
  tcase_add_test(cases, far_from_all_there_is_no_pair_and_no_volume);
  tcase_add_test(cases, the_wrench_is_minus_the_slope_of_v);
  tcase_add_loop_test(cases, every_device_gives_the_same_bits, 0, 3);
  tcase_add_test(cases, no_pair_that_overlaps_is_left_out);
  tcase_add_loop_test(cases, files_of_poses_are_read_or_refused, 0, 9);
  int result = suite_run("poses", cases, 300);
  fem_model_destroy(&model);
  fem_scene_destroy(&scene);
  return result;
}
