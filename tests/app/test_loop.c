// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is stepped from outside.
#include "app/loop/loop.h"

#include <stdio.h>
#include <string.h>

#include "app/loop/replay.h"
#include "app/loop/state.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/vec3.h"
#include "contact/search/layout.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/elements/packs.h"
#include "fem/effect/system_energy.h"
#include "fem/model/compliance/compliance.h"
#include "fem/run/run_state.h"
#include "folder.h"
#include "scene.h"

static AppLoop loop;

// What is evaluated is counted.
static int energies, forces_of_contact;
Status __real_fem_system_energy(FemSystem *system, const FemState *state, FemEnergy *energy);
Status __wrap_fem_system_energy(FemSystem *system, const FemState *state, FemEnergy *energy);
Status __wrap_fem_system_energy(FemSystem *system, const FemState *state, FemEnergy *energy) {
  energies++;
  return __real_fem_system_energy(system, state, energy);
}

Status __real_fem_forces_take(FemForces *forces, const FemState *state);
Status __wrap_fem_forces_take(FemForces *forces, const FemState *state);
Status __wrap_fem_forces_take(FemForces *forces, const FemState *state) {
  forces_of_contact++;
  return __real_fem_forces_take(forces, state);
}

// What a model is prepared with.
static int preparations;
Status __real_contact_layout_create(ContactLayout *layout, const ContactSystemDef *def);
Status __wrap_contact_layout_create(ContactLayout *layout, const ContactSystemDef *def);
Status __wrap_contact_layout_create(ContactLayout *layout, const ContactSystemDef *def) {
  preparations++;
  return __real_contact_layout_create(layout, def);
}

Status __real_fem_compliance_choose(const FemModel *model, FemCompliance *choice);
Status __wrap_fem_compliance_choose(const FemModel *model, FemCompliance *choice);
Status __wrap_fem_compliance_choose(const FemModel *model, FemCompliance *choice) {
  preparations++;
  return __real_fem_compliance_choose(model, choice);
}

Status __real_fem_packs_create(FemPacks *packs, const FemModel *model, bool is_quadratic,
                               bool (*takes)(const FemModelBody *body));
Status __wrap_fem_packs_create(FemPacks *packs, const FemModel *model, bool is_quadratic,
                               bool (*takes)(const FemModelBody *body));
Status __wrap_fem_packs_create(FemPacks *packs, const FemModel *model, bool is_quadratic,
                               bool (*takes)(const FemModelBody *body)) {
  preparations++;
  return __real_fem_packs_create(packs, model, is_quadratic, takes);
}

static long long evaluations(void) {
  void *effect = fem_system_effect(&fem_run_session_state(loop.session)->system, &fem_effect_contact);
  return contact_system_counters(fem_effect_contact_system(effect))->evaluations;
}

static void open_loop(const char *name, const char *override) {
  static char path[512];
  snprintf(path, sizeof path, "%s/tests/scenes/%s.yaml", TETLAP_SOURCE_DIR, name);
  AppLoopOptions options = {.job = {.scene_path = path}};
  if (override) options.job.overrides[options.job.override_count++] = override;
  ck_assert_ok(app_loop_open(&loop, &options));
}

static size_t value_count(void) {
  return 3 * (size_t)loop.job.model.vertex_count;
}

static double *copy_positions(void) {
  return memory_copy(app_loop_state(&loop)->positions, value_count(), sizeof(double));
}

static double largest_difference(const double *a, const double *b) {
  double largest = 0;
  for (size_t i = 0; i < value_count(); i++) largest = suite_larger(largest, fabs(a[i] - b[i]));
  return largest;
}

START_TEST(one_advance_to_the_end_is_the_run_to_the_last_bit) {
  SceneRun run;
  scene_run(&run, "hand", NULL);
  open_loop("hand", NULL);
  ck_assert_ok(app_loop_advance(&loop, 0.2));
  ck_assert_double_eq(app_loop_time(&loop), 0.2);
  const double *end = scene_position(&run, run.result.trajectory.frame_count - 1, 0);
  ck_assert_double_eq(largest_difference(end, app_loop_state(&loop)->positions), 0);
  ck_assert(loop.contacts[0].volume > 0);
  scene_close(&run);
  app_loop_close(&loop);
}
END_TEST

