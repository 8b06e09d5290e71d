// SPDX-License-Identifier: GPL-3.0-or-later
// A key of the scene and the values that it takes in a sweep.
//
//   contact.stiffness=1e5..1e9:5,log         five values at even ratios, both ends among them
//   time.end=0.1..0.5:3                      three at even distances
//   contact.overlap=clip,geo                 these two; a comma in brackets or quotes separates nothing
#ifndef TETLAP_APP_SWEEP_AXIS_H
#define TETLAP_APP_SWEEP_AXIS_H

#include "base/status.h"

enum { APP_SWEEP_MAX_VALUES = 1000 };

typedef struct AppSweepAxis {
  char *key;     // owned
  char **values; // as `--set` takes them (value_count), owned
  int value_count;
} AppSweepAxis;

// STATUS_USAGE says what would be right. After a failure there is nothing to destroy.
Status app_sweep_axis_parse(AppSweepAxis *axis, const char *text);
void app_sweep_axis_destroy(AppSweepAxis *axis);

#endif
