// SPDX-License-Identifier: GPL-3.0-or-later
// Whole runs held against theory and against what physics forbids. Every contact scene asserts that contact
// occurred.
#include "scene.h"

#include <string.h>

static double total_mass(const SceneRun *run) {
  double mass = 0;
  for (int b = 0; b < run->scene.body_count; b++) mass += run->model.bodies[b].mass;
  return mass;
}

// z of the body's lowest vertex at a frame.
static double lowest(const SceneRun *run, int body, int frame) {
  double z = INFINITY;
  for (int a = run->model.bodies[body].vertex_begin; a < run->model.bodies[body].vertex_end; a++)
    z = fmin(z, scene_position(run, frame, a)[2]);
  return z;
}

START_TEST(free_fall_follows_the_parabola) {
  SceneRun run;
  scene_run(&run, "free_fall", NULL);
  int last = run.result.trajectory.frame_count - 1;
  double t = run.scene.end;
  ck_assert_int_eq(last, 5);
  for (int a = 0; a < run.model.vertex_count; a++) {
    const double *x = scene_position(&run, last, a), *X = run.model.rest + 3 * a;
    ck_assert_near(x[0] - X[0], t, 1e-3);
    ck_assert_near(x[1] - X[1], 0, 1e-6);
    ck_assert_near(x[2] - X[2], 2 * t - 0.5 * 9.81 * t * t, 1e-3);
  }
  ck_assert_near(run.result.min_det_F, 1, 1e-6);
  ck_assert_int_eq(run.result.contact.pairs_max, 0);
  scene_close(&run);
}
END_TEST

START_TEST(a_resting_block_weighs_m_g) {
  SceneRun run;
  scene_run(&run, "rest", NULL);
  double weight = total_mass(&run) * 9.81;
  const double *force = scene_force(&run, run.result.trajectory.frame_count - 1, 0);
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  ck_assert_near(force[2], weight, 1e-3 * weight);
  ck_assert_near(force[0], 0, 1e-3 * weight);
  ck_assert_near(force[1], 0, 1e-3 * weight);
  scene_close(&run);
}
END_TEST

START_TEST(a_drop_gains_no_energy_at_any_stiffness) {
  const char *const stiffness[] = {"1e5", "1e6", "1e7", "1e8", "1e9"};
  for (int k = 0; k < 5; k++) {
    char override[64];
    snprintf(override, sizeof override, "contact.stiffness=%s", stiffness[k]);
    SceneRun run;
    scene_run(&run, "drop", (const char *const[]){override, NULL});
    ck_assert_int_gt(run.result.contact.pairs_max, 0);
    ck_assert_msg(scene_gain(&run) <= 1e-3, "κ = %s Pa: the energy rises by %.2g of the scene's",
                  stiffness[k], scene_gain(&run));
    ck_assert_double_gt(lowest(&run, 0, run.result.trajectory.frame_count - 1), -0.05);
    scene_close(&run);
  }
}
END_TEST

START_TEST(hundreds_of_pairs_may_begin_at_once) {
  SceneRun run;
  scene_run(&run, "onset", NULL);
  ck_assert_int_gt(run.result.contact.pairs_max, 100);
  ck_assert_msg(scene_gain(&run) <= 1e-3, "the energy rises by %.2g of the scene's", scene_gain(&run));
  ck_assert_int_lt((int)run.result.integrator.restarts, 60);
  scene_close(&run);
}
END_TEST

START_TEST(the_ground_carries_a_stack_of_five) {
  SceneRun run;
  scene_run(&run, "stack", NULL);
  double weight = total_mass(&run) * 9.81;
  // The ground is the last side; its interface is with the lowest cube.
  int ground = -1;
  for (int i = 0; i < run.result.trajectory.interface_count; i++)
    if (strcmp(run.result.trajectory.interface_names[i], "cube1, ground") == 0) ground = i;
  ck_assert_int_ge(ground, 0);
  double force = scene_force(&run, run.result.trajectory.frame_count - 1, ground)[2];
  ck_assert_near(force, weight, 1e-3 * weight);
  for (int b = 1; b < 5; b++)
    ck_assert_double_gt(lowest(&run, b, run.result.trajectory.frame_count - 1),
                        lowest(&run, b - 1, run.result.trajectory.frame_count - 1));
  ck_assert_double_gt(run.result.min_det_F, 0);
  scene_close(&run);
}
END_TEST

