// SPDX-License-Identifier: GPL-3.0-or-later
// Every hard scene (app/stress/scenes/*.yaml, cases made of them by overrides) with every overlap model. A
// scene in which no two meshes meet runs once, under the model "any".
#ifndef TETLAP_APP_STRESS_SCENES_H
#define TETLAP_APP_STRESS_SCENES_H

#include "app/stress/run.h"

enum { APP_STRESS_MAX_OVERRIDES = 8 };

// What every judge asks for besides its own: bits.
enum {
  APP_STRESS_ENDS = 1 << 0,    // the end is reached
  APP_STRESS_TOUCHES = 1 << 1, // contact did occur
  APP_STRESS_ENERGY = 1 << 2,  // the energy audit gains at most 0.1 %
  APP_STRESS_UPRIGHT = 1 << 3, // det F > 0 always
};

typedef struct AppStressScene {
  const char *name;
  const char *file; // of app/stress/scenes, without .yaml
  unsigned asked;
  void (*judge)(const AppStressRun *run, AppStressRow *row);
  bool is_quick;
  bool is_any;    // no overlap model takes part
  bool is_still;  // evaluated at given positions, not run in time: has no frames
  double limit_s; // of processor time; 0: 60 s
  // Runs it instead of app_stress_run_scene; may be NULL.
  Status (*run)(AppStressRun *run);
  const char *overrides[APP_STRESS_MAX_OVERRIDES];
} AppStressScene;

// The table, in cases.c.
const AppStressScene *app_stress_cases(int *count);

Status app_stress_scenes_run(const AppStressOptions *options, AppStress *stress);

#endif
