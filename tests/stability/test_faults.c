// SPDX-License-Identifier: GPL-3.0-or-later
// What a run does when something breaks within it: a force or a state that is no number, a factorisation or a
// solve that fails at its k-th call, an overlap model that refuses one pair, a file that cannot be opened,
// written or put into its place. Either the run goes on with a smaller step and comes to the same end, or it
// ends with an error that says where, when and what; what was in its folder before stays whole.
//
// The faults come in at link time (--wrap in tests/CMakeLists.txt): the program has no code for them.
#include <errno.h>
#include <glob.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/command/scene/run.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/model/build.h"
#include "fem/run/run.h"
#include "overlap/models.h"
#include "scene_text.h"
#include "suite.h"

// Where a fault strikes: at the call `first` of its kind, counted from 1, and at `count` calls from there. 0:
// never.
typedef struct Strike {
  long first, count;
  long calls, struck; // so far
} Strike;

enum { FOR_GOOD = 1000000000 };

static bool strikes(Strike *strike) {
  long call = ++strike->calls;
  bool now = strike->first > 0 && call >= strike->first && call < strike->first + strike->count;
  strike->struck += now;
  return now;
}

static struct {
  Strike force, energy, state, factorise, solve, pair, open, rename;
  bool is_fatal;     // of factorise: not to be tried again
  bool is_full_disk; // of open: the file opens, and takes no byte
  const char *event; // a command of the shell, run once in the middle of the run; NULL: none
  long event_call;   // of state: when
} fault;

static void forget_faults(void) {
  memset(&fault, 0, sizeof fault);
}

// A force and an energy of nothing, until they are no numbers.

static bool is_wanted(const FemSceneDef *scene) {
  (void)scene;
  return true;
}

static Status create_nothing(void **self, const FemModel *model) {
  (void)model;
  *self = &fault;
  return STATUS_OK;
}

static Status add_force(void *self, const FemState *state, double *force) {
  (void)self, (void)state;
  if (strikes(&fault.force)) force[3 * 9 + 2] = NAN;
  return STATUS_OK;
}

static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  (void)self, (void)state;
  if (strikes(&fault.energy)) energy->elastic = NAN;
  return STATUS_OK;
}

static void destroy_nothing(void *self) {
  (void)self;
}

static const FemEffectOps broken_effect = {.name = "broken",
                                           .help = "for tests",
                                           .is_wanted = is_wanted,
                                           .create = create_nothing,
                                           .add_force = add_force,
                                           .add_energy = add_energy,
                                           .destroy = destroy_nothing};

const FemEffectOps *const *__real_fem_effect_list(int *count);
const FemEffectOps *const *__wrap_fem_effect_list(int *count);

const FemEffectOps *const *__wrap_fem_effect_list(int *count) {
  static const FemEffectOps *all[FEM_MAX_EFFECTS];
  const FemEffectOps *const *list = __real_fem_effect_list(count);
  ck_assert_int_lt(*count, FEM_MAX_EFFECTS);
  memcpy(all, list, (size_t)*count * sizeof *all);
  all[(*count)++] = &broken_effect;
  return all;
}

// The state that a step leads to.

Status __real_fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v);
Status __wrap_fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v);

Status __wrap_fem_integrator_at(FemIntegrator *integrator, double time, const double **u, const double **v) {
  TRY(__real_fem_integrator_at(integrator, time, u, v));
  if (fault.event && fault.state.calls == fault.event_call) {
    ck_assert_int_eq(system(fault.event), 0);
    fault.event = NULL;
  }
  if (strikes(&fault.state)) ((double *)*u)[5] = NAN; // the integrator's own array, as a stray write would do
  return STATUS_OK;
}

// A solver that fails at will.

static const FemSolverOps *sound;
static FemSolverOps broken_solver;

static Status factorise(void *self, const FemMatrix *stiffness, const FemMatrix *damping, const double *mass,
                        double c) {
  if (!strikes(&fault.factorise)) return sound->factorise(self, stiffness, damping, mass, c);
  return status_fail(fault.is_fatal ? STATUS_SOLVER : STATUS_RETRY, "the matrix was broken on purpose");
}

