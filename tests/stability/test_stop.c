// SPDX-License-Identifier: GPL-3.0-or-later
// Runs that are stopped, run again into the same folder, or cannot write what they print.
#include "scene.h"

#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/run/checkpoint/checkpoint.h"
#include "fem/run/checkpoint/run_checkpoint.h"

static char folder[64];

static void make_folder(void) {
  strcpy(folder, "/tmp/tetlap_stop_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  ck_assert_int_eq(system(command), 0);
}

// A flag that is up stops a run in the middle of an evaluation, before any step of load is through.
START_TEST(a_static_run_stops_within_an_evaluation) {
  SceneRun run;
  volatile sig_atomic_t stop = 1;
  scene_open(
      &run, "cantilever",
      (const char *const[]){"time={end: 1, static: true}", "bodies.beam.mesh.box.cells=[6, 2, 2]", NULL});
  FemRunOptions options = {.stop = &stop};
  ck_assert_int_eq(fem_run(&run.model, &options, &run.result), STATUS_INTERRUPTED);
  ck_assert_double_eq(run.result.end_time, 0);
  ck_assert_ptr_nonnull(strstr(status_message(), "interrupted at t = 0 s"));
  scene_close(&run);
}
END_TEST

typedef struct Stopper {
  volatile sig_atomic_t flag;
  double time; // at which it is raised [s]
} Stopper;

static Status stop_at(void *self, const FemRunProgress *progress) {
  Stopper *stopper = self;
  if (progress->time >= stopper->time) stopper->flag = 1;
  return STATUS_OK;
}

START_TEST(an_early_stop_leaves_a_checkpoint_of_what_was_done) {
  SceneRun run;
  Stopper stopper = {.time = 0.06};
  FemCheckpoint checkpoint;
  char path[96];
  make_folder();
  scene_open(&run, "drop",
             (const char *const[]){"output.frames=100", "time.end=0.5", "time.max_step=5e-4", NULL});
  FemRunOptions options = {
      .stop = &stopper.flag, .observe = stop_at, .observer = &stopper, .directory = folder};
  ck_assert_int_eq(fem_run(&run.model, &options, &run.result), STATUS_INTERRUPTED);
  ck_assert_int_lt((int)run.result.integrator.steps, (int)fem_run_checkpoint_steps(run.model.free_count));
  snprintf(path, sizeof path, "%s/%s", folder, FEM_CHECKPOINT_FILE);
  ck_assert_ok(fem_checkpoint_read(&checkpoint, path));
  ck_assert_int_ge(checkpoint.next_frame, 4);
  ck_assert_double_gt(checkpoint.time, 0);
  fem_checkpoint_destroy(&checkpoint);
  scene_close(&run);
  remove_folder();
}
END_TEST

// An equilibrium may take minutes: few are done again.
START_TEST(a_static_run_that_is_stopped_leaves_its_last_equilibria) {
  SceneRun run;
  Stopper stopper = {.time = 0.5};
  FemCheckpoint checkpoint;
  char path[96];
  make_folder();
  scene_open(&run, "patch", (const char *const[]){"output.frames=12", NULL});
  FemRunOptions options = {
      .stop = &stopper.flag, .observe = stop_at, .observer = &stopper, .directory = folder};
  ck_assert_int_eq(fem_run(&run.model, &options, &run.result), STATUS_INTERRUPTED);
  ck_assert_int_ge((int)run.result.integrator.steps, 6);
  snprintf(path, sizeof path, "%s/%s", folder, FEM_CHECKPOINT_FILE);
  ck_assert_ok(fem_checkpoint_read(&checkpoint, path));
  ck_assert_int_ge((int)checkpoint.so_far.integrator.steps, (int)run.result.integrator.steps - 4);
  fem_checkpoint_destroy(&checkpoint);
  scene_close(&run);
  remove_folder();
}
END_TEST

// A checkpoint is of one state, however long after it the run is stopped.
START_TEST(a_checkpoint_has_nothing_of_what_came_after_it) {
  FemCheckpoint checkpoints[2];
  char path[96];
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    Stopper stopper = {.time = k ? 0.45 : 0.4};
    make_folder();
    scene_open(&run, "patch",
               (const char *const[]){
                   "output.frames=12", "bodies.upper.loads=[]",
                   "bodies.upper.driven=[{group: z_max, components: [z], velocity: [0, 0, -1e-4]}]", NULL});
    FemRunOptions options = {
        .stop = &stopper.flag, .observe = stop_at, .observer = &stopper, .directory = folder};
    ck_assert_int_eq(fem_run(&run.model, &options, &run.result), STATUS_INTERRUPTED);
    snprintf(path, sizeof path, "%s/%s", folder, FEM_CHECKPOINT_FILE);
    ck_assert_ok(fem_checkpoint_read(&checkpoints[k], path));
    scene_close(&run);
    remove_folder();
  }
  const FemCheckpoint *early = &checkpoints[0], *late = &checkpoints[1];
  ck_assert_double_gt(early->driven_work, 0);
  ck_assert_double_gt(early->so_far.cost.work_s, 0);
  ck_assert_double_eq(late->time, early->time);
  ck_assert_double_eq(late->force_scale, early->force_scale);
  ck_assert_double_eq(late->driven_work, early->driven_work);
  ck_assert_int_eq((int)late->so_far.integrator.steps, (int)early->so_far.integrator.steps);
  ck_assert_mem_eq(&late->audit, &early->audit, sizeof early->audit);
  for (int k = 0; k < 2; k++) fem_checkpoint_destroy(&checkpoints[k]);
}
END_TEST