START_TEST(a_collision_keeps_momentum_and_angular_momentum) {
  SceneRun run;
  scene_run(&run, "collision", (const char *const[]){"time.tolerance=1e-5", NULL});
  ck_assert_int_gt(run.result.contact.pairs_max, 0);
  const FemModel *model = &run.model;
  double momentum[2][3] = {{0}}, size = 0;
  // Velocities of the last frames by differences of the centres: the bodies fly freely after the collision.
  int last = run.result.trajectory.frame_count - 1;
  double dt = run.result.trajectory.times[last] - run.result.trajectory.times[last - 1];
  for (int a = 0; a < model->vertex_count; a++)
    for (int c = 0; c < 3; c++) {
      momentum[0][c] += model->mass[a] * model->initial_velocity[3 * a + c];
      momentum[1][c] +=
          model->mass[a] * (scene_position(&run, last, a)[c] - scene_position(&run, last - 1, a)[c]) / dt;
      size = fmax(size, fabs(momentum[0][c]));
    }
  for (int c = 0; c < 3; c++) ck_assert_near(momentum[1][c], momentum[0][c], 1e-5 * size);
  ck_assert_double_le(scene_gain(&run), 1e-3);
  scene_close(&run);
}
END_TEST

START_TEST(refined_cantilevers_approach_beam_theory) {
  const char *const cells[] = {"bodies.beam.mesh.box.cells=[15, 3, 3]",
                               "bodies.beam.mesh.box.cells=[30, 6, 6]"};
  // Timoshenko: ρ g A L⁴/(8 E I) + ρ g L²/(2 k G), k = 5/6.
  double L = 0.5, h = 0.1, E = 1e7, G = E / 2.6, q = 1000 * 1.0 * h * h;
  double theory = q * pow(L, 4) / (8 * E * pow(h, 4) / 12) + q * L * L / (2 * (5.0 / 6) * G * h * h);
  double tip[2];
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    scene_run(&run, "cantilever", (const char *const[]){cells[k], NULL});
    tip[k] = 0;
    int count = 0;
    for (int a = 0; a < run.model.vertex_count; a++) {
      if (run.model.rest[3 * a] < L - 1e-9) continue;
      tip[k] += run.model.rest[3 * a + 2] - scene_position(&run, run.result.trajectory.frame_count - 1, a)[2];
      count++;
    }
    tip[k] /= count;
    scene_close(&run);
  }
  // Linear tetrahedra are too stiff in bending: they come from below, and halving the edge more than halves
  // the error.
  double error[2] = {theory - tip[0], theory - tip[1]};
  ck_assert_msg(error[1] > 0 && error[1] < 0.5 * error[0] && error[1] < 0.15 * theory,
                "theory %.4g, measured %.4g and %.4g", theory, tip[0], tip[1]);
}
END_TEST

START_TEST(an_inverted_start_recovers) {
  SceneRun run;
  scene_open(&run, "free_fall",
             (const char *const[]){"effects.damping=0.002", "bodies.block.velocity=[0, 0, 0]", NULL});
  double *displacement = calloc(3 * (size_t)run.model.vertex_count, sizeof *displacement);
  int pushed = -1; // the vertex in the middle goes through its neighbours
  for (int a = 0; a < run.model.vertex_count; a++) {
    const double *X = run.model.rest + 3 * a;
    if (fabs(X[0] - 0.1) < 1e-9 && fabs(X[1] - 0.1) < 1e-9 && fabs(X[2] - 0.1) < 1e-9) pushed = a;
  }
  ck_assert_int_ge(pushed, 0);
  displacement[3 * pushed] = 0.13;
  scene_run_from(&run, displacement);
  ck_assert_msg(run.status == STATUS_OK, "%s", status_message());
  ck_assert_double_lt(run.result.min_det_F, 0);
  // At the end every element is positive again and the block has its shape.
  int last = run.result.trajectory.frame_count - 1;
  for (int e = 0; e < run.model.tet_count; e++) {
    double corners[12], F[9];
    for (int k = 0; k < 4; k++) memcpy(corners + 3 * k, scene_position(&run, last, run.model.tets[e][k]), 24);
    const FemElement element = fem_model_element(&run.model, e);
    fem_element_deformation(&element, corners, F);
    double det = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
                 F[2] * (F[3] * F[7] - F[4] * F[6]);
    ck_assert_near(det, 1, 0.05);
  }
  ck_assert_double_le(scene_gain(&run), 1e-3);
  free(displacement);
  scene_close(&run);
}
END_TEST

