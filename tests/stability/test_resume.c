// SPDX-License-Identifier: GPL-3.0-or-later
// A run that is stopped, killed, resumed, or given other threads writes what it would have written: the same
// frames, history and counts, to the last bit. The program itself is run, as a person would.
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "suite.h"

static char folder[64];

static void set_up(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_resume_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void tear_down(void) {
  char command[256];
  snprintf(command, sizeof command, "chmod -R u+w %s; rm -r %.60s", folder, folder);
  ck_assert_int_eq(system(command), 0);
}

// A scene in ten short frames, and what must show in its summary for the test to mean anything.
typedef struct Case {
  const char *scene, *set, *must_show;
} Case;

static const Case cases[] = {
    // Bodies in contact.
    {"tests/scenes/balls.yaml", "--set time.end=0.05", "\"contact_force_max\": "},
    // The other potential.
    {"tests/scenes/balls.yaml", "--set time.end=0.05 --set contact.friction=0 --set contact.potential=nodal",
     "\"contact_force_max\": "},
    // Friction, which has a history.
    {"tests/scenes/incline.yaml", "--set time.end=0.3", "\"friction_vertices\": "},
    {"tests/scenes/held.yaml", "--set time.end=0.2", "\"friction_vertices\": "},
    // The same from equilibrium to equilibrium.
    {"tests/scenes/drag.yaml", "--set time.end=0.4", "\"friction_vertices\": "},
    // A linear scene, assembled once.
    {"tests/scenes/cantilever.yaml", "--set time.end=0.02", "\"steps\": "},
    // Unknowns that are numbered anew.
    {"examples/21_release.yaml", "", "\"steps\": "},
    // Bodies that fall asleep and awake.
    {"tests/scenes/asleep.yaml", "", "\"bodies_awakened\": "},
    // History, at rest and in motion.
    {"examples/25_plastic_bar.yaml", "--set bodies.bar.mesh.box.cells=[8,2,2]", "\"yielded_elements\": "},
    {"examples/25_plastic_bar.yaml",
     "--set time.static=false --set time.end=0.02 --set 'bodies.bar.loads[0].force=[0,0,-2000]' --set "
     "'bodies.bar.loads[0].table=[[0,0],[0.01,1],[0.02,0]]' --set bodies.bar.mesh.box.cells=[8,2,2]",
     "\"yielded_elements\": "},
    {"examples/25_plastic_bar.yaml",
     "--set bodies.bar.element=quadratic --set time.static=false --set time.end=0.02 --set "
     "'bodies.bar.loads[0].force=[0,0,-2000]' --set 'bodies.bar.loads[0].table=[[0,0],[0.01,1],[0.02,0]]' "
     "--set "
     "bodies.bar.mesh.box.cells=[4,1,1]",
     "\"yielded_elements\": "},
    // Steps that end at knots, a checkpoint at one, and loads whose work is summed.
    {"tests/scenes/struck.yaml",
     "--set 'bodies.cube.loads[0].table=[[0.2,0],[0.20005,1],[0.2001,0],[0.4,0],[0.40005,1],[0.4001,0]]'",
     "\"load_work_J\": "},
    // An iterative solver, a network's volumes, several bodies.
    {"tests/scenes/stack.yaml", "--set solver.linear=pcg --set contact.overlap=clip --set time.end=0.05",
     "\"contact_pairs\": "},
    // A body of two materials, one of which yields, with a line through both.
    {"examples/25_plastic_bar.yaml",
     "--set bodies.bar.mesh.box.cells=[8,2,2] --set 'bodies.bar.materials=[{halfspace: {point: [0.25, 0, 0], "
     "normal: [-1, 0, 0]}, young: 5e9, poisson: 0.4, density: 1200}]' --set 'bodies.bar.lines=[{name: axis, from: "
     "[0, 0.02, 0.02], to: [0.5, 0.02, 0.02], points: 9}]'",
     "\"yielded_elements\": "},
    // Obstacles that move, and are written with every frame.
    {"tests/scenes/obstacle_shapes.yaml", "", "\"contact_force_max\": "},
};
enum { CASE_COUNT = sizeof cases / sizeof *cases };

// Starts the program on a command line of the shell; returns its process.
static pid_t start(const char *line) {
  pid_t process = fork();
  ck_assert_int_ge(process, 0);
  if (process == 0) {
    execl("/bin/sh", "sh", "-c", line, (char *)NULL);
    _exit(127);
  }
  return process;
}

static int wait_for(pid_t process) {
  int state;
  ck_assert_int_eq(waitpid(process, &state, 0), process);
  return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
}

static void print_run(char *line, size_t size, const Case *c, const char *name, const char *more) {
  snprintf(line, size,
           "exec %s run %s/%s -q -o %s/%s --threads 1 --set output.frames=10 --set output.vtu=true --set "
           "output.checkpoint.frames=2 --set output.checkpoint.seconds=0 %s %s 2>%s/log",
           TETLAP_PROGRAM, TETLAP_SOURCE_DIR, c->scene, folder, name, c->set, more, folder);
}

static int run(const Case *c, const char *name, const char *more) {
  char line[2048];
  print_run(line, sizeof line, c, name, more);
  return wait_for(start(line));
}

static int resume(const char *name, const char *more) {
  char line[512];
  snprintf(line, sizeof line, "exec %s resume %s/%s -q %s 2>%s/log", TETLAP_PROGRAM, folder, name, more,
           folder);
  return wait_for(start(line));
}

static char *read_text(const char *name, const char *file) {
  char path[256], *text;
  size_t size;
  snprintf(path, sizeof path, "%s/%s/%s", folder, name, file);
  ck_assert_ok(file_read(path, &text, &size));
  return text;
}

static void check_log(const char *word) {
  char *log = read_text(".", "log");
  ck_assert_msg(strstr(log, word), "the log lacks '%s': %s", word, log);
  memory_free(log);
}

// What a clock or a machine says: seconds, memory, threads.
static bool is_measured(const char *line) {
  static const char *const words[] = {
      "_s\":",         "phases",        "broad_phase",        "\"contact\": ", "\"forces\":",
      "\"assembly\":", "\"analysis\":", "\"factorisation\":", "\"solve\":",    "\"output\":",
      "\"other\":",    "\"start\":",    "\"layout\":",        "\"products\":", "\"integration\":",
      "\"measures\":", "peak_rss",      "bytes_max",          "\"threads\":"};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    if (strstr(line, words[k])) return true;
  const char *overlap = strstr(line, "\"overlap\": "); // the phase's seconds, or the model's name
  return overlap && !strstr(overlap, ": \"");
}

static void compare_counts(const char *a, const char *b) {
  char *texts[] = {read_text(a, "summary.json"), read_text(b, "summary.json")}, *rest[2];
  char *line[] = {strtok_r(texts[0], "\n", &rest[0]), strtok_r(texts[1], "\n", &rest[1])};
  int compared = 0;
  while (line[0] && line[1]) {
    if (!is_measured(line[0])) {
      ck_assert_str_eq(line[0], line[1]);
      compared++;
    }
    for (int k = 0; k < 2; k++) line[k] = strtok_r(NULL, "\n", &rest[k]);
  }
  ck_assert(!line[0] && !line[1]);
  ck_assert_int_gt(compared, 40);
  memory_free(texts[0]), memory_free(texts[1]);
}

// The same files, frames and history by the byte, and the same counts; the end state has seconds, too.
static void compare(const char *a, const char *b) {
  char command[512];
  snprintf(command, sizeof command, "diff -r -x summary.json -x manifest.json -x end.h5 %s/%s %s/%s", folder, a, folder,
           b);
  ck_assert_msg(system(command) == 0, "%s and %s differ", a, b);
  compare_counts(a, b);
}

static void run_whole(const Case *c) {
  ck_assert_int_eq(run(c, "whole", ""), 0);
  char *summary = read_text("whole", "summary.json"), *shown = strstr(summary, c->must_show);
  ck_assert_msg(shown, "%s has no %s", c->scene, c->must_show);
  ck_assert_double_gt(atof(shown + strlen(c->must_show)), 0); // it did occur
  memory_free(summary);
}

// Starts a run or resumes one, and kills it once it has written the frame; its exit code, −SIGKILL if it was
// killed in time.
static int kill_at(const char *line, const char *name, int frame) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s/frame_%05d.vtu", folder, name, frame);
  remove(path);
  pid_t process = start(line);
  int state = 0;
  while (!file_exists(path) && waitpid(process, &state, WNOHANG) == 0) usleep(500);
  kill(process, SIGKILL);
  return WIFEXITED(state) && state ? WEXITSTATUS(state) : wait_for(process);
}

