// SPDX-License-Identifier: GPL-3.0-or-later
// What a run wrote into its directory, read back: the records, the history and, one after another, the
// frames, of which scalars are kept for colouring.
#ifndef TETLAP_APP_REPORT_RUN_H
#define TETLAP_APP_REPORT_RUN_H

#include <stdbool.h>

#include "app/cli/model_names.h"
#include "app/report/obstacles.h"
#include "base/files/record.h"
#include "base/status.h"
#include "fem/output/vtk/vtu_read.h"

// A scalar on vertices or tetrahedra in every frame: an array of the frames, a vector's length, or of a
// symmetric tensor the pressure, minus a third of its trace.
typedef struct AppReportField {
  char name[FEM_VTU_MAX_NAME]; // of the array in the frames; "pressure" of `stress`
  bool is_cell, is_integer;
  double *values; // (frame_count, tet_count or vertex_count)
} AppReportField;

enum { APP_REPORT_MAX_OBSTACLES = 4 };

typedef struct AppReportRun {
  char *directory;  // owned
  Record *summary;  // NULL: none
  Record *manifest; // NULL: none
  char *history;    // history.csv, NULL: none
  double *times;    // [s]                              (frame_count)
  int frame_count;  // 0: no frames
  int vertex_count;
  double *positions; // [m]          (frame_count, vertex_count, 3)
  int tet_count;
  int *tets; // (tet_count, 4)
  AppReportField fields[FEM_VTU_MAX_FIELDS];
  int field_count;
  AppReportObstacles obstacles[APP_REPORT_MAX_OBSTACLES]; // those without a mesh, by parts of the list
  int obstacles_count;
} AppReportRun;

// Reads the directory, of its frames at most `max_frames` at even distances (the first and the last among
// them; 0: all). STATUS_INPUT: not the directory of a run, files of another format (app/cli/format.h), or
// frames that do not belong together; STATUS_IO; STATUS_MEMORY. After a failure there is nothing to destroy.
Status app_report_run_read(AppReportRun *run, const char *directory, int max_frames);
void app_report_run_destroy(AppReportRun *run);

// What the runs' overlap models are called beside each other (app/cli/model_names.h). False: they tell the
// runs not apart.
bool app_report_run_models(const AppReportRun *runs, int count, AppModelName *names);

#endif