static Status solve(void *self, const double *b, double *x) {
  if (!strikes(&fault.solve)) return sound->solve(self, b, x);
  return status_fail(STATUS_RETRY, "the solution was broken on purpose");
}

const FemSolverOps *__real_fem_solver_ops(FemSolverKind kind);
const FemSolverOps *__wrap_fem_solver_ops(FemSolverKind kind);

const FemSolverOps *__wrap_fem_solver_ops(FemSolverKind kind) {
  sound = __real_fem_solver_ops(kind);
  broken_solver = *sound;
  broken_solver.factorise = factorise;
  broken_solver.solve = solve;
  return &broken_solver;
}

// An overlap model that refuses one pair.

static const OverlapOps *true_model;
static OverlapOps broken_model;

static Status eval_pair(const void *self, const double pair[24], const OverlapAnswer *answer) {
  if (strikes(&fault.pair)) return status_fail(STATUS_SOLVER, "the pair was refused on purpose");
  return true_model->eval_pair(self, pair, answer);
}

Status __real_overlap_models_create(OverlapModel *model, const char *word);
Status __wrap_overlap_models_create(OverlapModel *model, const char *word);

Status __wrap_overlap_models_create(OverlapModel *model, const char *word) {
  TRY(__real_overlap_models_create(model, word));
  true_model = model->ops;
  broken_model = *true_model;
  broken_model.eval_pair = eval_pair;
  broken_model.eval_batch = NULL;
  model->ops = &broken_model;
  return STATUS_OK;
}

// Files that do not open, take nothing, or cannot be put into their place.

FILE *__real_fopen(const char *path, const char *mode);
FILE *__wrap_fopen(const char *path, const char *mode);
int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

FILE *__wrap_fopen(const char *path, const char *mode) {
  bool writes = mode[0] == 'w' || strchr(mode, '+');
  if (!writes || !strikes(&fault.open)) return __real_fopen(path, mode);
  if (fault.is_full_disk) return __real_fopen("/dev/full", mode);
  errno = EACCES;
  return NULL;
}

int __wrap_rename(const char *from, const char *to) {
  if (!strikes(&fault.rename)) return __real_rename(from, to);
  errno = EROFS;
  return -1;
}

// A block falls a millimetre onto another: rest, then contact.
static const char falling[] = "bodies:\n"
                              "  - {name: lower, mesh: {box: {size: [.1, .1, .1], cells: [2, 2, 1]}}, fixed: "
                              "[{box: {min: [-1, -1, -1], max: "
                              "[1, 1, 1e-9]}}],\n"
                              "     material: {young: 1e5, poisson: .3, density: 1000}}\n"
                              "  - {name: upper, mesh: {box: {size: [.08, .08, .08], cells: 1}}, place: "
                              "{translate: [.011, .012, .101]},\n"
                              "     material: {young: 1e5, poisson: .3, density: 1000, damping: .01}}\n"
                              "effects: {gravity: [0, 0, -9.81]}\n"
                              "contact: {potential: nodal, stiffness: 2e5, overlap: clip-scalar}\n"
                              "time: {end: .06}\n"
                              "output: {frames: 4, checkpoint: {frames: 2}}\n";
// A beam bent by its weight.
static const char still[] = "bodies:\n"
                            "  - {name: beam, mesh: {box: {size: [.4, .1, .1], cells: [4, 1, 1]}}, fixed: "
                            "[{box: {min: [-1, -1, -1], max: "
                            "[1e-9, 1, 1]}}],\n"
                            "     material: {law: neo_hookean, young: 1e5, poisson: .3, density: 1000}}\n"
                            "effects: {gravity: [0, 0, -9.81]}\n"
                            "time: {end: 1, static: true}\n"
                            "output: {frames: 2}\n";

typedef struct Run {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result;
  Status status;
} Run;

