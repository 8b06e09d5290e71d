// SPDX-License-Identifier: GPL-3.0-or-later
// Poses of a body: read from a file, or drawn at random.
#ifndef TETLAP_APP_POSES_LIST_H
#define TETLAP_APP_POSES_LIST_H

#include <stdint.h>

#include "base/status.h"

typedef struct AppPosesList {
  int count;
  double *poses; // R row by row, then t [m], owned              (count, 12)
} AppPosesList;

// A line a pose: 12 numbers with blanks or commas between; `#` begins a comment. STATUS_INPUT names the line:
// not 12 numbers, one that is not finite, an R that is no rotation to 1e-6.
Status app_poses_list_read(AppPosesList *list, const char *path);

// Turned about `centre` [m] by up to `turn` [rad] about axes of all directions, then shifted in each
// coordinate by up to `shift` [m]. A pose does not depend on how many there are.
Status app_poses_list_draw(AppPosesList *list, int count, uint64_t seed, const double centre[3], double shift,
                           double turn);

void app_poses_list_destroy(AppPosesList *list);

#endif