// _i: case. The run is killed, the resumed run is killed, and what is then resumed comes to its end.
START_TEST(a_run_that_is_killed_and_resumed_is_the_same_to_the_last_bit) {
  const Case *c = &cases[_i];
  char line[2048], again[512];
  run_whole(c);
  print_run(line, sizeof line, c, "killed", "");
  snprintf(again, sizeof again, "exec %s resume %s/killed -q --threads 2 2>%s/log", TETLAP_PROGRAM, folder,
           folder);
  int killed = 0;
  for (int attempt = 0; attempt < 9 && killed == 0; attempt++) { // unless it was quicker than we
    killed += kill_at(line, "killed", 3) == -SIGKILL;
    if (killed > 0) kill_at(again, "killed", 6);
    char path[128];
    snprintf(path, sizeof path, "%s/killed/checkpoint.h5", folder);
    if (file_exists(path)) ck_assert_int_eq(resume("killed", ""), 0);
  }
  ck_assert_int_gt(killed, 0);
  compare("whole", "killed");
}
END_TEST

// _i: case; some of them, as the way is that of the kills. Stopped by a signal: exit code 130, a checkpoint,
// whole files.
START_TEST(a_run_that_is_stopped_and_resumed_is_the_same) {
  const Case *c = &cases[_i];
  char line[2300], run_line[2048];
  run_whole(c);
  print_run(run_line, sizeof run_line, c, "stopped", "");
  snprintf(line, sizeof line,
           "%s & p=$!; while [ ! -e %s/stopped/frame_00002.vtu ]; do sleep 0.002; done; kill -%s $p; wait $p",
           run_line + strlen("exec "), folder, _i % 2 ? "INT" : "TERM");
  int code = 0;
  for (int attempt = 0; attempt < 9 && code != 130; attempt++) {
    char frame[128];
    snprintf(frame, sizeof frame, "%s/stopped/frame_00002.vtu", folder);
    remove(frame);
    code = wait_for(start(line));
  }
  ck_assert_int_eq(code, 130);
  check_log("interrupted at t = ");
  ck_assert_int_eq(resume("stopped", ""), 0);
  compare("whole", "stopped");
}
END_TEST

