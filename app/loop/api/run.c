// SPDX-License-Identifier: GPL-3.0-or-later
#include <tetlap/run.h>

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "app/loop/loop.h"
#include "app/loop/state.h"
#include "base/files/file.h"
#include "base/memory.h"

struct TetlapRun {
  AppLoop loop;
  TetlapRunOptions options;
  pid_t process;       // that opened it
  atomic_bool is_busy; // a call that may change it goes on
  atomic_bool tells;   // ... which is in on_step
  pthread_t teller;    // its thread
};

struct TetlapRunState {
  AppLoopState state;
};

const char *tetlap_run_message(void) {
  return status_message();
}

static int code_of(Status status) {
  return status_exit_code(status);
}

static Status check_size(size_t given, size_t known, const char *what) {
  if (given == known) return STATUS_OK;
  return status_fail(STATUS_USAGE, "%s has size %zu, expected %zu: set it by its ..._INIT macro", what, given,
                     known);
}

static Status check_given(const void *given, const char *what) {
  return given ? STATUS_OK : status_fail(STATUS_USAGE, "%s is NULL", what);
}

static Status check_open(const TetlapRun *run) {
  if (run) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "the run is NULL: it was not opened, or is closed; tetlap_run_open makes one");
}

static Status check_process(const TetlapRun *run) {
  TRY(check_open(run));
  if (getpid() == run->process) return STATUS_OK;
  return status_fail(STATUS_USAGE,
                     "the run belongs to the process that opened it; a fork of it has to open its own");
}

// Nobody else may change it until `leave`.
static Status enter(TetlapRun *run) {
  TRY(check_process(run));
  if (!atomic_exchange(&run->is_busy, true)) return STATUS_OK;
  return status_fail(STATUS_USAGE, "another thread, or the run's own on_step, is using it: one at a time");
}

static int leave(TetlapRun *run, Status status) {
  atomic_store(&run->is_busy, false);
  return code_of(status);
}

static Status tell_step(void *self, AppLoop *loop) {
  TetlapRun *run = self;
  if (!run->options.on_step) return STATUS_OK;
  TRY(app_loop_read_areas(loop));
  run->teller = pthread_self();
  atomic_store(&run->tells, true);
  if (run->options.on_step(run->options.user, run)) app_loop_stop(loop);
  atomic_store(&run->tells, false);
  return STATUS_OK;
}

static Status take_options(const char *scene, const TetlapRunOptions *options, AppLoopOptions *into) {
  *into = (AppLoopOptions){.job = {.scene_path = scene}};
  if (!scene) return status_fail(STATUS_USAGE, "no scene file is named");
  if (!options) return STATUS_OK;
  TRY(check_size(options->size, sizeof *options, "TetlapRunOptions"));
  if (options->set_count < 0 || options->set_count > APP_MAX_OVERRIDES || options->threads < 0)
    return status_fail(STATUS_USAGE, "set_count is %d and threads %d; expected 0 to %d, and 0 or more",
                       options->set_count, options->threads, APP_MAX_OVERRIDES);
  into->overlap = options->overlap;
  into->job.threads = options->threads;
  into->job.override_count = options->set_count;
  for (int i = 0; i < options->set_count; i++) into->job.overrides[i] = options->set[i];
  return STATUS_OK;
}

static Status open_run(TetlapRun *run, const char *scene, const TetlapRunOptions *options) {
  AppLoopOptions taken;
  TRY(take_options(scene, options, &taken));
  TRY(app_loop_open(&run->loop, &taken));
  if (options) run->options = *options;
  run->process = getpid();
  run->loop.on_step = tell_step;
  run->loop.on_step_self = run;
  return STATUS_OK;
}

int tetlap_run_open(TetlapRun **run, const char *scene, const TetlapRunOptions *options) {
  if (!run) return code_of(check_given(run, "where the run is to go"));
  TetlapRun *made = memory_zeroed(1, sizeof *made);
  *run = NULL;
  Status status = made ? open_run(made, scene, options) : status_no_memory("a run");
  if (status) memory_free(made);
  if (!status) *run = made;
  return code_of(status);
}

