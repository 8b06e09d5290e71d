// SPDX-License-Identifier: GPL-3.0-or-later
// A scene that starts from the end state of another run. The program itself is run, as a person would.
#include <stdarg.h>
#include <sys/wait.h>

#include "base/memory.h"
#include "folder.h"

// A block that yields is pressed onto the ground and drawn aside, then let off. The driven face is told where
// it goes from where it starts.
static const char press_scene[] =
    "time: {end: 1, static: true}\n"
    "effects: {gravity: [0, 0, -9.81]}\n"
    "bodies:\n"
    "  - name: block\n"
    "    mesh: {box: {size: [0.2, 0.2, 0.2], cells: 3}}\n"
    "    material: {law: stvk, young: 1e5, poisson: 0.3, density: 1000, plasticity: {yield: 1e3}}\n"
    "    driven: [{halfspace: {point: [0, 0, 0.199], normal: [0, 0, -1]},\n"
    "              table: [[0, 0, 0, 0], [1, 0.003, 0, -0.02]]}]\n"
    "obstacles: [{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
    "contact: {friction: 0.4, stiffness: 3e7}\n"
    "output: {frames: 4, vtu: false}\n";
static const char let_off[] =
    "-s start=press -s 'bodies.block.driven[0].table=[[0,0,0,0],[1,-0.002,0,0.008]]'";
static const char both[] = "-s time.end=2 -s output.frames=8 -s "
                           "'bodies.block.driven[0].table=[[0,0,0,0],[1,0.003,0,-0.02],[2,0.001,0,-0.012]]'";

// A block that falls and bounces.
static const char fall_scene[] =
    "time: {end: 0.12}\n"
    "effects: {gravity: [0, 0, -9.81]}\n"
    "bodies:\n"
    "  - name: block\n"
    "    mesh: {box: {size: [0.2, 0.2, 0.2], cells: 2}}\n"
    "    place: {translate: [0, 0, 0.02]}\n"
    "    material: {young: 1e5, poisson: 0.3, density: 1000, damping: 1e-3}\n"
    "obstacles: [{name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}]\n"
    "contact: {stiffness: 3e7, friction: 0.3}\n"
    "output: {frames: 4, vtu: false}\n";

static void write_scene(const char *name, const char *text) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *stream = fopen(path, "w");
  ck_assert_ptr_nonnull(stream);
  fputs(text, stream);
  fclose(stream);
}

static void set_up(void) {
  folder_make();
  write_scene("press.yaml", press_scene);
  write_scene("fall.yaml", fall_scene);
}

// Runs a scene into the folder `to`; its exit code.
static int run(const char *scene, const char *to, const char *more) {
  char line[1024];
  snprintf(line, sizeof line, "%s run %s/%s.yaml -o %s/%s -t 1 %s > %s/log 2>&1", TETLAP_PROGRAM, folder,
           scene, folder, to, more, folder);
  return WEXITSTATUS(system(line));
}

#define ck_assert_runs(scene, to, more)                                                                      \
  do {                                                                                                       \
    int ck_code_ = run(scene, to, more);                                                                     \
    char *ck_log_ = folder_read("log");                                                                      \
    ck_assert_msg(ck_code_ == 0, "%s: %d: %s", to, ck_code_, ck_log_);                                       \
    memory_free(ck_log_);                                                                                    \
  } while (0)

static void check_refused(const char *to, const char *more, const char *words) {
  int code = run("press", to, more);
  char *log = folder_read("log");
  ck_assert_msg(code == 65 && strstr(log, words), "%s: %d: %s", more, code, log);
  memory_free(log);
}

static char content[1 << 18];

static void read_file(const char *from, const char *name) {
  char path[128];
  snprintf(path, sizeof path, "%s/%s/%s", folder, from, name);
  FILE *stream = fopen(path, "r");
  ck_assert_ptr_nonnull(stream);
  content[fread(content, 1, sizeof content - 1, stream)] = 0;
  fclose(stream);
}

// The place of a column among the names in the first line.
static int find_column(const char *column) {
  const size_t length = strlen(column);
  int place = 0;
  for (const char *name = content; *name && *name != '\n'; name += strcspn(name, ",\n"), place++) {
    name += *name == ',';
    if (strncmp(name, column, length) == 0 && strchr(",\n", name[length])) return place;
  }
  ck_abort_msg("there is no column %s", column);
}

// A column of a row of history.csv.
static double read_value(const char *from, int row, const char *column) {
  read_file(from, "history.csv");
  const char *value = content;
  for (int i = 0; i <= row; i++) value = strchr(value, '\n') + 1;
  for (int place = find_column(column); place > 0; place--) value = strchr(value, ',') + 1;
  return strtod(value, NULL);
}

static double read_summary(const char *from, const char *key) {
  read_file(from, "summary.json");
  const char *found = strstr(content, key);
  ck_assert_ptr_nonnull(found);
  return strtod(found + strlen(key) + 3, NULL);
}

