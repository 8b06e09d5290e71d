// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a scene of tests/scenes for a test, with a few values replaced.
#ifndef TETLAP_TESTS_SCENE_H
#define TETLAP_TESTS_SCENE_H

#include <stdio.h>

#include "app/scene/read.h"
#include "fem/model/build.h"
#include "fem/model/model.h"
#include "fem/run/run.h"
#include "suite.h"

typedef struct SceneRun {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result;
  Status status;
} SceneRun;

// Reads and builds; `overrides` ends with NULL.
static inline void scene_open(SceneRun *run, const char *name, const char *const *overrides) {
  char path[512];
  snprintf(path, sizeof path, "%s/tests/scenes/%s.yaml", TETLAP_SOURCE_DIR, name);
  int count = 0;
  while (overrides && overrides[count]) count++;
  *run = (SceneRun){0};
  ck_assert_ok(app_scene_read(path, overrides, count, &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
}

// Runs without writing files; the trajectory is kept.
static inline void scene_run_from(SceneRun *run, const double *initial_displacement) {
  FemRunOptions options = {.keep_trajectory = true, .initial_displacement = initial_displacement};
  run->status = fem_run(&run->model, &options, &run->result);
}

// Opens and runs, and expects the end to be reached.
static inline void scene_run(SceneRun *run, const char *name, const char *const *overrides) {
  scene_open(run, name, overrides);
  scene_run_from(run, NULL);
  ck_assert_msg(run->status == STATUS_OK, "%s: %s", name, status_message());
}

static inline void scene_close(SceneRun *run) {
  fem_run_result_destroy(&run->result);
  fem_model_destroy(&run->model);
  fem_scene_destroy(&run->scene);
}

// Position of a vertex at a frame; the last one is run->result.trajectory.frame_count − 1.
static inline const double *scene_position(const SceneRun *run, int frame, int vertex) {
  return run->result.trajectory.positions +
         3 * ((size_t)frame * (size_t)run->result.trajectory.vertex_count + (size_t)vertex);
}

// The force on the first side of an interface at a frame [N].
static inline const double *scene_force(const SceneRun *run, int frame, int interface) {
  return run->result.trajectory.interface_forces +
         3 * ((size_t)frame * (size_t)run->result.trajectory.interface_count + (size_t)interface);
}

static inline double scene_gain(const SceneRun *run) {
  return run->result.energy.audit.gain / run->result.energy.audit.scale;
}

#endif