// Each step may err by the tolerance of displacement, 1e-5 of the block's diagonal.
START_TEST(any_partition_of_the_time_gives_the_runs_answer_to_its_tolerance) {
  open_loop("hand", NULL);
  ck_assert_ok(app_loop_advance(&loop, 0.2));
  double *whole = copy_positions();
  const double tolerance = 20 * 1e-5 * loop.job.model.length;
  app_loop_close(&loop);
  Random random = random_seeded(7, 0);
  for (int trial = 0; trial < 3; trial++) {
    open_loop("hand", NULL);
    while (app_loop_time(&loop) < 0.2) {
      double to = fmin(0.2, app_loop_time(&loop) + 0.03 * random_uniform(&random) * random_uniform(&random));
      ck_assert_ok(app_loop_advance(&loop, to));
      ck_assert_double_eq(app_loop_time(&loop), to);
    }
    ck_assert_double_le(largest_difference(whole, app_loop_state(&loop)->positions), tolerance);
    app_loop_close(&loop);
  }
  memory_free(whole);
}
END_TEST

static Vec3 momentum_of(void) {
  const FemModel *model = &loop.job.model;
  Vec3 sum = {0, 0, 0};
  for (size_t v = 0; v < (size_t)model->vertex_count; v++)
    sum = vec3_add(sum, vec3_scale(model->mass[v], vec3_at(app_loop_state(&loop)->velocities + 3 * v)));
  return sum;
}

static Vec3 impulse_of(void) {
  Vec3 sum = {0, 0, 0};
  for (int i = 0; i < loop.contact_count; i++) sum = vec3_add(sum, vec3_at(loop.contacts[i].impulse));
  return sum;
}

// As a share of what the weight gives in a window; by steps as fine as that asks for. The plate comes down
// and the block is pulled aside by a force that jumps; a state is kept and restored on the way.
START_TEST(force_is_change_of_momentum_over_every_window) {
  open_loop("hand", "time.tolerance=1e-7");
  AppLoopState state;
  const double mass = loop.job.model.bodies[0].mass, pull[3] = {0.5, 0, 0};
  double worst = 0;
  for (int k = 1; k <= 40; k++) {
    const double down[3] = {0, 0, -0.05 * 0.2 * k / 40};
    if (k == 20) ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0, pull, 3));
    if (k == 30) ck_assert_ok(app_loop_state_keep(&loop, &state));
    if (k == 31) ck_assert_ok(app_loop_state_restore(&loop, &state));
    ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", APP_LOOP_NEXT_ADVANCE, down, 3));
    Vec3 p = momentum_of(), j = impulse_of();
    double began = app_loop_time(&loop);
    ck_assert_ok(app_loop_advance(&loop, 0.2 * k / 40));
    const double seconds = app_loop_time(&loop) - began, weight = mass * 9.81 * seconds;
    Vec3 gained = vec3_sub(momentum_of(), p), given = vec3_sub(impulse_of(), j);
    given.z -= weight;
    if (k >= 20) given.x += pull[0] * seconds;
    worst = suite_larger(worst, vec3_length(vec3_sub(gained, given)) / weight);
  }
  app_loop_state_destroy(&state);
  ck_assert_double_lt(loop.contacts[1].force[2], -10 * mass); // the plate presses with more than the weight
  ck_assert_double_le(worst, 1e-4);
  app_loop_close(&loop);
}
END_TEST

// Presses the plate down by hand, and pulls the block aside.
static void press(double until) {
  const double force[3] = {0.5, 0, 0};
  while (app_loop_time(&loop) < until) {
    const double down[3] = {0, 0, -0.05 * (app_loop_time(&loop) + 0.01)};
    ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", APP_LOOP_NEXT_ADVANCE, down, 3));
    ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0.01, force, 3));
    ck_assert_ok(app_loop_advance(&loop, fmin(until, app_loop_time(&loop) + 0.01)));
  }
}

