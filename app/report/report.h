// SPDX-License-Identifier: GPL-3.0-or-later
// A web page about one or several runs, or about measurements, as a single file.
#ifndef TETLAP_APP_REPORT_REPORT_H
#define TETLAP_APP_REPORT_REPORT_H

#include <stdbool.h>
#include <stdio.h>

#include "app/report/run.h"

enum { APP_REPORT_MAX_RUNS = 16, APP_REPORT_MAX_STRESSES = 16 };

// What the page shall show; records may be NULL. All owned.
typedef struct AppReport {
  AppReportRun runs[APP_REPORT_MAX_RUNS];
  int run_count;
  int reference;      // the run that the others are held against
  Record *comparison; // compare.json
  Record *pareto;     // pareto.json
  Record *sweep;      // sweep.json
  Record *verdict;    // verdict.json
  Record *live;       // how far the run is that the page is to follow (app/view); NULL: a page for itself
  Record *stresses[APP_REPORT_MAX_STRESSES]; // of `tetlap stress --json`
  int stress_count;
  bool has_surface_only; // leaves out what lies inside the bodies
} AppReport;

// Numbers of frames beyond which a run's inside is left out all the same: such a page would be some 100 MB.
enum { APP_REPORT_MAX_NUMBERS = 60000000 };

// Writes the page. Empties the report's records and, with surface only, the runs' inside. STATUS_MEMORY,
// STATUS_IO.
Status app_report_print(AppReport *report, FILE *stream);
Status app_report_write(AppReport *report, const char *path); // whole or not at all
void app_report_destroy(AppReport *report);

// Root mean square and largest distance between the vertices of a run and the reference [m] in a frame; false
// if their meshes differ, or one of them did not reach that frame at the same time.
bool app_report_distance(const AppReport *report, int run, int frame, double *mean, double *largest);

#endif