// _i: case; of the others, the runs that were killed go on with two threads.
START_TEST(two_threads_write_what_one_writes) {
  ck_assert_int_eq(run(&cases[_i], "one", ""), 0);
  ck_assert_int_eq(run(&cases[_i], "two", "--threads 2"), 0);
  compare("one", "two");
}
END_TEST

START_TEST(two_runs_are_the_same) {
  ck_assert_int_eq(run(&cases[1], "one", ""), 0);
  ck_assert_int_eq(run(&cases[1], "again", ""), 0);
  compare("one", "again");
}
END_TEST

// Leaves the run at its beginning: the first checkpoint is that of the start.
static void leave_stopped(const char *scene) {
  char line[2048];
  snprintf(
      line, sizeof line,
      "%s run %s -q -o %s/stopped --set output.checkpoint.seconds=0 --set output.checkpoint.frames=1 "
      "2>%s/log & p=$!; while [ ! -e "
      "%s/stopped/checkpoint.h5 ] && kill -0 $p; do sleep 0.01; done; kill -9 $p; wait $p 2>/dev/null; true",
      TETLAP_PROGRAM, scene, folder, folder, folder);
  ck_assert_int_eq(system(line), 0);
}

static void copy_scene(char path[128]) {
  char command[512];
  snprintf(path, 128, "%s/scene.yaml", folder);
  snprintf(command, sizeof command,
           "cp %s/tests/scenes/incline.yaml %s && sed -i 's/contact: {/contact: {overlap: "
           "w.safetensors, /' %s && cp %s/net/weights/geo.safetensors %s/w.safetensors",
           TETLAP_SOURCE_DIR, path, path, TETLAP_SOURCE_DIR, folder);
  ck_assert_int_eq(system(command), 0);
}

