// SPDX-License-Identifier: GPL-3.0-or-later
// A scene pays for the effects it calls for and for no other. This program has a registry of its own, without
// contact and friction (it stands in for that of fem/effect/effect.c when the program is linked): what it
// computes of a scene that does not call for them must be what the whole program computes, to the last bit.
#include "scene.h"

#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/effect/effect.h"
#include "fem/effect/system.h"

static const FemEffectOps *const few[] = {&fem_effect_elasticity, &fem_effect_damping, &fem_effect_gravity};

const FemEffectOps *const *fem_effect_list(int *count) {
  *count = (int)(sizeof few / sizeof *few);
  return few;
}

// A folder of our own; the path is written to `path`.
static void make_folder(char path[64]) {
  snprintf(path, 64, "/tmp/tetlap_effects_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(path));
}

static char *read_from(const char *folder, const char *name) {
  char path[128], *text;
  size_t size;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  ck_assert_ok(file_read(path, &text, &size));
  return text;
}

static void remove_folder(const char *folder) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

// _i: scene.
START_TEST(without_an_effect_results_are_those_of_a_program_without_it) {
  const char *const scenes[] = {"free_fall", "cantilever"};
  char whole[64], few_only[64], command[1024];
  make_folder(whole), make_folder(few_only);
  snprintf(command, sizeof command,
           "%s run %s/tests/scenes/%s.yaml -o %s --set time.end=0.1 --set output.frames=4 --set "
           "output.vtu=true --set "
           "solver.threads=1 "
           ">/dev/null 2>&1",
           TETLAP_PROGRAM, TETLAP_SOURCE_DIR, scenes[_i], whole);
  ck_assert_msg(system(command) == 0, "%s", command);
  SceneRun run;
  scene_open(
      &run, scenes[_i],
      (const char *const[]){"time.end=0.1", "output.frames=4", "output.vtu=true", "solver.threads=1", NULL});
  FemRunOptions options = {.directory = few_only};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  const char *const files[] = {"history.csv", "frame_00000.vtu", "frame_00004.vtu"};
  for (int k = 0; k < 3; k++) {
    char *a = read_from(whole, files[k]), *b = read_from(few_only, files[k]);
    ck_assert_int_gt((int)strlen(a), 100);
    ck_assert_msg(strcmp(a, b) == 0, "%s differs", files[k]);
    memory_free(a), memory_free(b);
  }
  scene_close(&run);
  remove_folder(whole), remove_folder(few_only);
}
END_TEST

START_TEST(an_effect_that_is_absent_has_no_row_and_no_column) {
  SceneRun run;
  scene_run(&run, "free_fall", NULL);
  Record *summary = record_new();
  fem_run_summarise(&run.result, summary);
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  ck_assert_ok(record_print(summary, stream));
  fclose(stream);
  ck_assert_ptr_nonnull(strstr(text, "\"elasticity\": {"));
  ck_assert_ptr_nonnull(strstr(text, "\"gravity\": {"));
  ck_assert_ptr_null(strstr(text, "\"damping\": {"));
  ck_assert_ptr_null(strstr(text, "contact_pairs"));
  ck_assert_ptr_null(strstr(text, "friction"));
  ck_assert_int_eq(run.result.trajectory.interface_count, 0);
  ck_assert_int_eq((int)run.result.contact.pairs.tried, 0);
  ck_assert_double_eq(run.result.cost.phases.broad_phase, 0);
  for (int i = 0; i < run.result.effect_count; i++) {
    ck_assert_int_gt((int)run.result.effects[i].cost.force_calls, 0);
    ck_assert_int_gt((int)run.result.effects[i].cost.bytes_max, 0);
  }
  ck_assert_ptr_nonnull(strstr(text, "\"bytes_max\": "));
  record_destroy(summary);
  free(text);
  scene_close(&run);
}
END_TEST

START_TEST(gravity_alone_needs_no_matrix_and_no_preparation) {
  SceneRun run;
  scene_run(&run, "free_fall", NULL);
  int gravity = -1;
  for (int i = 0; i < run.result.effect_count; i++)
    if (strcmp(run.result.effects[i].name, "gravity") == 0) gravity = i;
  ck_assert_int_ge(gravity, 0);
  ck_assert_int_eq((int)run.result.effects[gravity].cost.jacobian_calls, 0);
  ck_assert_int_eq((int)run.result.effects[gravity].cost.prepare_calls, 0);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("effects");
  tcase_add_loop_test(test_case, without_an_effect_results_are_those_of_a_program_without_it, 0, 2);
  tcase_add_test(test_case, an_effect_that_is_absent_has_no_row_and_no_column);
  tcase_add_test(test_case, gravity_alone_needs_no_matrix_and_no_preparation);
  return suite_run("effects", test_case, 60);
}
