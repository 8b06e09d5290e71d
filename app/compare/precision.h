// SPDX-License-Identifier: GPL-3.0-or-later
// What two runs of a scene have in common though their meshes differ: the bodies' centres of mass and the
// forces between them, frame by frame.
#ifndef TETLAP_APP_COMPARE_PRECISION_H
#define TETLAP_APP_COMPARE_PRECISION_H

#include "fem/model/model.h"
#include "fem/run/run.h"

typedef struct AppPrecisionCourse {
  int frame_count, body_count, interface_count;
  double *centres; // [m]                    (frame_count, body_count, 3)
  double *forces;  // on the first side [N]  (frame_count, interface_count, 3)
} AppPrecisionCourse;

// Of a result with its trajectory; obstacles have no centre here. STATUS_MEMORY: nothing is left behind.
Status app_precision_course_create(AppPrecisionCourse *course, const FemModel *model,
                                   const FemRunResult *result);
void app_precision_course_destroy(AppPrecisionCourse *course); // a zeroed one is accepted

// Root mean square over frames and bodies of the distance of centres [m], over the frames that both have.
double app_precision_course_centre_error(const AppPrecisionCourse *course,
                                         const AppPrecisionCourse *reference);
// ‖f − f_ref‖₂ / ‖f_ref‖₂ over frames and interfaces.
double app_precision_course_force_error(const AppPrecisionCourse *course,
                                        const AppPrecisionCourse *reference);

#endif
