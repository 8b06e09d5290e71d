// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/grid.h"

#include <string.h>

#include "base/memory.h"

static Status check_keys(const AppSweepBase *base) {
  for (int a = 0; a < base->axis_count; a++)
    for (int b = 0; b < a; b++)
      if (strcmp(base->axes[a].key, base->axes[b].key) == 0)
        return status_fail(STATUS_USAGE, "--vary: '%s' is given twice", base->axes[a].key);
  return STATUS_OK;
}

Status app_sweep_grid_create(AppSweepGrid *grid, const AppSweepBase *base) {
  *grid = (AppSweepGrid){.base = *base};
  TRY(check_keys(base));
  int count = app_sweep_point_count(base);
  if (count > APP_SWEEP_MAX_POINTS)
    return status_fail(STATUS_USAGE, "--vary: the grid has more than %d points; take fewer values",
                       APP_SWEEP_MAX_POINTS);
  for (int a = 0; a < base->axis_count; a++) TRY(app_sweep_axis_label(&grid->base.axes[a], base->scene_path));
  grid->points = memory_zeroed((size_t)count, sizeof *grid->points);
  if (!grid->points) return status_no_memory("the points of a sweep");
  for (; grid->point_count < count; grid->point_count++)
    TRY(app_sweep_point_create(&grid->points[grid->point_count], &grid->base, grid->point_count));
  return STATUS_OK;
}

void app_sweep_grid_destroy(AppSweepGrid *grid) {
  // The point after the last whole one may have been begun.
  int begun = grid->points ? grid->point_count + 1 : 0;
  if (begun > app_sweep_point_count(&grid->base)) begun = grid->point_count;
  for (int p = 0; p < begun; p++) app_sweep_point_destroy(&grid->points[p]);
  for (int a = 0; a < grid->base.axis_count; a++) app_sweep_axis_destroy(&grid->base.axes[a]);
  memory_free(grid->points);
  *grid = (AppSweepGrid){0};
}

int app_sweep_grid_count(const AppSweepGrid *grid, AppSweepState state) {
  int count = 0;
  for (int p = 0; p < grid->point_count; p++) count += grid->points[p].state == state;
  return count;
}
