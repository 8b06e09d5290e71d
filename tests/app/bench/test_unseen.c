// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench unseen`: bodies that no training has seen, and what learned volumes make of contact with
// them.
#include "suite.h"

#include <string.h>

#include "app/bench/unseen/path.h"
#include "base/vec3.h"
#include "overlap/models.h"

enum { PLACES = 48 };

static AppUnseenErrors measure(int index, const char *name) {
  AppUnseenMesh mesh;
  AppUnseenErrors errors;
  OverlapModel model, clip;
  ck_assert_ok(overlap_models_create(&model, name));
  ck_assert_ok(overlap_models_create(&clip, "clip"));
  ck_assert_ok(app_unseen_mesh_create(&mesh, &app_unseen_cases[index], 9901));
  ck_assert_ok(app_unseen_path_measure(&app_unseen_cases[index], &mesh, &model, &clip, PLACES, &errors));
  app_unseen_mesh_destroy(&mesh);
  overlap_model_destroy(&clip);
  overlap_model_destroy(&model);
  return errors;
}

static double volume_of(const double *x, const int tet[4]) {
  Vec3 edge[3];
  for (int e = 0; e < 3; e++) edge[e] = vec3_sub(vec3_at(x + 3 * tet[e + 1]), vec3_at(x + 3 * tet[0]));
  return vec3_dot(edge[0], vec3_cross(edge[1], edge[2])) / 6;
}

// Six or five tetrahedra a cell: what jitter takes from one cell inside of a body another one gets.
START_TEST(bodies_fill_their_boxes_and_are_not_inverted) {
  const AppUnseenCase *what = &app_unseen_cases[_i];
  AppUnseenMesh mesh;
  ck_assert_ok(app_unseen_mesh_create(&mesh, what, 5));
  for (int b = 0; b < 2; b++) {
    const AppUnseenBody *body = b ? &what->upper : &what->lower;
    double rest = 0, strained = 0, box = 1;
    for (int t = mesh.bodies[b].tet_begin; t < mesh.bodies[b].tet_end; t++) {
      ck_assert(volume_of(mesh.rest, mesh.tets[t]) > 0);
      ck_assert(volume_of(mesh.x, mesh.tets[t]) > 0);
      rest += volume_of(mesh.rest, mesh.tets[t]), strained += volume_of(mesh.x, mesh.tets[t]);
    }
    ck_assert_near(strained / rest, body->push, 1e-12);
    if (body->grading > 1) continue;
    for (int c = 0; c < 3; c++) box *= body->cells[c] * body->cell[c];
    ck_assert_near(rest / box, 1, 2 * body->jitter + 1e-12);
  }
  app_unseen_mesh_destroy(&mesh);
}
END_TEST

START_TEST(clipping_pair_by_pair_makes_no_errors) {
  AppUnseenErrors errors = measure(_i, "clip-scalar");
  ck_assert_int_gt(errors.pairs, 1000);
  ck_assert(errors.volume < 1e-12 && errors.moment < 1e-12 && errors.nodal_force < 1e-12);
  ck_assert(errors.total_force < 1e-12 && errors.tangential < 1e-12 && errors.normal_sum < 1e-12);
  ck_assert_near(errors.path_work, errors.path_work_clip, 1e-12);
  ck_assert(errors.path_work < 1e-2);
}
END_TEST

enum { PROMISED = 4 };

// What docs/models.md promises of forces.
START_TEST(learned_volumes_keep_their_promise) {
  static const char *const cases[PROMISED] = {"jittered", "aligned", "made", "adapted"};
  int which = 0;
  while (which < app_unseen_case_count && strcmp(app_unseen_cases[which].name, cases[_i]) != 0) which++;
  ck_assert_int_lt(which, app_unseen_case_count);
  AppUnseenErrors geo = measure(which, "geo"), small = measure(which, "geo-small"),
                  hybrid = measure(which, "hybrid");
  ck_assert(geo.nodal_force < 0.003 && small.nodal_force < 0.006);
  ck_assert(hybrid.nodal_force < 0.003 && hybrid.tangential < 0.01 && hybrid.moment < 0.005);
  ck_assert(hybrid.path_work < hybrid.path_work_clip + 5e-4);
  ck_assert(geo.tangential < 0.01 && small.tangential < 0.01);
  ck_assert(geo.moment < 0.008 && small.moment < 0.016);
  ck_assert(geo.path_work < geo.path_work_clip + 5e-4);
  ck_assert(small.path_work < small.path_work_clip + 1e-3);
}
END_TEST

START_TEST(a_model_without_its_own_centroid_is_measured_too) {
  AppUnseenErrors errors = measure(0, "tpn-scene");
  ck_assert(errors.moment > 0 && errors.normal_sum > 0);
  ck_assert(errors.nodal_force > 0 && errors.nodal_force < 0.5);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("unseen");
  tcase_add_loop_test(cases, bodies_fill_their_boxes_and_are_not_inverted, 0, app_unseen_case_count);
  tcase_add_loop_test(cases, clipping_pair_by_pair_makes_no_errors, 0, 2);
  tcase_add_loop_test(cases, learned_volumes_keep_their_promise, 0, PROMISED);
  tcase_add_test(cases, a_model_without_its_own_centroid_is_measured_too);
  return suite_run("unseen", cases, 60);
}
