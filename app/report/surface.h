// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of a run's mesh: the triangles that belong to one tetrahedron only.
#ifndef TETLAP_APP_REPORT_SURFACE_H
#define TETLAP_APP_REPORT_SURFACE_H

#include "app/report/run.h"

typedef struct AppReportSurface {
  int triangle_count;
  int *triangles; // vertices, counter-clockwise from outside, and the tetrahedron  (triangle_count, 4)
} AppReportSurface;

// Owned by the caller. STATUS_MEMORY.
Status app_report_surface_find(AppReportSurface *surface, const AppReportRun *run);
void app_report_surface_destroy(AppReportSurface *surface);

// Drops from the run, and renumbers in the surface, vertices and tetrahedra that no triangle has: what is
// left looks the same from outside but cannot be cut open. The run's tets are gone. STATUS_MEMORY.
Status app_report_surface_strip(AppReportSurface *surface, AppReportRun *run);

#endif