void tetlap_run_close(TetlapRun *run) {
  if (run) app_loop_close(&run->loop);
  memory_free(run);
}

double tetlap_run_time(const TetlapRun *run) {
  return run ? app_loop_time(&run->loop) : NAN;
}

int tetlap_run_advance(TetlapRun *run, double until) {
  Status status = enter(run);
  return status ? code_of(status) : leave(run, app_loop_advance(&run->loop, until));
}

static Status check_number(int number, int count, const char *what) {
  if (number >= 0 && number < count) return STATUS_OK;
  return status_fail(STATUS_USAGE, "there is no %s %d: they are counted from 0 and there are %d", what,
                     number, count);
}

int tetlap_run_body_count(const TetlapRun *run) {
  return run ? run->loop.job.model.body_count : 0;
}

static Status describe_body(const TetlapRun *run, int number, TetlapRunBody *body) {
  TRY(check_open(run));
  TRY(check_given(body, "where the body is to go"));
  const FemModel *model = &run->loop.job.model;
  TRY(check_size(body->size, sizeof *body, "TetlapRunBody"));
  TRY(check_number(number, model->body_count, "body"));
  const FemModelBody *of = &model->bodies[number];
  *body = (TetlapRunBody){.size = sizeof *body,
                          .name = of->name,
                          .vertex_begin = of->vertex_begin,
                          .vertex_end = of->vertex_end,
                          .tet_begin = of->tet_begin,
                          .tet_end = of->tet_end,
                          .is_obstacle = of->is_obstacle};
  return STATUS_OK;
}

int tetlap_run_body(const TetlapRun *run, int number, TetlapRunBody *body) {
  return code_of(describe_body(run, number, body));
}

int tetlap_run_vertex_count(const TetlapRun *run) {
  return run ? run->loop.job.model.vertex_count : 0;
}

int tetlap_run_tet_count(const TetlapRun *run) {
  return run ? run->loop.job.model.tet_count : 0;
}

const int *tetlap_run_tets(const TetlapRun *run) {
  return run ? &run->loop.job.model.tets[0][0] : NULL;
}

const double *tetlap_run_points(const TetlapRun *run) {
  return run ? app_loop_state(&run->loop)->positions : NULL;
}

const double *tetlap_run_velocities(const TetlapRun *run) {
  return run ? app_loop_state(&run->loop)->velocities : NULL;
}

// From within on_step, too.
int tetlap_run_forces(TetlapRun *run, const double **forces, const double **pressure) {
  *forces = *pressure = NULL;
  if (run && atomic_load(&run->tells) && pthread_equal(run->teller, pthread_self()))
    return code_of(app_loop_vertex_forces(&run->loop, forces, pressure));
  Status status = enter(run);
  return status ? code_of(status) : leave(run, app_loop_vertex_forces(&run->loop, forces, pressure));
}

int tetlap_run_stress(const TetlapRun *run, double *stress) {
  const Status status = run ? check_given(stress, "where the stress is to go") : check_open(run);
  if (status) return code_of(status);
  app_loop_stress(&run->loop, stress);
  return 0;
}

int tetlap_run_contact_count(const TetlapRun *run) {
  return run ? run->loop.contact_count : 0;
}

static Status describe_contact(const TetlapRun *run, int number, double sign, TetlapRunContact *contact) {
  TRY(check_open(run));
  TRY(check_given(contact, "where the contact is to go"));
  TRY(check_size(contact->size, sizeof *contact, "TetlapRunContact"));
  TRY(check_number(number, run->loop.contact_count, "contact"));
  const AppLoopContact *of = &run->loop.contacts[number];
  *contact = (TetlapRunContact){.size = sizeof *contact,
                                .a = sign > 0 ? of->a : of->b,
                                .b = sign > 0 ? of->b : of->a,
                                .area = of->area,
                                .pressure = of->pressure,
                                .slip = of->slip,
                                .volume = of->volume};
  for (int c = 0; c < 3; c++) {
    contact->force[c] = sign * of->force[c];
    contact->moment[c] = sign * of->moment[c];
    contact->impulse[c] = sign * of->impulse[c];
    contact->centre[c] = of->centre[c];
  }
  return STATUS_OK;
}