START_TEST(what_is_set_moves_the_bodies) {
  int contact;
  open_loop("hand", NULL);
  ck_assert_ok(app_loop_contact(&loop, "plate", "block", &contact));
  press(0.15);
  const double *force = loop.contacts[contact].force, *centre = loop.contacts[contact].centre,
               *moment = loop.contacts[contact].moment;
  ck_assert_double_lt(force[2], -1); // on the block, downwards
  Vec3 expected = vec3_cross(vec3_at(centre), vec3_at(force));
  ck_assert_near(moment[0], expected.x,
                 0.02 * 0.05 * fabs(force[2])); // of the lever of half the block's width
  ck_assert_near(loop.contacts[contact].pressure * loop.contacts[contact].area, -force[2], 0.05 * -force[2]);
  app_loop_close(&loop);
}
END_TEST

START_TEST(what_is_kept_and_restored_goes_on_to_the_same_bits) {
  AppLoopState state, again;
  char path[128];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  open_loop("hand", NULL);
  press(0.12);
  const double down[3] = {0, 0, -0.01};
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0.03, down, 3)); // a ramp that is on its way
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  ck_assert_ok(app_loop_state_write(&loop, &state, path));
  ck_assert_ok(app_loop_advance(&loop, 0.16));
  double *first = copy_positions(), impulse[3];
  memcpy(impulse, loop.contacts[1].impulse, sizeof impulse);
  ck_assert_ok(app_loop_state_restore(&loop, &state));
  ck_assert_double_eq(app_loop_time(&loop), 0.12);
  ck_assert_ok(app_loop_advance(&loop, 0.16));
  ck_assert_double_eq(largest_difference(first, app_loop_state(&loop)->positions), 0);
  ck_assert_mem_eq(impulse, loop.contacts[1].impulse, sizeof impulse);
  app_loop_close(&loop);
  open_loop("hand", NULL); // as in another process
  ck_assert_ok(app_loop_state_read(&loop, &again, path));
  ck_assert_ok(app_loop_state_restore(&loop, &again));
  ck_assert_ok(app_loop_advance(&loop, 0.16));
  ck_assert_double_eq(largest_difference(first, app_loop_state(&loop)->positions), 0);
  app_loop_state_destroy(&state);
  app_loop_state_destroy(&again);
  app_loop_close(&loop);
  memory_free(first);
}
END_TEST

static Status stop_at_force(void *self, AppLoop *it) {
  double *seen = self;
  *seen = fabs(it->contacts[0].force[2]);
  if (*seen > 3) app_loop_stop(it);
  return STATUS_OK;
}

// What is set, where an advance was stopped, and a state that was kept on the way.
START_TEST(a_replay_is_the_run_that_was_stepped_to_the_last_bit) {
  AppLoopState state;
  double seen = 0;
  char path[128];
  snprintf(path, sizeof path, "%s/record.jsonl", folder);
  open_loop("hand", NULL);
  press(0.08);
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  press(0.1);
  ck_assert_ok(app_loop_state_restore(&loop, &state));
  app_loop_state_destroy(&state);
  const double up[3] = {0, 0, 0}, wrench[6] = {0, 0, -0.2, 0, 1e-3, 0};
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0.05, up, 3));
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0, wrench, 6));
  loop.on_step = stop_at_force, loop.on_step_self = &seen;
  ck_assert_ok(app_loop_advance(&loop, 0.19));
  loop.on_step = NULL;
  ck_assert_ok(app_loop_advance(&loop, 0.2));
  double *stepped = copy_positions();
  ck_assert_ok(app_loop_diary_write(&loop.diary, path));
  AppJob job;
  char scene[512];
  snprintf(scene, sizeof scene, "%s/tests/scenes/hand.yaml", TETLAP_SOURCE_DIR);
  ck_assert_ok(app_job_open(&job, &(AppJobOptions){.scene_path = scene}, NULL, NULL));
  FemRunOptions options = {.keep_trajectory = true};
  FemRunResult result;
  ck_assert_ok(app_loop_replay(&job, &options, &result, path));
  const double *end =
      result.trajectory.positions + (size_t)(result.trajectory.frame_count - 1) * value_count();
  ck_assert_double_eq(largest_difference(end, stepped), 0);
  fem_run_result_destroy(&result);
  app_job_close(&job);
  app_loop_close(&loop);
  memory_free(stepped);
}
END_TEST

