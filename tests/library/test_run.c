// SPDX-License-Identifier: GPL-3.0-or-later
// libtetlap-run as a program of somebody else has it: by tetlap/run.h alone.
#include <tetlap/run.h>

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "folder.h"
#include "suite.h"

#define HAND TETLAP_SOURCE_DIR "/tests/scenes/hand.yaml"

#define ck_assert_refused(call, words)                                                                       \
  do {                                                                                                       \
    ck_assert_int_ne(call, 0);                                                                               \
    ck_assert_msg(strstr(tetlap_run_message(), words) != NULL, "%s", tetlap_run_message());                  \
  } while (0)

static TetlapRun *open_hand(const TetlapRunOptions *options) {
  TetlapRun *run;
  ck_assert_msg(tetlap_run_open(&run, HAND, options) == 0, "%s", tetlap_run_message());
  return run;
}

// One advance, which on_step ends after `expected` steps that it counts itself.
static void advance_with(int (*on_step)(void *, TetlapRun *), int expected) {
  int steps = 0;
  TetlapRunOptions options = TETLAP_RUN_OPTIONS_INIT;
  options.on_step = on_step, options.user = &steps;
  TetlapRun *run = open_hand(&options);
  ck_assert_int_eq(tetlap_run_advance(run, 0.2), 0);
  ck_assert_int_eq(steps, expected);
  ck_assert_double_lt(tetlap_run_time(run), 0.2);
  ck_assert_int_eq(tetlap_run_advance(run, tetlap_run_time(run)), 0); // it can be used again
  tetlap_run_close(run);
}

// Presses the plate down by 5 cm/s and pulls the block aside.
static void press(TetlapRun *run, double until) {
  const double force[3] = {0.5, 0, 0};
  ck_assert_int_eq(tetlap_run_load(run, "block", force, 3, 0.01), 0);
  while (tetlap_run_time(run) < until) {
    const double down[3] = {0, 0, -0.05 * (tetlap_run_time(run) + 0.01)};
    ck_assert_int_eq(tetlap_run_drive(run, "plate", down, TETLAP_RUN_NEXT_ADVANCE), 0);
    ck_assert_int_eq(tetlap_run_advance(run, fmin(until, tetlap_run_time(run) + 0.01)), 0);
  }
}

START_TEST(a_run_is_pressed_read_and_taken_back) {
  TetlapRun *run = open_hand(NULL);
  TetlapRunBody body = TETLAP_RUN_BODY_INIT;
  TetlapRunContact plate = TETLAP_RUN_CONTACT_INIT, same = TETLAP_RUN_CONTACT_INIT;
  TetlapRunState *state;
  const double *forces, *pressure;
  ck_assert_int_eq(tetlap_run_body_count(run), 1);
  ck_assert_int_eq(tetlap_run_body(run, 0, &body), 0);
  ck_assert_str_eq(body.name, "block");
  ck_assert_int_eq(body.vertex_end - body.vertex_begin, tetlap_run_vertex_count(run));
  press(run, 0.12);
  ck_assert_int_eq(tetlap_run_contact(run, "block", "plate", &plate), 0);
  ck_assert_int_eq(tetlap_run_contact(run, "plate", "block", &same), 0);
  ck_assert_double_lt(plate.force[2], -1); // on the block, downwards
  for (int c = 0; c < 3; c++) ck_assert_double_eq(plate.force[c], -same.force[c]);
  ck_assert_int_eq(tetlap_run_forces(run, &forces, &pressure), 0);
  double highest = 0;
  for (int v = 0; v < tetlap_run_vertex_count(run); v++) highest = fmax(highest, pressure[v]);
  ck_assert_double_gt(highest, 0);
  double *stress = calloc(6 * (size_t)tetlap_run_tet_count(run), sizeof *stress);
  ck_assert_int_eq(tetlap_run_stress(run, stress), 0);
  ck_assert_double_lt(stress[2], 0); // it is squeezed along z
  free(stress);

  ck_assert_int_eq(tetlap_run_keep(run, &state), 0);
  ck_assert_int_eq(tetlap_run_advance(run, 0.14), 0);
  const double first = tetlap_run_points(run)[0];
  ck_assert_int_eq(tetlap_run_restore(run, state), 0);
  ck_assert_int_eq(tetlap_run_advance(run, 0.14), 0);
  ck_assert_double_eq(tetlap_run_points(run)[0], first);
  tetlap_run_state_free(state);
  tetlap_run_close(run);
}
END_TEST