START_TEST(what_differs_is_refused_by_name) {
  static const char *const changes[] = {"sed -i 's/poisson: 0.4/poisson: 0.3/' scene.yaml",
                                        "printf x >> w.safetensors",
                                        "rm w.safetensors",
                                        "sed -i 's/cells: .3, 3, 2./cells: [3, 3, 3]/' scene.yaml",
                                        "rm scene.yaml",
                                        "printf x >> stopped/checkpoint.h5"};
  static const char *const words[] = {"poisson was 0.4", "w.safetensors", "w.safetensors",
                                      "cells",           "scene.yaml",    "damaged"};
  for (int k = 0; k < 6; k++) {
    char scene[128], command[256];
    copy_scene(scene);
    leave_stopped(scene);
    snprintf(command, sizeof command, "cd %s && %s", folder, changes[k]);
    ck_assert_int_eq(system(command), 0);
    int code = resume("stopped", "");
    ck_assert_msg(code == 65 || code == 74, "%d", code);
    check_log(words[k]);
    snprintf(command, sizeof command, "rm -r %s/stopped", folder);
    ck_assert_int_eq(system(command), 0);
  }
}
END_TEST

// The weights are replaced while the run goes on: it has its own, and begins anew with them.
START_TEST(weights_that_vanish_during_a_run_do_not_touch_it) {
  char scene[128], line[1024];
  copy_scene(scene);
  snprintf(line, sizeof line, "exec %s run %s -q -o %s/whole --set output.checkpoint.frames=1 2>%s/log",
           TETLAP_PROGRAM, scene, folder, folder);
  ck_assert_int_eq(wait_for(start(line)), 0);
  snprintf(line, sizeof line,
           "%s run %s -q -o %s/bare --set output.checkpoint.frames=1 2>%s/log & p=$!; while [ ! -e "
           "%s/bare/frame_00001.vtu ] && kill -0 $p; do sleep 0.01; done; rm %s/w.safetensors; wait $p",
           TETLAP_PROGRAM, scene, folder, folder, folder, folder);
  ck_assert_int_eq(system(line), 0);
  snprintf(line, sizeof line, "cmp %s/whole/history.csv %s/bare/history.csv", folder, folder);
  ck_assert_int_eq(system(line), 0);
}
END_TEST

// A limit on the size of files stands for a full disk. What is there is whole, and the run can be taken up.
START_TEST(a_disk_that_is_full_is_an_error_after_which_the_run_goes_on) {
  const Case *c = &cases[0];
  run_whole(c);
  char line[2300], run_line[2048], command[256];
  print_run(run_line, sizeof run_line, c, "full", "--set output.checkpoint.seconds=0");
  // History and list grow until one of them no longer fits; shells count in blocks of 512 bytes or of 1024.
  snprintf(line, sizeof line, "trap '' XFSZ; ulimit -f 4; %s", run_line);
  ck_assert_int_eq(wait_for(start(line)), 74);
  check_log("too large");
  snprintf(command, sizeof command, "ls %s/full | grep -c part", folder);
  ck_assert_int_ne(system(command), 0); // nothing half written
}
END_TEST

// Killed once frame 5 is there, a row or two beyond the checkpoint after frame 4.
static void leave_killed(const Case *c) {
  char line[2048], command[256];
  print_run(line, sizeof line, c, "killed", "");
  int killed = 0;
  for (int attempt = 0; attempt < 9 && killed == 0; attempt++)
    killed += kill_at(line, "killed", 5) == -SIGKILL;
  ck_assert_int_gt(killed, 0);
  snprintf(command, sizeof command, "cp %s/killed/history.csv %s/history.csv", folder, folder);
  ck_assert_int_eq(system(command), 0);
}

