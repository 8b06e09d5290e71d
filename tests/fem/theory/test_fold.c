// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in which a body meets itself.
#include "scene.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/search/bounds.h"
#include "fem/model/tolerance.h"
#include "overlap/models.h"

static bool share_vertex(const int a[4], const int b[4]) {
  for (int v = 0; v < 16; v++)
    if (a[v / 4] == b[v % 4]) return true;
  return false;
}

static bool boxes_meet(const SceneRun *run, int frame, const int a[4], const int b[4]) {
  double box_a[6], box_b[6];
  contact_bounds_of_tet(a, scene_position(run, frame, 0), box_a);
  contact_bounds_of_tet(b, scene_position(run, frame, 0), box_b);
  return contact_bounds_distance(box_a, box_b) <= 0;
}

// The volume that elements without a common vertex share at a frame, pair by pair [m³].
static double shared_volume(const SceneRun *run, int frame) {
  const FemModel *model = &run->model;
  OverlapModel clip;
  double sum = 0;
  ck_assert_ok(overlap_models_create(&clip, "clip"));
  for (int i = 0; i < model->tet_count; i++)
    for (int j = i + 1; j < model->tet_count; j++) {
      double x[24], volume;
      const int *tets[2] = {model->tets[i], model->tets[j]};
      if (share_vertex(tets[0], tets[1]) || !boxes_meet(run, frame, tets[0], tets[1])) continue;
      for (int k = 0; k < 8; k++)
        memcpy(x + 3 * k, scene_position(run, frame, tets[k / 4][k % 4]), 3 * sizeof(double));
      ck_assert_ok(
          overlap_model_eval(&clip, &(OverlapBatch){.pair_count = 1, .pairs = x, .volume = &volume}));
      sum += volume;
    }
  overlap_model_destroy(&clip);
  return sum;
}

// The mean of what the floor carries over the last part of the run [N].
static double mean_on_floor(const SceneRun *run, double share) {
  int last = run->result.trajectory.frame_count - 1, first = (int)((1 - share) * last);
  double sum = 0;
  for (int frame = first; frame <= last; frame++) sum += scene_force(run, frame, 1)[2];
  return sum / (last - first + 1);
}

// The fastest vertex over the same part [m/s].
static double fastest(const SceneRun *run, double share) {
  int last = run->result.trajectory.frame_count - 1, first = (int)((1 - share) * last);
  double span = run->result.trajectory.times[last] - run->result.trajectory.times[first], most = 0;
  for (int v = 0; v < run->model.vertex_count; v++)
    most = suite_larger(most, vec3_length(vec3_sub(vec3_at(scene_position(run, last, v)),
                                                   vec3_at(scene_position(run, first, v)))));
  return most / span;
}

START_TEST(a_folded_mat_carries_its_own_upper_half) {
  SceneRun with, without;
  scene_run(&with, "fold", NULL);
  scene_run(&without, "fold", (const char *const[]){"bodies.mat.self_contact=false", NULL});
  int last = with.result.trajectory.frame_count - 1;
  ck_assert_int_eq(with.result.trajectory.interface_count, 2);
  ck_assert_int_eq(without.result.trajectory.interface_count, 1);
  ck_assert_str_eq(with.result.trajectory.interface_names[0], "mat, mat");
  double weight = 9.81 * with.model.bodies[0].mass;
  // Forces balance: what the mat does to itself does not show at the floor. Its weight presses it in by 2e-5
  // m (196 Pa of 1e5 Pa, of elements of 1 cm), less than the default tolerance lets a step be off, with which
  // the force at rest is off by per cents; hence the scene's smaller one.
  ck_assert_double_lt(fastest(&with, 0.2), 2e-3);
  ck_assert_near(mean_on_floor(&with, 0.2), weight, 0.01 * weight);
  // Elements are numbered along the mat: those of the lower half are pressed down by the others.
  ck_assert_double_lt(scene_force(&with, last, 0)[2], -0.05 * weight);
  ck_assert_double_le(scene_gain(&with), 1e-3);
  ck_assert_double_gt(with.result.min_det_F, 0);
  double shared = shared_volume(&with, last), shared_without = shared_volume(&without, last);
  ck_assert_double_gt(shared, 0);
  ck_assert_double_gt(shared_without, 0.05 * with.model.bodies[0].mass / 1000);
  ck_assert_double_lt(shared, 0.02 * shared_without);
  scene_close(&with), scene_close(&without);
}
END_TEST

// Whether a tetrahedron of any frame is turned inside out.
static bool is_inverted(const SceneRun *run, int frame, int tet) {
  const double *x[4];
  for (int v = 0; v < 4; v++) x[v] = scene_position(run, frame, run->model.tets[tet][v]);
  double e[3][3];
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) e[k][c] = x[k + 1][c] - x[0][c];
  double det = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
               e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
               e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
  return !(det > 0);
}

// The hard case is 20 × 20 and turns longer: `tetlap run tests/scenes/mat_twist.yaml --set time.end=3.4`,
// minutes.
// Tolerances of what rubs on itself do not depend on where its friction stands in the scene.
START_TEST(own_friction_of_a_body_with_itself_is_friction_too) {
  const char *const contacts[] = {"contact={friction: 0.5}",
                                  "contact={pairs: [{bodies: [mat, mat], friction: 0.5}]}", "contact={}",
                                  "contact={friction: 0.5, pairs: [{bodies: [mat, mat], friction: 0}]}",
                                  "contact={friction: 0.5, pairs: [{bodies: [mat, floor], friction: 0}]}"};
  double tolerances[5];
  for (int k = 0; k < 5; k++) {
    SceneRun run;
    scene_open(&run, "fold", (const char *const[]){contacts[k], NULL});
    tolerances[k] = fem_model_velocity_tolerance(&run.model);
    scene_close(&run);
  }
  ck_assert_double_eq(tolerances[1], tolerances[0]);
  ck_assert_double_lt(tolerances[2], tolerances[0]);
  ck_assert_double_eq(tolerances[3], tolerances[2]);
  ck_assert_double_eq(tolerances[4], tolerances[0]);
}
END_TEST

START_TEST(a_mat_is_twisted_around_itself) {
  SceneRun run;
  scene_run(&run, "mat_twist", (const char *const[]){"bodies.mat.mesh.box.cells=[10,10,1]", NULL});
  ck_assert_int_gt(run.result.contact.pairs_max, 20);
  ck_assert_double_gt(run.result.min_det_F, 0);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  int last = run.result.trajectory.frame_count - 1;
  for (int i = 0; i < run.model.tet_count; i++) ck_assert(!is_inverted(&run, last, i));
  // The ends are turned by 0.4 π each second: at 2 s by 1.6 π against each other.
  double shared = shared_volume(&run, last);
  ck_assert_double_gt(shared, 0);
  ck_assert_double_lt(shared, 1e-3 * run.model.bodies[0].mass / 1000);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("fold");
  tcase_add_test(cases, a_folded_mat_carries_its_own_upper_half);
  tcase_add_test(cases, own_friction_of_a_body_with_itself_is_friction_too);
  tcase_add_test(cases, a_mat_is_twisted_around_itself);
  return suite_run("fold", cases, 300);
}