static int stop_after(void *user, TetlapRun *run) {
  ck_assert_double_ge(tetlap_run_time(run), 0);
  return ++*(int *)user == 3;
}

START_TEST(a_callback_ends_the_advance) {
  advance_with(stop_after, 3);
}
END_TEST

static void *advance_elsewhere(void *run) {
  ck_assert_refused(tetlap_run_advance(run, 0.2), "another thread");
  return NULL;
}

// A reader and nothing else, in the thread of the advance and nowhere else.
static int meddle(void *user, TetlapRun *run) {
  const double up[3] = {0, 0, 1}, *forces, *pressure;
  TetlapRunState *state;
  pthread_t other;
  ck_assert_int_eq(tetlap_run_forces(run, &forces, &pressure), 0);
  ck_assert_ptr_nonnull(forces);
  ck_assert_refused(tetlap_run_advance(run, 0.2), "own on_step");
  ck_assert_refused(tetlap_run_drive(run, "plate", up, 1), "own on_step");
  ck_assert_refused(tetlap_run_load(run, "block", up, 3, 1), "own on_step");
  ck_assert_refused(tetlap_run_keep(run, &state), "own on_step");
  ck_assert_ptr_null(state);
  ck_assert_int_eq(pthread_create(&other, NULL, advance_elsewhere, run), 0);
  pthread_join(other, NULL);
  return ++*(int *)user == 2;
}

START_TEST(one_at_a_time_uses_a_run) {
  advance_with(meddle, 2);
}
END_TEST

START_TEST(a_fork_of_the_process_may_not_use_it) {
  TetlapRun *run = open_hand(NULL);
  int code = 0;
  pid_t child = fork();
  if (child == 0)
    _exit(tetlap_run_advance(run, 0.01) && strstr(tetlap_run_message(), "the process that opened it") ? 7
                                                                                                      : 8);
  ck_assert_int_eq(waitpid(child, &code, 0), child);
  ck_assert_int_eq(WEXITSTATUS(code), 7);
  ck_assert_int_eq(tetlap_run_advance(run, 0.01), 0);
  tetlap_run_close(run);
}
END_TEST

START_TEST(states_of_other_scenes_and_no_states_are_refused) {
  char path[128];
  TetlapRunState *state, *again;
  TetlapRun *run = open_hand(NULL), *other;
  TetlapRunOptions options = TETLAP_RUN_OPTIONS_INIT;
  const char *const harder[] = {"bodies.block.material.young=3e5"},
                    *const finer[] = {"bodies.block.mesh.box.cells=[4,3,3]"};
  snprintf(path, sizeof path, "%s/state.h5", folder);
  ck_assert_int_eq(tetlap_run_advance(run, 0.01), 0);
  ck_assert_int_eq(tetlap_run_keep(run, &state), 0);
  ck_assert_int_eq(tetlap_run_state_write(run, state, path), 0);
  ck_assert_refused(tetlap_run_restore(run, NULL), "NULL");
  options.set = harder, options.set_count = 1;
  other = open_hand(&options);
  ck_assert_refused(tetlap_run_state_read(other, &again, path),
                    "the scene has changed: bodies[0].material.young");
  ck_assert_ptr_null(again);
  tetlap_run_close(other);
  options.set = finer;
  other = open_hand(&options);
  ck_assert_refused(tetlap_run_restore(other, state), "of another scene");
  ck_assert_int_eq(tetlap_run_advance(other, 0.01), 0); // nothing of it has harmed the run
  ck_assert_refused(tetlap_run_state_read(other, &again, HAND), "hand.yaml");
  tetlap_run_close(other);
  tetlap_run_state_free(state);
  tetlap_run_close(run);
}
END_TEST

