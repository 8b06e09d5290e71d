// SPDX-License-Identifier: GPL-3.0-or-later
// A key of the scene and the values that it takes in a sweep.
//
//   contact.stiffness=1e5..1e9:5,log         five values at even ratios, both ends among them
//   time.end=0.1..0.5:3                      three at even distances
//   a.cells=2,4,8 with b.cells=3,6,12         two keys that change together: two axes, the second linked
//   contact.overlap=clip,geo                 these two; a comma in brackets or quotes separates nothing
#ifndef TETLAP_APP_SWEEP_AXIS_H
#define TETLAP_APP_SWEEP_AXIS_H

#include <stdbool.h>

#include "app/cli/model_names.h"
#include "base/status.h"

enum { APP_SWEEP_MAX_VALUES = 1000 };

typedef struct AppSweepAxis {
  char *key;     // owned
  char **values; // as `--set` takes them (value_count), owned
  int value_count;
  bool is_linked;       // it changes with the last axis before it that is not
  AppModelName *labels; // what the values are called (value_count), owned; NULL: as they stand
} AppSweepAxis;

// STATUS_USAGE says what would be right. After a failure there is nothing to destroy.
Status app_sweep_axis_parse(AppSweepAxis *axis, const char *text);

// Parses axes joined by " with " into `axes` from `*count` on, at most `most` of them in all, and raises
// `*count`. STATUS_USAGE: too many, or their numbers of values differ. After a failure those counted are the
// caller's.
Status app_sweep_axis_parse_linked(AppSweepAxis *axes, int most, int *count, const char *text);

// Gives values that are weights files the names of models (app/cli/model_names.h). Paths are relative to the
// scene, as there. STATUS_USAGE: two are one file.
Status app_sweep_axis_label(AppSweepAxis *axis, const char *scene_path);

// What value k is called, and the absolute path of its weights file; false: it is none.
const char *app_sweep_axis_name(const AppSweepAxis *axis, int k);
bool app_sweep_axis_locate(const AppSweepAxis *axis, int k, const char *scene_path, char path[PATH_MAX]);

void app_sweep_axis_destroy(AppSweepAxis *axis);

#endif