int tetlap_run_contact_at(const TetlapRun *run, int number, TetlapRunContact *contact) {
  return code_of(describe_contact(run, number, 1, contact));
}

static Status find_contact(const TetlapRun *run, const char *a, const char *b, TetlapRunContact *contact) {
  int number;
  TRY(check_open(run));
  TRY(check_given(a, "a name"));
  TRY(check_given(b, "a name"));
  TRY(app_loop_contact(&run->loop, a, b, &number));
  return describe_contact(run, number, strcmp(run->loop.contacts[number].a, a) == 0 ? 1 : -1, contact);
}

int tetlap_run_contact(const TetlapRun *run, const char *a, const char *b, TetlapRunContact *contact) {
  return code_of(find_contact(run, a, b, contact));
}

static Status set(TetlapRun *run, AppLoopKind kind, const char *name, const double *values, int count,
                  double ramp) {
  TRY(check_given(name, "a name"));
  TRY(check_given(values, "what is to be set"));
  return app_loop_set(&run->loop, kind, name, ramp, values, count);
}

int tetlap_run_drive(TetlapRun *run, const char *name, const double to[3], double ramp) {
  Status status = enter(run);
  return status ? code_of(status) : leave(run, set(run, APP_LOOP_DRIVE, name, to, 3, ramp));
}

int tetlap_run_load(TetlapRun *run, const char *name, const double *values, int count, double ramp) {
  Status status = enter(run);
  return status ? code_of(status) : leave(run, set(run, APP_LOOP_LOAD, name, values, count, ramp));
}

static Status record(const TetlapRun *run, const char *path) {
  TRY(check_open(run));
  TRY(check_given(path, "a file's name"));
  return app_loop_diary_write(&run->loop.diary, path);
}

int tetlap_run_record(const TetlapRun *run, const char *path) {
  return code_of(record(run, path));
}

// A new one, filled by keeping or by reading.
static Status make_state(TetlapRunState **state, TetlapRun *keep, const TetlapRun *of, const char *path) {
  TetlapRunState *made = memory_zeroed(1, sizeof *made);
  Status status = !made  ? status_no_memory("a state")
                  : keep ? app_loop_state_keep(&keep->loop, &made->state)
                         : app_loop_state_read(&of->loop, &made->state, path);
  if (status) tetlap_run_state_free(made);
  if (!status) *state = made;
  return status;
}

int tetlap_run_keep(TetlapRun *run, TetlapRunState **state) {
  *state = NULL;
  Status status = enter(run);
  return status ? code_of(status) : leave(run, make_state(state, run, NULL, NULL));
}

static Status restore(TetlapRun *run, const TetlapRunState *state) {
  TRY(check_given(state, "the state"));
  return app_loop_state_restore(&run->loop, &state->state);
}

int tetlap_run_restore(TetlapRun *run, const TetlapRunState *state) {
  Status status = enter(run);
  return status ? code_of(status) : leave(run, restore(run, state));
}

void tetlap_run_state_free(TetlapRunState *state) {
  if (state) app_loop_state_destroy(&state->state);
  memory_free(state);
}

static Status write_state(const TetlapRun *run, const TetlapRunState *state, const char *path) {
  TRY(check_open(run));
  TRY(check_given(state, "the state"));
  TRY(check_given(path, "a file's name"));
  return app_loop_state_write(&run->loop, &state->state, path);
}

int tetlap_run_state_write(const TetlapRun *run, const TetlapRunState *state, const char *path) {
  return code_of(write_state(run, state, path));
}

int tetlap_run_state_read(const TetlapRun *run, TetlapRunState **state, const char *path) {
  *state = NULL;
  Status status = check_open(run);
  if (!status) status = check_given(path, "a file's name");
  return code_of(status ? status : make_state(state, NULL, run, path));
}