static long long restarts(void) {
  return fem_run_state_stats(fem_run_session_state(loop.session)).restarts;
}

START_TEST(the_integrator_begins_anew_only_where_a_force_jumps) {
  const double down[3] = {0, 0, -0.001}, pull[3] = {0.5, 0, 0}, none[3] = {0, 0, 0};
  open_loop("hand", NULL);
  ck_assert_ok(app_loop_advance(&loop, 0.005)); // in free fall, where no step is taken back
  const long long before = restarts();
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0.01, pull, 3));
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0.01, down, 3));
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", APP_LOOP_NEXT_ADVANCE, down, 3));
  ck_assert_ok(app_loop_advance(&loop, 0.006));
  ck_assert_ok(app_loop_advance(&loop, 0.007));
  ck_assert_int_eq(restarts(), before);
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0, none, 3));
  ck_assert_int_eq(restarts(), before + 1);
  app_loop_close(&loop);
}
END_TEST

// Weight of everything that is at rest, its centre left where it is.
START_TEST(a_wrench_is_shared_so_that_force_and_moment_are_its) {
  open_loop("hand", NULL);
  const double wrench[6] = {1, -2, 3, 0.1, 0.2, -0.3};
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0, wrench, 6));
  const FemLoad *load = &loop.job.model.loads[0];
  const double *x = app_loop_state(&loop)->positions;
  Vec3 force = {0, 0, 0}, moment = {0, 0, 0}, mean = {0, 0, 0.0505};
  for (int i = 0; i < load->vertex_count; i++) {
    Vec3 f = vec3_at(load->force + 3 * (size_t)i), at = vec3_at(x + 3 * (size_t)load->vertices[i]);
    force = vec3_add(force, f);
    moment = vec3_add(moment, vec3_cross(vec3_sub(at, mean), f));
  }
  const double *m = wrench + 3;
  ck_assert_double_le(vec3_length(vec3_sub(force, vec3_at(wrench))), 1e-13);
  ck_assert_double_le(vec3_length(vec3_sub(moment, vec3_at(m))), 1e-13);
  app_loop_close(&loop);
}
END_TEST

static void expect(Status status, const char *words) {
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), words), "'%s' is not in: %s", words, status_message());
}

START_TEST(what_makes_no_sense_is_refused_by_name) {
  int contact;
  const double to[3] = {0, 0, -0.01}, bad[3] = {0, NAN, 0}, six[6] = {0};
  AppLoopState state;
  open_loop("hand", NULL);
  ck_assert_ok(app_loop_advance(&loop, 0.01));
  expect(app_loop_set(&loop, APP_LOOP_DRIVE, "block", 0.1, to, 3), "there is 'plate'");
  expect(app_loop_set(&loop, APP_LOOP_LOAD, "plate", 0.1, to, 3), "there is 'block'");
  expect(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0.1, bad, 3), "value 1 is nan");
  expect(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0.1, six, 6), "3 values, not 6");
  expect(app_loop_set(&loop, APP_LOOP_LOAD, "block", 0.1, six, 5), "3 values (force), 6");
  expect(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", NAN, to, 3), "a number of seconds, not nan");
  expect(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0, to, 3), "cannot jump in a motion");
  expect(app_loop_advance(&loop, 0.005), "cannot go back to 0.005 s");
  expect(app_loop_advance(&loop, NAN), "cannot go back");
  expect(app_loop_advance(&loop, 0.3), "ends at t = 0.2 s");
  expect(app_loop_contact(&loop, "block", "roof", &contact), "block, floor; block, plate");
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  ck_assert_ok(app_loop_advance(&loop, 0.011)); // nothing of it has harmed the run
  app_loop_close(&loop);
  open_loop("bounce", NULL);
  expect(app_loop_state_restore(&loop, &state), "of another scene");
  app_loop_state_destroy(&state);
  app_loop_close(&loop);
}
END_TEST