static void run(Run *run, const char *text) {
  *run = (Run){0};
  ck_assert_ok(scene_text_read("faults.yaml", text, strlen(text), &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
  FemRunOptions options = {.keep_trajectory = true};
  run->status = fem_run(&run->model, &options, &run->result);
}

static void end(Run *run) {
  fem_run_result_destroy(&run->result);
  fem_model_destroy(&run->model);
  fem_scene_destroy(&run->scene);
}

static void check_message(const char *word) {
  ck_assert_msg(strstr(status_message(), word), "the message lacks '%s': %s", word, status_message());
}

// Two runs end at the same place, to what a run with other steps may differ: a share of the 10 mm that things
// move.
static void check_same_end(const Run *a, const Run *b) {
  const FemRunResult *r = &a->result, *s = &b->result;
  ck_assert_int_eq(r->trajectory.frame_count, s->trajectory.frame_count);
  size_t values = 3 * (size_t)r->trajectory.vertex_count,
         last = (size_t)(r->trajectory.frame_count - 1) * values;
  for (size_t i = 0; i < values; i++)
    ck_assert_near(r->trajectory.positions[last + i], s->trajectory.positions[last + i], 2e-4);
  ck_assert(isfinite(s->energy.audit.total));
}

// Runs `text` with the fault at call 1, then at call 2 …, in `rounds` steps through all the calls that a
// sound run makes; each must come to the sound run's end, after steps that were tried again.
static void check_recovery(const char *text, Strike *strike, int rounds) {
  Run whole;
  run(&whole, text);
  ck_assert_msg(whole.status == STATUS_OK, "%s", status_message());
  ck_assert(whole.result.contact.pairs_max > 0 || !whole.scene.contact.is_on); // what falls does land
  long calls = strike->calls;
  ck_assert_int_ge(calls, rounds);
  for (int k = 0; k < rounds; k++) {
    forget_faults();
    *strike = (Strike){.first = 1 + (calls - 1) * (k + 1) / rounds, .count = 1};
    Run broken;
    run(&broken, text);
    ck_assert_int_eq(strike->struck, 1);
    ck_assert_msg(broken.status == STATUS_OK, "call %ld of %ld: %s", strike->first, calls, status_message());
    check_same_end(&whole, &broken);
    end(&broken);
  }
  end(&whole);
}

START_TEST(a_factorisation_that_fails_once_is_passed_by_a_smaller_step) {
  check_recovery(falling, &fault.factorise, 12);
}
END_TEST

START_TEST(a_solve_that_fails_once_is_passed_by_a_smaller_step) {
  check_recovery(falling, &fault.solve, 12);
}
END_TEST

START_TEST(a_static_scene_passes_a_factorisation_that_fails_once) {
  check_recovery(still, &fault.factorise, 3);
}
END_TEST

START_TEST(a_state_that_is_no_number_once_is_taken_back) {
  check_recovery(falling, &fault.state, 12);
}
END_TEST

// From the k-th call on: an error at that time, which names what is broken.
static void check_error(const char *text, Strike *strike, long first, int code, const char *const *words) {
  *strike = (Strike){.first = first, .count = FOR_GOOD};
  Run broken;
  run(&broken, text);
  ck_assert_int_eq(status_exit_code(broken.status), code);
  ck_assert_int_gt(strike->struck, 0);
  for (; *words; words++) check_message(*words);
  ck_assert(broken.result.end_time < broken.scene.end);
  end(&broken);
}

START_TEST(factorisations_that_keep_failing_end_the_run_with_time_and_advice) {
  static const char *const words[] = {"at t = 0.0", "broken on purpose", "of body '", "Try", NULL};
  check_error(falling, &fault.factorise, 12, 70, words);
}
END_TEST

START_TEST(a_factorisation_that_is_beyond_repair_ends_the_run_at_once) {
  static const char *const words[] = {"at t = 0.0", "broken on purpose", NULL};
  fault.is_fatal = true;
  check_error(falling, &fault.factorise, 12, 70, words);
  ck_assert_int_eq(fault.factorise.struck, 1);
}
END_TEST

START_TEST(a_static_scene_whose_factorisations_keep_failing_says_when) {
  static const char *const words[] = {"t = ", "broken on purpose", NULL};
  check_error(still, &fault.factorise, 3, 70, words);
}
END_TEST

START_TEST(a_force_that_is_no_number_names_its_effect_and_vertex) {
  static const char *const words[] = {"at t = 0.0", "the force on vertex 9 of body 'lower'",
                                      "effect 'broken'", NULL};
  check_error(falling, &fault.force, 60, 70, words);
}
END_TEST

START_TEST(a_static_force_that_is_no_number_names_its_effect) {
  static const char *const words[] = {"the force on vertex 9 of body 'beam'", "effect 'broken'", NULL};
  check_error(still, &fault.force, 4, 70, words);
}
END_TEST

START_TEST(a_state_that_stays_no_number_names_its_vertex) {
  static const char *const words[] = {"at t = 0.0", "position of vertex", "body 'lower'", NULL};
  check_error(falling, &fault.state, 20, 70, words);
}
END_TEST

START_TEST(an_energy_that_is_no_number_once_is_taken_back) {
  check_recovery(falling, &fault.energy, 6);
}
END_TEST

START_TEST(an_energy_that_stays_no_number_is_named) {
  static const char *const words[] = {"at t = 0.0", "the elastic energy is not a number", NULL};
  check_error(falling, &fault.energy, 20, 70, words);
}
END_TEST

START_TEST(a_pair_that_the_model_refuses_is_named) {
  static const char *const words[] = {"at t = 0",    "element ",           "of 'lower'", "of 'upper'",
                                      "clip-scalar", "refused on purpose", NULL};
  check_error(falling, &fault.pair, 1, 70, words);
  forget_faults();
  check_error(falling, &fault.pair, 500, 70, words);
}
END_TEST

// Files.

static char folder[64];

static void write_scene(const char *text) {
  char path[128];
  snprintf(path, sizeof path, "%s/scene.yaml", folder);
  FILE *file = fopen(path, "w");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  ck_assert_int_eq(fclose(file), 0);
  forget_faults(); // which counted this file
}

static void make_folder(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_faults_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
  write_scene(falling);
}

static int shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
static int shell(const char *format, ...) {
  char command[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(command, sizeof command, format, arguments);
  va_end(arguments);
  int state = system(command);
  return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

static void remove_folder(void) {
  ck_assert_int_eq(shell("rm -r %s", folder), 0);
}

// The whole command `tetlap run`, in this process.
static Status run_command(const char *directory) {
  char scene[128], target[128];
  snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
  snprintf(target, sizeof target, "%s/%s", folder, directory);
  AppRunOptions options = {.job = {.scene_path = scene,
                                   .directory = target,
                                   .overrides = {"output.vtu=true", "output.checkpoint.seconds=0"},
                                   .override_count = 2}};
  return app_run_execute(&options);
}

// Whether every frame of the folder is, to the byte, one that a whole run writes, and nothing is half
// written; returns how many frames there are.
static int check_whole(const char *directory) {
  char pattern[256];
  glob_t frames;
  snprintf(pattern, sizeof pattern, "%s/%s/frame_*.vtu", folder, directory);
  int found = glob(pattern, 0, NULL, &frames);
  ck_assert(found == 0 || found == GLOB_NOMATCH);
  int count = (int)frames.gl_pathc;
  for (int k = 0; k < count; k++)
    ck_assert_int_eq(
        shell("cmp %s %s/whole/%s", frames.gl_pathv[k], folder, strrchr(frames.gl_pathv[k], '/') + 1), 0);
  globfree(&frames);
  ck_assert_int_eq(shell("cd %s/%s && ! ls | grep -q part", folder, directory), 0);
  return count;
}

// _i: does not open, takes nothing, cannot be renamed. At each file of the run in its turn, in a folder where
// a run has been before: an error that names the file and the system's reason; what is there is whole.
START_TEST(a_file_that_cannot_be_written_is_named_and_nothing_is_left_half) {
  static const char *const reasons[] = {"Permission denied", "No space left", "Read-only file system"};
  Strike *strike = _i == 2 ? &fault.rename : &fault.open;
  ck_assert_ok(run_command("whole"));
  long calls = strike->calls;
  ck_assert_int_gt(calls, 12); // frames, their list, history, checkpoints, summary, manifest
  ck_assert_int_eq(shell("cp -r %s/whole %s/again", folder, folder), 0);
  int frames = check_whole("whole"), compared = 0;
  ck_assert_int_ge(frames, 4);
  for (long k = 1; k <= calls; k++) {
    forget_faults();
    fault.is_full_disk = _i == 1;
    *strike = (Strike){.first = k, .count = 1};
    Status status = run_command("again");
    // progress.json is written by the clock, so a run may have fewer files than the first.
    if (status == STATUS_OK && strike->struck == 0 && k > 12) break;
    ck_assert_msg(status == STATUS_IO, "file %ld: %d: %s", k, (int)status, status_message());
    ck_assert_int_eq(strike->struck, 1);
    check_message(reasons[_i]);
    check_message("/again/");
    compared += check_whole("again");
  }
  // A failure strikes at each file in its turn: frames of both the earlier and the failed run were compared.
  ck_assert_int_gt(compared, frames);
}
END_TEST

// The checkpoint of a run whose files have been replaced would be resumed into the wrong ones. _i: the new
// run fails before its first file, at its first, at a later one.
START_TEST(a_new_run_takes_away_the_checkpoint_of_the_files_that_it_replaces) {
  ck_assert_ok(run_command("again"));
  ck_assert_int_eq(shell("echo of another run > %s/again/checkpoint.h5", folder), 0);
  forget_faults();
  if (_i == 0) fault.energy = (Strike){.first = 1, .count = FOR_GOOD};
  if (_i > 0) fault.open = (Strike){.first = _i, .count = FOR_GOOD};
  ck_assert_int_ne(run_command("again"), STATUS_OK);
  ck_assert_int_eq(shell("test -e %s/again/checkpoint.h5", folder), _i == 0 ? 0 : 1);
}
END_TEST

// What happens around a run.

static void happen(long call, char *command, size_t size, const char *format) {
  forget_faults();
  snprintf(command, size, format, folder, folder, folder);
  fault.event = command;
  fault.event_call = call;
}

START_TEST(a_folder_that_vanishes_during_a_run_is_named) {
  char command[256];
  happen(20, command, sizeof command, "rm -r %s/gone");
  ck_assert_int_eq(run_command("gone"), STATUS_IO);
  ck_assert_ptr_null(fault.event); // it did happen
  check_message("/gone/");
  check_message("No such file or directory");
  ck_assert_int_ne(shell("test -e %s/gone", folder), 0);
}
END_TEST

// A block falls onto a roof from a file, by a network's volumes.
static const char from_files[] =
    "bodies:\n"
    "  - {name: lower, mesh: block.mesh, fixed: [{box: {min: [-1, -1, -1], max: [1, 1, 1e-9]}}],\n"
    "     material: {young: 1e5, poisson: .3, density: 1000}}\n"
    "  - {name: upper, mesh: {box: {size: [.05, .05, .05], cells: 1}}, place: {translate: [-.025, -.025, "
    ".1202]},\n"
    "     material: {young: 1e5, poisson: .3, density: 1000, damping: .01}}\n"
    "effects: {gravity: [0, 0, -9.81]}\n"
    "contact: {potential: nodal, stiffness: 2e5, overlap: w.safetensors}\n"
    "time: {end: .03}\n"
    "output: {frames: 4, checkpoint: {frames: 1}}\n";

static void write_inputs(void) {
  write_scene(from_files);
  ck_assert_int_eq(shell("cp %s/net/weights/geo.safetensors %s/w.safetensors", TETLAP_SOURCE_DIR, folder), 0);
  ck_assert_int_eq(shell("cp %s/meshes/wedge.mesh %s/block.mesh", TETLAP_SOURCE_DIR, folder), 0);
}

// _i: scene, mesh, weights. A look at the scene finds all well; then the file is gone.
START_TEST(an_input_that_vanishes_before_the_run_is_named) {
  static const char *const files[] = {"scene.yaml", "block.mesh", "w.safetensors"};
  write_inputs();
  char scene[128];
  snprintf(scene, sizeof scene, "%s/scene.yaml", folder);
  AppJobOptions options = {.scene_path = scene, .directory = folder};
  AppJob job;
  ck_assert_ok(app_job_open(&job, &options, NULL, NULL));
  app_job_close(&job);
  ck_assert_int_eq(shell("rm %s/%s", folder, files[_i]), 0);
  ck_assert_int_eq(run_command("run"), STATUS_IO);
  check_message(files[_i]);
  ck_assert_int_ne(shell("ls %s/run/frame* 2>/dev/null", folder), 0);
}
END_TEST

// _i: what happens. The run has read what it needs, and goes on over its checkpoints as if nothing were.
START_TEST(inputs_that_change_during_a_run_do_not_touch_it) {
  static const char *const events[] = {"rm %s/scene.yaml %s/block.mesh", "rm %s/w.safetensors",
                                       "echo nonsense > %s/w.safetensors; echo nonsense > %s/block.mesh"};
  write_inputs();
  ck_assert_ok(run_command("whole"));
  ck_assert_int_eq(shell("grep -q '\"contact_force_max\": [0-9.]*[1-9]' %s/whole/summary.json", folder), 0);
  char command[256];
  happen(10, command, sizeof command, events[_i]);
  ck_assert_ok(run_command("bare"));
  ck_assert_ptr_null(fault.event);
  ck_assert_int_eq(shell("cd %s && cmp whole/history.csv bare/history.csv", folder), 0);
  ck_assert_int_eq(shell("cd %s && tail -1 whole/history.csv | grep -q '^0.03,'", folder), 0);
}
END_TEST

// The disk stays full: the same, though the last checkpoint cannot be written either. What is left of the
// earlier run is whole; its summary does not stand beside frames that are not its own.
START_TEST(a_disk_that_stays_full_leaves_nothing_half_written) {
  int compared = 0;
  ck_assert_ok(run_command("whole"));
  for (long k = 1; k < 12; k += 3) {
    forget_faults();
    fault.is_full_disk = true;
    fault.open = (Strike){.first = k, .count = FOR_GOOD};
    ck_assert_int_eq(shell("rm -rf %s/again; cp -r %s/whole %s/again", folder, folder, folder), 0);
    ck_assert_int_eq(run_command("again"), STATUS_IO);
    check_message("No space left");
    compared += check_whole("again");
    ck_assert_int_eq(
        shell("cd %s && [ ! -e again/summary.json ] && cmp whole/manifest.json again/manifest.json && "
              "{ [ ! -e again/history.csv ] || head -c $(stat -c %%s again/history.csv) whole/history.csv | "
              "cmp - again/history.csv; }",
              folder),
        0);
  }
  ck_assert_int_gt(compared, 0);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("faults");
  tcase_add_checked_fixture(test_case, make_folder, remove_folder);
  tcase_add_test(test_case, a_factorisation_that_fails_once_is_passed_by_a_smaller_step);
  tcase_add_test(test_case, a_solve_that_fails_once_is_passed_by_a_smaller_step);
  tcase_add_test(test_case, a_static_scene_passes_a_factorisation_that_fails_once);
  tcase_add_test(test_case, a_state_that_is_no_number_once_is_taken_back);
  tcase_add_test(test_case, factorisations_that_keep_failing_end_the_run_with_time_and_advice);
  tcase_add_test(test_case, a_factorisation_that_is_beyond_repair_ends_the_run_at_once);
  tcase_add_test(test_case, a_static_scene_whose_factorisations_keep_failing_says_when);
  tcase_add_test(test_case, a_force_that_is_no_number_names_its_effect_and_vertex);
  tcase_add_test(test_case, a_static_force_that_is_no_number_names_its_effect);
  tcase_add_test(test_case, a_state_that_stays_no_number_names_its_vertex);
  tcase_add_test(test_case, an_energy_that_is_no_number_once_is_taken_back);
  tcase_add_test(test_case, an_energy_that_stays_no_number_is_named);
  tcase_add_test(test_case, a_pair_that_the_model_refuses_is_named);
  tcase_add_loop_test(test_case, a_file_that_cannot_be_written_is_named_and_nothing_is_left_half, 0, 3);
  tcase_add_loop_test(test_case, a_new_run_takes_away_the_checkpoint_of_the_files_that_it_replaces, 0, 3);
  tcase_add_test(test_case, a_folder_that_vanishes_during_a_run_is_named);
  tcase_add_loop_test(test_case, an_input_that_vanishes_before_the_run_is_named, 0, 3);
  tcase_add_loop_test(test_case, inputs_that_change_during_a_run_do_not_touch_it, 0, 3);
  tcase_add_test(test_case, a_disk_that_stays_full_leaves_nothing_half_written);
  return suite_run("faults", test_case, 60);
}