// Where the integrator begins anew for a checkpoint does not hang on them.
START_TEST(a_run_is_the_same_however_many_frames_it_writes) {
  double lost[3];
  long long steps[3];
  const char *const frames[] = {"output.frames=2", "output.frames=30", "output.frames=173"};
  for (int k = 0; k < 3; k++) {
    SceneRun run;
    scene_run(&run, "drop", (const char *const[]){frames[k], "time.end=0.3", NULL});
    lost[k] = fem_audit_lost(&run.result.energy.audit);
    steps[k] = run.result.integrator.steps;
    ck_assert_double_gt(run.result.contact.force_max, 0);
    scene_close(&run);
  }
  ck_assert_int_gt((int)steps[0], 100);
  for (int k = 1; k < 3; k++) {
    ck_assert_int_eq((int)steps[k], (int)steps[0]);
    ck_assert_double_eq(lost[k], lost[0]);
  }
}
END_TEST

// What a command prints, both streams; returns its exit code.
static int print(const char *words, char *text, size_t size) {
  char command[1024];
  snprintf(command, sizeof command, TETLAP_PROGRAM " %s 2>&1", words);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  text[fread(text, 1, size - 1, pipe)] = 0;
  int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static bool has_file(const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return file_exists(path);
}

START_TEST(a_second_run_into_a_folder_leaves_nothing_of_the_first) {
  static char text[1 << 14];
  char words[512];
  make_folder();
  for (int frames = 12; frames >= 4; frames -= 8) {
    snprintf(words, sizeof words, "run %s/tests/scenes/free_fall.yaml -o %s --set output.frames=%d",
             TETLAP_SOURCE_DIR, folder, frames);
    ck_assert_int_eq(print(words, text, sizeof text), 0);
    ck_assert(has_file("frame_00004.vtu"));
    ck_assert_int_eq(has_file("frame_00012.vtu"), frames == 12);
    ck_assert_int_eq(strstr(text, "its 13 frames were removed") != NULL, frames == 4);
  }
  remove_folder();
}
END_TEST

START_TEST(what_cannot_be_printed_is_an_error) {
  static char text[1 << 14];
  const char *words = "check -j " TETLAP_SOURCE_DIR "/tests/scenes/free_fall.yaml > /dev/full";
  ck_assert_int_eq(print(words, text, sizeof text), status_exit_code(STATUS_IO));
  make_folder();
  char run[512];
  snprintf(run, sizeof run, "run -q -j %s/tests/scenes/free_fall.yaml -o %s > /dev/full", TETLAP_SOURCE_DIR,
           folder);
  ck_assert_int_eq(print(run, text, sizeof text), status_exit_code(STATUS_IO));
  remove_folder();
}
END_TEST

// The columns of history.csv whose title is `title`; returns how many rows.
static int read_column(const char *title, double *values, int most) {
  static char line[1 << 16];
  char path[96];
  snprintf(path, sizeof path, "%s/history.csv", folder);
  FILE *stream = fopen(path, "r");
  ck_assert_ptr_nonnull(stream);
  int place = -1, rows = 0;
  for (int k = 0; fgets(line, sizeof line, stream); k++) {
    char *rest = line, *word;
    for (int c = 0; (word = strsep(&rest, ",\n")); c++) {
      if (k == 0 && strcmp(word, title) == 0) place = c;
      if (k > 0 && c == place && rows < most) values[rows++] = atof(word);
    }
  }
  fclose(stream);
  ck_assert_int_ge(place, 0);
  return rows;
}

// A row per step holds the largest force of the run; a row per frame holds it as the peak since the row
// before.
START_TEST(no_peak_of_a_force_is_missed) {
  enum { MOST = 100000 };
  static double force[MOST], steps[MOST];
  const char *const rows[] = {"output.history=steps", "output.history=frames"};
  for (int k = 0; k < 2; k++) {
    SceneRun run;
    make_folder();
    scene_open(&run, "drop",
               (const char *const[]){rows[k], "output.vtu=false", "output.frames=7", "time.end=0.15", NULL});
    FemRunOptions options = {.directory = folder};
    ck_assert_ok(fem_run(&run.model, &options, &run.result));
    int count = read_column("contact_force_peak_N", force, MOST);
    read_column("steps", steps, MOST);
    double largest = 0;
    for (int i = 0; i < count; i++) largest = suite_larger(force[i], largest);
    ck_assert_double_gt(largest, 0);
    ck_assert_near(largest, run.result.contact.force_max, 1e-12 * largest);
    if (k == 0) ck_assert_int_eq(count, (int)run.result.integrator.steps + 1); // without those taken back
    if (k == 1) ck_assert_int_eq(count, 8);
    for (int i = 1; i < count; i++) ck_assert_double_ge(steps[i], steps[i - 1]);
    scene_close(&run);
    remove_folder();
  }
}
END_TEST

// A beam that hangs still from its clamp: what holds it is its weight, 5 kg at 1 m/s², and nothing aside.
START_TEST(what_holds_a_body_is_told) {
  static double z[8], x[8];
  SceneRun run;
  make_folder();
  scene_open(
      &run, "cantilever",
      (const char *const[]){"time={end: 1, static: true}", "bodies.beam.mesh.box.cells=[10, 2, 2]", NULL});
  FemRunOptions options = {.directory = folder};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  int rows = read_column("reaction_beam_fixed_0_z_N", z, 8);
  read_column("reaction_beam_fixed_0_x_N", x, 8);
  ck_assert_int_ge(rows, 2);
  ck_assert_near(z[rows - 1], 5, 1e-6);
  ck_assert_near(x[rows - 1], 0, 1e-6);
  scene_close(&run);
  remove_folder();
}
END_TEST

START_TEST(bodies_that_overlap_at_the_start_are_named) {
  static char text[1 << 14];
  char words[512];
  make_folder();
  const char *const commands[] = {"check", "run -o"};
  for (int k = 0; k < 4; k++) {
    snprintf(words, sizeof words, "%s %s %s/tests/scenes/drop.yaml --set time.end=1e-3 %s", commands[k % 2],
             k % 2 ? folder : "", TETLAP_SOURCE_DIR,
             k < 2 ? "--set bodies.block.place='{translate: [0, 0, -0.01]}'" : "");
    ck_assert_int_eq(print(words, text, sizeof text), 0);
    ck_assert_msg((strstr(text, "'block' and 'ground' overlap at the start") != NULL) == (k < 2), "%s", text);
  }
  remove_folder();
}
END_TEST

// Six cubes in a row, each in the next: three pairs are named, the other two are counted.
START_TEST(many_bodies_that_overlap_are_counted) {
  static char text[1 << 14];
  char words[512], path[256];
  make_folder();
  snprintf(path, sizeof path, "%s/row.yaml", folder);
  FILE *scene = fopen(path, "w");
  ck_assert_ptr_nonnull(scene);
  fputs("title: row\ntime: {end: 1e-6}\nbodies:\n", scene);
  for (int b = 0; b < 6; b++)
    fprintf(scene,
            "  - {name: c%d, mesh: {box: {size: [1, 1, 1], cells: 1}}, place: {translate: [%g, 0, 0]}, "
            "material: {young: 1e6, poisson: 0.3, density: 1000}}\n",
            b, .99 * b);
  fputs("contact: {}\n", scene);
  ck_assert_int_eq(fclose(scene), 0);
  snprintf(words, sizeof words, "check %s", path);
  ck_assert_int_eq(print(words, text, sizeof text), 0);
  ck_assert_msg(strstr(text, "'c2' and 'c3' overlap at the start") != NULL, "%s", text);
  ck_assert_ptr_null(strstr(text, "'c3' and 'c4' overlap"));
  ck_assert_msg(strstr(text, "2 more such pairs of bodies overlap at the start") != NULL, "%s", text);
  remove_folder();
}
END_TEST

START_TEST(progress_in_a_pipe_is_lines) {
  static char text[1 << 16];
  char words[512];
  make_folder();
  snprintf(words, sizeof words, "run %s/tests/scenes/drop.yaml -o %s", TETLAP_SOURCE_DIR, folder);
  ck_assert_int_eq(print(words, text, sizeof text), 0);
  ck_assert_ptr_nonnull(strstr(text, "\n50 %: t = "));
  ck_assert_ptr_null(strchr(text, '\r'));
  strncat(words, " -q --progress json", sizeof words - strlen(words) - 1);
  ck_assert_int_eq(print(words, text, sizeof text), 0);
  ck_assert_msg(strstr(text, "\"left_s\":") != NULL, "%s", text);
  remove_folder();
}
END_TEST

START_TEST(steps_that_never_end_are_refused) {
  FemSceneDef scene;
  const char *set[] = {"time.max_step=1e-30"};
  ck_assert_int_eq(app_scene_read(TETLAP_SOURCE_DIR "/tests/scenes/free_fall.yaml", set, 1, &scene),
                   STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), "max_step is below 1e-9 of end"));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("stop");
  tcase_add_test(cases, a_static_run_stops_within_an_evaluation);
  tcase_add_test(cases, a_static_run_that_is_stopped_leaves_its_last_equilibria);
  tcase_add_test(cases, a_checkpoint_has_nothing_of_what_came_after_it);
  tcase_add_test(cases, a_run_is_the_same_however_many_frames_it_writes);
  tcase_add_test(cases, an_early_stop_leaves_a_checkpoint_of_what_was_done);
  tcase_add_test(cases, a_second_run_into_a_folder_leaves_nothing_of_the_first);
  tcase_add_test(cases, what_cannot_be_printed_is_an_error);
  tcase_add_test(cases, no_peak_of_a_force_is_missed);
  tcase_add_test(cases, what_holds_a_body_is_told);
  tcase_add_test(cases, bodies_that_overlap_at_the_start_are_named);
  tcase_add_test(cases, many_bodies_that_overlap_are_counted);
  tcase_add_test(cases, progress_in_a_pipe_is_lines);
  tcase_add_test(cases, steps_that_never_end_are_refused);
  return suite_run("stop", cases, 60);
}
