// SPDX-License-Identifier: GPL-3.0-or-later
// A formula that is no number, and a file that is not there, are told with their place in the scene.
#include "scene.h"

#include <string.h>
#include <unistd.h>

#include "app/scene/manual.h"
#include "base/expression.h"

static char path[64];

// Writes a scene of one block, with these lines for the block and these after it.
static void write_scene(const char *block, const char *rest) {
  snprintf(path, sizeof path, "/tmp/tetlap_formulas_%ld.yaml", (long)getpid());
  FILE *stream = fopen(path, "w");
  fprintf(stream,
          "time: {end: 0.1}\nbodies:\n  - name: block\n    material: {young: 1e5, poisson: 0.3, density: "
          "1000}\n%s%s",
          block, rest);
  fclose(stream);
}

static void remove_scene(void) {
  unlink(path);
}

// Reading or running fails with this status, and the message has all of these.
static void expect(Status wanted, const char *place, const char *second, const char *third) {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result = {0};
  char whole[128];
  ck_assert_ok(app_scene_read(path, NULL, 0, &scene));
  Status status = fem_model_create(&model, &scene);
  if (!status) {
    status = fem_run(&model, &(FemRunOptions){0}, &result);
    fem_run_result_destroy(&result);
    fem_model_destroy(&model);
  }
  ck_assert_int_eq(status, wanted);
  snprintf(whole, sizeof whole, "%s%s", path, place);
  ck_assert_msg(strstr(status_message(), whole) && strstr(status_message(), second) &&
                    strstr(status_message(), third),
                "%s", status_message());
  fem_scene_destroy(&scene);
}

#define BOX "    mesh: {box: {size: [0.2, 0.2, 0.2], cells: 2}}\n"

START_TEST(of_a_driven_body) {
  write_scene(BOX "    driven:\n      - {group: x_min, formula: {z: log(0.05-t)}}\n", "");
  expect(STATUS_INPUT, ":7:37: body 'block'", "'log(0.05-t)'", "t = 0.0");
}
END_TEST

START_TEST(of_a_load) {
  write_scene(BOX "    loads:\n      - {group: x_min, force: [1, 0, 0], factor: 1/t}\n", "");
  expect(STATUS_INPUT, ":7:50: a load on 'block'", "'1/t'", "t = 0 s");
}
END_TEST

START_TEST(of_an_obstacle) {
  write_scene(BOX, "obstacles:\n  - {name: floor, halfspace: {point: [0, 0, -1], normal: [0, 0, 1]}, motion: "
                   "{formula: {z: sqrt(-1-t)}}}\ncontact: {}\n");
  expect(STATUS_INPUT, ":7:92: obstacle 'floor'", "'sqrt(-1-t)'", "t = 0 s");
}
END_TEST

START_TEST(a_motion_that_has_ended_is_not_asked) {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result;
  write_scene(BOX "    driven:\n      - {group: x_min, formula: {z: 0.001*sqrt(0.06-t)}, until: 0.05}\n", "");
  ck_assert_ok(app_scene_read(path, NULL, 0, &scene));
  ck_assert_ok(fem_model_create(&model, &scene));
  ck_assert_ok(fem_run(&model, &(FemRunOptions){0}, &result));
  fem_run_result_destroy(&result);
  fem_model_destroy(&model);
  fem_scene_destroy(&scene);
}
END_TEST

START_TEST(a_mesh_that_is_not_there) {
  write_scene("    mesh: nowhere.msh\n", "");
  expect(STATUS_IO, ":5:11: body 'block'", "nowhere.msh", "cannot be opened");
  write_scene(BOX, "obstacles:\n  - name: table\n    mesh: {file: gone.msh}\n");
  expect(STATUS_IO, ":8:11: obstacle 'table'", "gone.msh", "cannot be opened");
}
END_TEST

START_TEST(weights_that_are_not_there) {
  write_scene(BOX, "    self_contact: true\ncontact: {overlap: none.safetensors}\n");
  expect(STATUS_IO, ":7:20: contact.overlap", "none.safetensors", "cannot be opened");
}
END_TEST

START_TEST(the_manual_lists_every_function) {
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(app_scene_manual_print(stream));
  fclose(stream);
  const char *name, *help;
  int count = 0;
  for (; (name = expression_function(count, &help)); count++) {
    char row[160];
    snprintf(row, sizeof row, "| `%s` | %s |", name, help);
    ck_assert_msg(strstr(text, row) != NULL, "%s", name);
  }
  ck_assert_int_eq(count, 12);
  free(text);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("formulas");
  tcase_add_checked_fixture(cases, NULL, remove_scene);
  tcase_add_test(cases, of_a_driven_body);
  tcase_add_test(cases, of_a_load);
  tcase_add_test(cases, of_an_obstacle);
  tcase_add_test(cases, a_motion_that_has_ended_is_not_asked);
  tcase_add_test(cases, a_mesh_that_is_not_there);
  tcase_add_test(cases, weights_that_are_not_there);
  tcase_add_test(cases, the_manual_lists_every_function);
  return suite_run("formulas", cases, 30);
}
