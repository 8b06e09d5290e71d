// SPDX-License-Identifier: GPL-3.0-or-later
// A gain of energy is seen, counted and, with `is_strict`, an error. The time loop takes back what it can, so
// this program has a registry of effects of its own (it stands in for that of fem/effect/effect.c when the
// program is linked), with a wind whose energy nobody accounts for.
#include "scene.h"

#include <string.h>

static bool is_blowing(const FemSceneDef *scene) {
  (void)scene;
  return true;
}

static Status create_wind(void **self, const FemModel *model) {
  *self = (void *)(uintptr_t)model;
  return STATUS_OK;
}

// An acceleration of 2 m/s² along x.
static Status blow(void *self, const FemState *state, double *force) {
  (void)state;
  const FemModel *model = self;
  for (int a = 0; a < model->vertex_count; a++) force[3 * a] += 2 * model->mass[a];
  return STATUS_OK;
}

static void leave(void *self) {
  (void)self;
}

static const FemEffectOps wind = {
    .name = "wind", .is_wanted = is_blowing, .create = create_wind, .add_force = blow, .destroy = leave};

const FemEffectOps *const *fem_effect_list(int *count) {
  static const FemEffectOps *const effects[] = {&fem_effect_elasticity, &fem_effect_gravity, &wind};
  *count = 3;
  return effects;
}

static Status note(void *seen, const FemRunProgress *progress) {
  if (progress->has_trouble_begun) ++*(int *)seen;
  return STATUS_OK;
}

START_TEST(energy_out_of_nothing_is_an_event) {
  SceneRun run;
  int seen = 0;
  char text[1024];
  scene_open(&run, "free_fall", (const char *const[]){"time.end=0.25", NULL});
  FemRunOptions options = {.observe = note, .observer = &seen};
  ck_assert_ok(fem_run(&run.model, &options, &run.result));
  ck_assert_double_gt(scene_gain(&run), run.result.energy.bounds.run);
  ck_assert_int_eq(run.result.trouble.of[FEM_TROUBLE_ENERGY].events, 1);
  ck_assert_int_eq(seen, 1);
  fem_run_describe_trouble(&run.result, &run.model, text, sizeof text);
  ck_assert_ptr_nonnull(strstr(text, "energy out of nothing"));
  ck_assert_ptr_nonnull(strstr(text, " s, 1 time "));
  scene_close(&run);
}
END_TEST

START_TEST(a_strict_run_ends_there_with_an_error) {
  SceneRun run;
  scene_open(&run, "free_fall", (const char *const[]){"time.end=0.25", NULL});
  FemRunOptions options = {.is_strict = true};
  ck_assert_int_eq(fem_run(&run.model, &options, &run.result), STATUS_SOLVER);
  ck_assert_ptr_nonnull(strstr(status_message(), "the energy has risen"));
  ck_assert_ptr_nonnull(strstr(status_message(), "--strict"));
  ck_assert_double_lt(run.result.end_time, run.scene.end);
  scene_close(&run);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("strict");
  tcase_add_test(cases, energy_out_of_nothing_is_an_event);
  tcase_add_test(cases, a_strict_run_ends_there_with_an_error);
  return suite_run("strict", cases, 60);
}
