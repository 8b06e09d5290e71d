// SPDX-License-Identifier: GPL-3.0-or-later
// The points of a sweep: every value of each axis with every one of the others.
#ifndef TETLAP_APP_SWEEP_GRID_H
#define TETLAP_APP_SWEEP_GRID_H

#include "app/sweep/point.h"

typedef struct AppSweepGrid {
  AppSweepBase base;
  AppSweepPoint *points; // (point_count), owned
  int point_count;
} AppSweepGrid;

// Makes the points; the axes of `base` go over to the grid. STATUS_USAGE: too many points, a key twice.
// Destroy it always.
Status app_sweep_grid_create(AppSweepGrid *grid, const AppSweepBase *base);
void app_sweep_grid_destroy(AppSweepGrid *grid);

int app_sweep_grid_count(const AppSweepGrid *grid, AppSweepState state);

#endif
