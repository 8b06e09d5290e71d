// SPDX-License-Identifier: GPL-3.0-or-later
// V and wrench of many poses of a body of a scene (device/poses/poses.h), a block of poses at a time. Those
// of a block share the pairs of tetrahedra that may meet in any of them.
#ifndef TETLAP_APP_POSES_POSES_H
#define TETLAP_APP_POSES_POSES_H

#include "app/poses/list.h"
#include "device/poses/poses.h"
#include "fem/model/model.h"

enum { APP_POSES_BLOCK = 1024 };

typedef struct AppPosesResult {
  double *sums;         // V [m³], f [m²], m [m³], owned         (count, 7)
  double eval_s;        // wall time of evaluations, without finding pairs [s]
  double eval_cpu_s;    // processor time of the same [s]
  double find_s;        // of finding pairs [s]
  long long pair_count; // evaluated, of all poses
  long long handed_on;  // of them answered by the processor for the device
} AppPosesResult;

// The body's centre: the mean of its elements, weighed by volume [m].
void app_poses_centre(const FemModel *model, int body, double centre[3]);

// `device` NULL: the processor's vectors. A zeroed result can be destroyed.
Status app_poses_run(AppPosesResult *result, const FemModel *model, int body, const AppPosesList *list,
                     const Device *device);
void app_poses_destroy(AppPosesResult *result);

#endif