START_TEST(a_state_of_another_version_is_refused) {
  AppLoopState state, again;
  char path[128], own[256];
  snprintf(path, sizeof path, "%s/state.h5", folder);
  open_loop("hand", NULL);
  snprintf(own, sizeof own, "%s", record_find_text(loop.origin, "program"));
  record_text(loop.origin, "program", "tetlap 0.0.9");
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  ck_assert_ok(app_loop_state_write(&loop, &state, path));
  record_text(loop.origin, "program", own);
  expect(app_loop_state_read(&loop, &again, path), "was written by \"tetlap 0.0.9\"; this is");
  app_loop_state_destroy(&again);
  ck_assert_ok(app_loop_state_restore(&loop, &state)); // of this one it still is
  app_loop_state_destroy(&state);
  app_loop_close(&loop);
}
END_TEST

START_TEST(a_static_scene_goes_from_equilibrium_to_equilibrium) {
  int contact;
  open_loop("hand", "time.static=true");
  const double down[3] = {0, 0, -0.008}, up[3] = {0, 0, -0.007};
  ck_assert_ok(app_loop_contact(&loop, "block", "plate", &contact));
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0, down, 3));
  ck_assert_ok(app_loop_advance(&loop, 0.05));
  const double pressed = -loop.contacts[contact].force[2];
  ck_assert_double_gt(pressed, 1);
  ck_assert_ok(app_loop_set(&loop, APP_LOOP_DRIVE, "plate", 0, up, 3));
  ck_assert_ok(app_loop_advance(&loop, 0.1));
  const double less = -loop.contacts[contact].force[2], *floor = loop.contacts[0].force;
  ck_assert_double_lt(less, pressed);
  ck_assert_near(floor[2], less + 9.81 * loop.job.model.bodies[0].mass, 0.01 * pressed);
  app_loop_close(&loop);
}
END_TEST

START_TEST(what_never_changes_is_made_once) {
  AppLoopState state;
  preparations = 0;
  open_loop("hand", NULL);
  ck_assert_int_gt(preparations, 2);
  preparations = 0;
  ck_assert_ok(app_loop_advance(&loop, 0.05));
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  for (int k = 0; k < 3; k++) ck_assert_ok(app_loop_state_restore(&loop, &state));
  ck_assert_int_eq(preparations, 0);
  ck_assert_ok(app_loop_advance(&loop, 0.06));
  app_loop_state_destroy(&state);
  app_loop_close(&loop);
}
END_TEST

static const FemSystem *system_of(void) {
  return &fem_run_session_state(loop.session)->system;
}

START_TEST(a_restore_takes_what_the_state_makes_equal) {
  AppLoopState state;
  open_loop("hand", NULL);
  press(0.12);
  ck_assert_ok(app_loop_state_keep(&loop, &state));
  const ContactSystem *contact =
      fem_effect_contact_system(fem_system_effect(system_of(), &fem_effect_contact));
  const long long layout = system_of()->matrix.layout;
  ck_assert_int_eq(contact_system_counters(contact)->searches, 1); // at that state, and not at rest
  ck_assert_ok(app_loop_state_restore(&loop, &state));
  ck_assert(system_of()->matrix.layout == layout);
  ck_assert_int_eq(contact_system_counters(contact)->searches, 0);
  ck_assert_int_eq(contact_system_counters(contact)->evaluations, 1);
  ck_assert_ok(app_loop_advance(&loop, 0.16));
  ck_assert_ok(app_loop_state_restore(&loop, &state));
  ck_assert_int_eq(contact_system_counters(contact)->searches, 0);
  app_loop_state_destroy(&state);
  app_loop_close(&loop);
}
END_TEST