// Where the two regular tetrahedra start, so that the named features meet first. Both fall straight down
// until then. "On edge": turned so that one edge lies along y at the bottom and the opposite one along x on
// top, 0.0707 m above.
#define ON_EDGE "rotate: {axis: [0, 1, 0], degrees: -54.7356103}, "
#define ON_EDGE_TURNED                                                                                       \
  "rotate: {axis: [0.417681254, -0.417681254, 0.806898222], degrees: 102.200004}, " // and by 90° about z
static const struct {
  const char *name, *lower, *upper;
} meetings[] = {
    {"vertex on face", "bodies.lower.place={translate: [0, 0, 0]}",
     "bodies.upper.place={rotate: {axis: [1, 0, 0], degrees: 180}, translate: [0.0096, 0.0167, 0.15]}"},
    {"face on vertex", "bodies.lower.place={translate: [0, 0, 0]}",
     "bodies.upper.place={translate: [0.004, 0.003, 0.1]}"},
    {"vertex on vertex", "bodies.lower.place={translate: [0, 0, 0]}",
     "bodies.upper.place={rotate: {axis: [1, 0, 0], degrees: 180}, translate: [0, 0, 0.18]}"},
    {"edge on edge, crossed", "bodies.lower.place={" ON_EDGE "translate: [0.0166667, 0, 0.0235702]}",
     "bodies.upper.place={" ON_EDGE "translate: [0.0166667, 0, 0.11]}"},
    {"edge on edge, parallel", "bodies.lower.place={" ON_EDGE "translate: [0.0166667, 0, 0.0235702]}",
     "bodies.upper.place={" ON_EDGE_TURNED "translate: [0, 0.0166667, 0.11]}"},
};

START_TEST(single_tetrahedra_meet_and_stay_sound) {
  for (size_t m = 0; m < sizeof meetings / sizeof *meetings; m++) {
    SceneRun run;
    scene_run(&run, "single_tets", (const char *const[]){meetings[m].lower, meetings[m].upper, NULL});
    ck_assert_msg(run.result.contact.pairs_max > 0, "%s: no contact", meetings[m].name);
    ck_assert_msg(run.result.min_det_F > 0, "%s: det F = %g", meetings[m].name, run.result.min_det_F);
    ck_assert_msg(scene_gain(&run) <= 1e-3, "%s: the energy rises by %.2g", meetings[m].name,
                  scene_gain(&run));
    scene_close(&run);
  }
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("scenes");
  tcase_add_test(cases, free_fall_follows_the_parabola);
  tcase_add_test(cases, a_resting_block_weighs_m_g);
  tcase_add_test(cases, a_drop_gains_no_energy_at_any_stiffness);
  tcase_add_test(cases, hundreds_of_pairs_may_begin_at_once);
  tcase_add_test(cases, the_ground_carries_a_stack_of_five);
  tcase_add_test(cases, a_collision_keeps_momentum_and_angular_momentum);
  tcase_add_test(cases, refined_cantilevers_approach_beam_theory);
  tcase_add_test(cases, an_inverted_start_recovers);
  tcase_add_test(cases, single_tetrahedra_meet_and_stay_sound);
  return suite_run("scenes", cases, 600);
}