// In the folder of the runs.
static void change(const char *what) {
  char command[512];
  snprintf(command, sizeof command, "cd %s && %s", folder, what);
  ck_assert_int_eq(system(command), 0);
}

// A kill within a write leaves half a line.
START_TEST(what_a_killed_run_wrote_after_its_checkpoint_is_written_again) {
  run_whole(&cases[0]);
  leave_killed(&cases[0]);
  change("printf '0.03,1.2' >> killed/history.csv");
  ck_assert_int_eq(resume("killed", ""), 0);
  compare("whole", "killed");
}
END_TEST

// The checkpoint names what the history held; with another one the run is refused, and goes on once the old
// one is back.
START_TEST(a_history_that_is_not_the_checkpoints_is_refused) {
  static const char *const changes[] = {
      "head -2 history.csv > killed/history.csv",        // lines are lost
      "head -c 300 history.csv > killed/history.csv",    // within a line
      ": > killed/history.csv",                          // all
      "sed '3s/,/,1/' history.csv > killed/history.csv", // a number is another
      "(echo time_s; cat history.csv) > killed/history.csv",
      "rm killed/history.csv"};
  static const char *const words[] = {"cut short",   "cut short",   "cut short",
                                      "was changed", "was changed", "No such file"};
  static const int codes[] = {65, 65, 65, 65, 65, 74};
  run_whole(&cases[0]);
  leave_killed(&cases[0]);
  change("cp -r killed before");
  for (size_t k = 0; k < sizeof changes / sizeof *changes; k++) {
    change(changes[k]);
    ck_assert_int_eq(resume("killed", ""), codes[k]);
    check_log("history.csv");
    check_log(words[k]);
    change("diff -r -x '*.part' -x history.csv -x summary.json -x manifest.json before killed");
  }
  change("cp history.csv killed/history.csv");
  ck_assert_int_eq(resume("killed", ""), 0);
  compare("whole", "killed");
}
END_TEST

START_TEST(a_folder_that_cannot_be_made_is_named) {
  char command[256];
  snprintf(command, sizeof command, "touch %s/closed", folder); // root, too, makes no folder in a file
  ck_assert_int_eq(system(command), 0);
  ck_assert_int_eq(run(&cases[0], "closed/run", ""), 74);
  check_log("closed");
}
END_TEST

START_TEST(a_folder_without_checkpoint_is_refused) {
  ck_assert_int_eq(run(&cases[1], "whole", "--set time.end=0.01"), 0);
  ck_assert_int_eq(resume("whole", ""), 65);
  check_log("no checkpoint.h5");
  ck_assert_int_eq(resume("nowhere", ""), 74);
  check_log("nowhere");
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("resume");
  tcase_add_checked_fixture(test_case, set_up, tear_down);
  tcase_add_loop_test(test_case, a_run_that_is_killed_and_resumed_is_the_same_to_the_last_bit, 0, CASE_COUNT);
  tcase_add_loop_test(test_case, a_run_that_is_stopped_and_resumed_is_the_same, 1, 3);
  tcase_add_loop_test(test_case, two_threads_write_what_one_writes, 4, CASE_COUNT);
  tcase_add_test(test_case, two_runs_are_the_same);
  tcase_add_test(test_case, what_differs_is_refused_by_name);
  tcase_add_test(test_case, weights_that_vanish_during_a_run_do_not_touch_it);
  tcase_add_test(test_case, a_disk_that_is_full_is_an_error_after_which_the_run_goes_on);
  tcase_add_test(test_case, what_a_killed_run_wrote_after_its_checkpoint_is_written_again);
  tcase_add_test(test_case, a_history_that_is_not_the_checkpoints_is_refused);
  tcase_add_test(test_case, a_folder_that_cannot_be_made_is_named);
  tcase_add_test(test_case, a_folder_without_checkpoint_is_refused);
  return suite_run("resume", test_case, 120);
}
