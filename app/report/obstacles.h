// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of obstacles without a mesh, read back: the further parts of a run's list of frames.
#ifndef TETLAP_APP_REPORT_OBSTACLES_H
#define TETLAP_APP_REPORT_OBSTACLES_H

#include "base/status.h"
#include "fem/output/vtk/pvd.h"

// One part. What stands has a single row, which holds for all frames.
typedef struct AppReportObstacles {
  int row_count, vertex_count;
  double *positions; // [m]                                     (row_count, vertex_count, 3)
  int triangle_count;
  int *triangles; // vertices, counter-clockwise from outside; body; face (triangle_count, 5)
} AppReportObstacles;

// Reads a part of the list at the times `chosen` (frame_count); owned by the caller. STATUS_INPUT: files that
// are not surfaces, or of different ones; STATUS_IO; STATUS_MEMORY. After a failure there is nothing to
// destroy.
Status app_report_obstacles_read(AppReportObstacles *obstacles, const char *directory, const FemPvdList *list,
                                 int part, const int *chosen, int frame_count);
void app_report_obstacles_destroy(AppReportObstacles *obstacles); // a zeroed one, too

#endif
