// SPDX-License-Identifier: GPL-3.0-or-later
// One run of a hard scene, and what the judges measure in it.
#ifndef TETLAP_APP_STRESS_RUN_H
#define TETLAP_APP_STRESS_RUN_H

#include "app/stress/stress.h"
#include "fem/model/model.h"
#include "fem/run/run.h"

typedef struct AppStressRun {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result;
  Status status;
  char message[400]; // why it did not end
  double cpu_s;
  // watched after every step
  double momentum[2][3], angular[2][3]; // after the first step and the last [kg m/s], [kg m²/s]
  double flight;                        // longest way of a body's vertex within one step [m]
  volatile sig_atomic_t stop;
  const volatile sig_atomic_t *asked_to_stop;
  double limit_s, began_s;
  bool is_cut; // it took longer than limit_s
  const double *initial_displacement;
  double extra[16]; // what a case's own `run` measures
} AppStressRun;

// Reads app/stress/scenes/FILE.yaml with overrides and builds its model.
Status app_stress_run_open(AppStressRun *run, const char *file, const char *const *overrides, int count);
// Runs it, without files; the trajectory is kept. Only a lack of memory is a Status, all else a result.
Status app_stress_run_scene(AppStressRun *run);
void app_stress_run_close(AppStressRun *run);

// Measures of the trajectory; frame −1: the last. Bodies by number.
int app_stress_run_frames(const AppStressRun *run);
const double *app_stress_run_position(const AppStressRun *run, int frame, int vertex);
void app_stress_run_centre(const AppStressRun *run, int frame, int body, double centre[3]);
double app_stress_run_lowest(const AppStressRun *run, int frame, int body, int axis);
double app_stress_run_highest(const AppStressRun *run, int frame, int body, int axis);
// The force on the first side of the interface "a, b" at a frame [N]; false: there is none.
bool app_stress_run_force(const AppStressRun *run, int frame, const char *name, double force[3]);
// Whether every position of every frame is a number.
bool app_stress_run_is_finite(const AppStressRun *run);
// The element of the last frame that is furthest from its volume at rest: |det F − 1|.
double app_stress_run_distortion(const AppStressRun *run);
// How far the second body is from its mirror image in the plane axis = 0, over the body's size; the mesh must
// be symmetric.
double app_stress_run_asymmetry(const AppStressRun *run, int frame, int axis);

#endif