START_TEST(what_makes_no_sense_is_refused_with_a_message) {
  const double up[3] = {0, 0, 1}, none[3] = {0, 0, NAN};
  TetlapRunContact contact = TETLAP_RUN_CONTACT_INIT;
  TetlapRunBody small = {.size = 1}, body = TETLAP_RUN_BODY_INIT;
  TetlapRun *run;
  ck_assert_refused(tetlap_run_open(&run, "/no/such.yaml", NULL), "/no/such.yaml");
  ck_assert_ptr_null(run);
  run = open_hand(NULL);
  ck_assert_refused(tetlap_run_drive(run, "blok", up, 0.1), "'plate'");
  ck_assert_refused(tetlap_run_drive(run, "plate", none, 0.1), "must be a number");
  ck_assert_refused(tetlap_run_load(run, "block", up, 2, 0), "not 2");
  ck_assert_refused(tetlap_run_contact(run, "block", "wall", &contact), "'wall'");
  ck_assert_refused(tetlap_run_body(run, 0, &small), "_INIT");
  ck_assert_refused(tetlap_run_body(run, 1, &body), "no body 1");
  ck_assert_refused(tetlap_run_contact_at(run, -1, &contact), "no contact -1");
  ck_assert_refused(tetlap_run_drive(run, NULL, up, 0.1), "a name is NULL");
  ck_assert_refused(tetlap_run_load(run, "plate", up, 3, 0), "'block'"); // driven, and not loaded
  ck_assert_refused(tetlap_run_drive(run, "plate", up, NAN), "not nan");
  ck_assert_refused(tetlap_run_advance(run, NAN), "nan");
  ck_assert_refused(tetlap_run_advance(run, 1), "ends at t = 0.2 s");
  ck_assert_int_eq(tetlap_run_advance(run, 0.01), 0);
  ck_assert_refused(tetlap_run_advance(run, 0.005), "cannot go back");
  tetlap_run_close(run);
}
END_TEST

START_TEST(a_run_that_is_not_open_is_refused) {
  const double up[3] = {0, 0, 1};
  const double *forces, *pressure;
  double stress[6];
  TetlapRunContact contact = TETLAP_RUN_CONTACT_INIT;
  TetlapRunBody body = TETLAP_RUN_BODY_INIT;
  TetlapRunState *state;
  TetlapRun *run;
  ck_assert_refused(tetlap_run_open(&run, "/no/such.yaml", NULL), "/no/such.yaml");
  ck_assert_refused(tetlap_run_advance(run, 0.1), "not opened, or is closed");
  ck_assert_refused(tetlap_run_drive(run, "plate", up, 0.1), "the run is NULL");
  ck_assert_refused(tetlap_run_load(run, "block", up, 3, 0), "the run is NULL");
  ck_assert_refused(tetlap_run_forces(run, &forces, &pressure), "the run is NULL");
  ck_assert_refused(tetlap_run_stress(run, stress), "the run is NULL");
  ck_assert_refused(tetlap_run_body(run, 0, &body), "the run is NULL");
  ck_assert_refused(tetlap_run_contact(run, "block", "plate", &contact), "the run is NULL");
  ck_assert_refused(tetlap_run_contact_at(run, 0, &contact), "the run is NULL");
  ck_assert_refused(tetlap_run_record(run, "record.jsonl"), "the run is NULL");
  ck_assert_refused(tetlap_run_keep(run, &state), "the run is NULL");
  ck_assert_refused(tetlap_run_state_read(run, &state, HAND), "the run is NULL");
  ck_assert_int_eq(tetlap_run_body_count(run) + tetlap_run_vertex_count(run) + tetlap_run_tet_count(run) +
                       tetlap_run_contact_count(run),
                   0);
  ck_assert_ptr_null(tetlap_run_points(run));
  ck_assert(isnan(tetlap_run_time(run)));
  tetlap_run_close(run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("run");
  tcase_add_checked_fixture(cases, folder_make, folder_remove);
  tcase_add_test(cases, a_run_is_pressed_read_and_taken_back);
  tcase_add_test(cases, a_callback_ends_the_advance);
  tcase_add_test(cases, one_at_a_time_uses_a_run);
  tcase_add_test(cases, a_fork_of_the_process_may_not_use_it);
  tcase_add_test(cases, states_of_other_scenes_and_no_states_are_refused);
  tcase_add_test(cases, what_makes_no_sense_is_refused_with_a_message);
  tcase_add_test(cases, a_run_that_is_not_open_is_refused);
  return suite_run("run", cases, 120);
}