START_TEST(press_then_let_off_is_one_run_of_both) {
  static const char *const columns[] = {"force_block_ground_x_N", "force_block_ground_z_N", "elastic_J",
                                        "contact_J", "centre_block_x_m"};
  ck_assert_runs("press", "both", both);
  ck_assert_runs("press", "press", "");
  ck_assert_runs("press", "off", let_off);
  ck_assert_double_gt(fabs(read_value("off", 0, columns[0])), 1); // it sticks and yields
  ck_assert_double_gt(read_value("press", 4, "dissipated_J"), 0.5);
  for (int row = 0; row <= 4; row++)
    for (int c = 0; c < 5; c++) {
      double one = read_value("both", 4 + row, columns[c]), two = read_value("off", row, columns[c]);
      // Equilibria are found to 1e-8 of the largest force, 80 N, and yielding doubles what differs.
      ck_assert_near(one, two, 1e-6 * fmax(1, fabs(one)));
    }
  // What the first run dissipated is not dissipated again, and no energy comes from nowhere.
  ck_assert_near(read_value("off", 4, "dissipated_J"),
                 read_value("both", 8, "dissipated_J") - read_value("both", 4, "dissipated_J"), 1e-5);
  ck_assert_double_lt(read_summary("off", "energy_gain_relative"), 1e-3);
}
END_TEST

START_TEST(another_stiffness_starts_and_ends_in_balance) {
  ck_assert_runs("press", "press", "");
  ck_assert_runs(
      "press", "stiff",
      "-s start=press -s bodies.block.material.young=2e5 -s 'bodies.block.driven[0].table=[[0,0,0,0],"
      "[1,0,0,0]]'");
  ck_assert_double_gt(read_value("stiff", 0, "force_block_ground_z_N"),
                      1.02 * read_value("press", 4, "force_block_ground_z_N"));
  for (int row = 0; row <= 4; row += 4) {
    // What the held face carries and the ground carries is the weight, 78.48 N.
    double held = read_value("stiff", row, "reaction_block_driven_0_z_N"),
           ground = read_value("stiff", row, "force_block_ground_z_N");
    ck_assert_near(held + ground, 78.48, 1e-4);
  }
  // Nothing is changed in the run itself.
  ck_assert_near(read_value("stiff", 4, "force_block_ground_z_N"),
                 read_value("stiff", 0, "force_block_ground_z_N"), 1e-4);
}
END_TEST

START_TEST(a_motion_goes_on_with_its_velocities) {
  ck_assert_runs("fall", "both", "-s time.end=0.24 -s output.frames=8");
  ck_assert_runs("fall", "first", "");
  ck_assert_runs("fall", "second", "-s start=first");
  ck_assert_double_gt(fabs(read_value("second", 0, "momentum_z")), 0.1); // it moves
  for (int row = 0; row <= 4; row++) {
    // Both keep the tolerance of a step, 1e-4 of .35 m, over some hundred steps; the bounce adds them up.
    ck_assert_near(read_value("both", 4 + row, "centre_block_z_m"),
                   read_value("second", row, "centre_block_z_m"), 2e-4);
  }
  ck_assert_double_lt(read_summary("second", "energy_gain_relative"), 1e-3);
}
END_TEST

START_TEST(a_static_scene_starts_from_a_moving_one_and_back) {
  ck_assert_runs("fall", "first", "");
  ck_assert_runs("fall", "rest", "-s start=first -s time.static=true -s time.end=1");
  ck_assert_near(read_value("rest", 0, "force_block_ground_z_N"), 78.48, 1e-4);
  ck_assert_runs("fall", "again", "-s start=rest");
  for (int row = 0; row <= 4; row++) {
    ck_assert_near(read_value("again", row, "force_block_ground_z_N"), 78.48, 0.1); // and stays
    ck_assert_near(read_value("again", row, "momentum_z"), 0, 1e-3);
  }
}
END_TEST

START_TEST(what_differs_is_said_in_one_message) {
  check_refused("x", "-s start=press", "has no summary.json");
  ck_assert_runs("press", "press", "");
  check_refused("press", "-s start=press", "is the folder that this run would write into");
  check_refused("x", "-s start=press -s bodies.block.name=cube",
                "has the body 'block' where this scene has 'cube'");
  check_refused("x", "-s start=press -s bodies.block.mesh.box.cells=2", "another mesh, `place` or order");
  check_refused("x", "-s start=press -s bodies.block.element=quadratic", "another mesh, `place` or order");
  check_refused("x", "-s start=press -s bodies.block.material.plasticity=null",
                "`plasticity` in one of the two");
  check_refused("x", "-s start=press -s time.static=false -s 'bodies.block.velocity=[0,0,1]'",
                "remove its 'velocity'");
}
END_TEST

START_TEST(a_run_that_failed_is_taken_only_where_the_scene_says_so) {
  // Pressed through its whole height: no equilibrium.
  ck_assert_int_ne(run("press", "press", "-s 'bodies.block.driven[0].table=[[0,0,0,0],[1,0,0,-0.4]]'"), 0);
  check_refused("x", "-s start=press", "its outcome is 'failed'");
  ck_assert_runs(
      "press", "x",
      "-s start.run=press -s start.outcome=any -s 'bodies.block.driven[0].table=[[0,0,0,0],[1,0,0,0.01]]'");
  ck_assert_double_gt(read_value("x", 0, "force_block_ground_z_N"), 10);
}
END_TEST

int main(void) {
  TCase *test = tcase_create("start");
  tcase_add_checked_fixture(test, set_up, folder_remove);
  tcase_add_test(test, press_then_let_off_is_one_run_of_both);
  tcase_add_test(test, another_stiffness_starts_and_ends_in_balance);
  tcase_add_test(test, a_motion_goes_on_with_its_velocities);
  tcase_add_test(test, a_static_scene_starts_from_a_moving_one_and_back);
  tcase_add_test(test, what_differs_is_said_in_one_message);
  tcase_add_test(test, a_run_that_failed_is_taken_only_where_the_scene_says_so);
  return suite_run("start", test, 120);
}