START_TEST(an_advance_by_nothing_evaluates_nothing) {
  open_loop("hand", NULL);
  press(0.12);
  const long long before = evaluations();
  energies = forces_of_contact = 0;
  for (int k = 0; k < 10; k++) ck_assert_ok(app_loop_advance(&loop, app_loop_time(&loop)));
  ck_assert_int_eq(evaluations(), before);
  ck_assert_int_eq(energies, 0);
  ck_assert_int_eq(forces_of_contact, 0);
  app_loop_close(&loop);
}
END_TEST

// Frames included.
START_TEST(a_run_that_is_stepped_evaluates_no_energy_that_the_run_does_not) {
  SceneRun run;
  energies = 0;
  scene_run(&run, "hand", NULL);
  const int of_run = energies;
  scene_close(&run);
  open_loop("hand", NULL);
  energies = forces_of_contact = 0;
  ck_assert_ok(app_loop_advance(&loop, 0.2));
  ck_assert_int_gt(energies, 0);
  ck_assert_int_le(energies, of_run);
  app_loop_close(&loop);
}
END_TEST

// 12 × .01 is less than .12 by a rounding error: a loop `while (time < 0.12)` ends all the same.
START_TEST(a_time_that_differs_by_rounding_is_reached) {
  open_loop("hand", NULL);
  for (int k = 0; k < 12; k++) ck_assert_ok(app_loop_advance(&loop, app_loop_time(&loop) + 0.01));
  ck_assert_ok(app_loop_advance(&loop, 0.12));
  ck_assert_double_ge(app_loop_time(&loop), 0.12);
  ck_assert_ok(app_loop_advance(&loop, 0.2 * (1 + 1e-10))); // as a sum of a million steps
  ck_assert_double_eq(app_loop_time(&loop), 0.2);
  app_loop_close(&loop);
}
END_TEST

START_TEST(an_advance_ends_where_a_condition_holds) {
  double seen = 0;
  open_loop("hand", NULL);
  loop.on_step = stop_at_force, loop.on_step_self = &seen;
  ck_assert_ok(app_loop_advance(&loop, 0.2));
  ck_assert_double_lt(app_loop_time(&loop), 0.1);
  ck_assert_double_gt(fabs(loop.contacts[0].force[2]), 3);
  ck_assert_double_eq(fabs(loop.contacts[0].force[2]), seen);
  app_loop_close(&loop);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("loop");
  tcase_add_checked_fixture(test_case, folder_make, folder_remove);
  tcase_add_test(test_case, one_advance_to_the_end_is_the_run_to_the_last_bit);
  tcase_add_test(test_case, any_partition_of_the_time_gives_the_runs_answer_to_its_tolerance);
  tcase_add_test(test_case, force_is_change_of_momentum_over_every_window);
  tcase_add_test(test_case, what_is_set_moves_the_bodies);
  tcase_add_test(test_case, what_is_kept_and_restored_goes_on_to_the_same_bits);
  tcase_add_test(test_case, a_replay_is_the_run_that_was_stepped_to_the_last_bit);
  tcase_add_test(test_case, the_integrator_begins_anew_only_where_a_force_jumps);
  tcase_add_test(test_case, a_wrench_is_shared_so_that_force_and_moment_are_its);
  tcase_add_test(test_case, what_makes_no_sense_is_refused_by_name);
  tcase_add_test(test_case, a_state_of_another_version_is_refused);
  tcase_add_test(test_case, a_static_scene_goes_from_equilibrium_to_equilibrium);
  tcase_add_test(test_case, an_advance_ends_where_a_condition_holds);
  tcase_add_test(test_case, what_never_changes_is_made_once);
  tcase_add_test(test_case, a_restore_takes_what_the_state_makes_equal);
  tcase_add_test(test_case, an_advance_by_nothing_evaluates_nothing);
  tcase_add_test(test_case, a_run_that_is_stepped_evaluates_no_energy_that_the_run_does_not);
  tcase_add_test(test_case, a_time_that_differs_by_rounding_is_reached);
  return suite_run("loop", test_case, 60);
}
