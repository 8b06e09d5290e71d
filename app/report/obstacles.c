// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/obstacles.h"

#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "fem/output/vtk/vtu_read.h"

// The whole numbers of the cells under that name; NULL: there are none.
static const double *find_numbers(const FemVtuContent *content, const char *name) {
  for (int k = 0; k < content->field_count; k++) {
    const FemVtuField *field = &content->fields[k];
    if (field->is_cell && field->is_integer && field->components == 1 && strcmp(field->name, name) == 0)
      return field->values;
  }
  return NULL;
}

// Room for the rows, and the triangles, as the first file has them.
static Status lay_out(AppReportObstacles *obstacles, const FemVtuContent *first) {
  const double *bodies = find_numbers(first, "body"), *faces = find_numbers(first, "face");
  if (first->cell != FEM_VTU_TRIANGLES || !bodies || !faces)
    return status_fail(STATUS_INPUT, "is not the surface of obstacles: triangles with `body` and `face`");
  const size_t numbers = 3 * (size_t)first->vertex_count;
  obstacles->vertex_count = first->vertex_count;
  obstacles->triangle_count = first->cell_count;
  obstacles->positions = memory_zeroed((size_t)obstacles->row_count, numbers * sizeof *obstacles->positions);
  obstacles->triangles = memory_zeroed((size_t)first->cell_count, 5 * sizeof *obstacles->triangles);
  if (!obstacles->positions || !obstacles->triangles) return status_no_memory("the obstacles of a run");
  for (int t = 0; t < first->cell_count; t++) {
    int *triangle = obstacles->triangles + 5 * (size_t)t;
    memcpy(triangle, first->cells + 3 * (size_t)t, 3 * sizeof *triangle);
    triangle[3] = (int)bodies[t];
    triangle[4] = (int)faces[t];
  }
  return STATUS_OK;
}

static Status take_row(AppReportObstacles *obstacles, int row, const FemVtuContent *content) {
  if (row == 0) TRY(lay_out(obstacles, content));
  const size_t numbers = 3 * (size_t)obstacles->vertex_count;
  if (content->vertex_count != obstacles->vertex_count || content->cell_count != obstacles->triangle_count)
    return status_fail(STATUS_INPUT, "has other obstacles than the first frame");
  memcpy(obstacles->positions + (size_t)row * numbers, content->positions,
         numbers * sizeof *obstacles->positions);
  return STATUS_OK;
}

static Status read_row(AppReportObstacles *obstacles, int row, const char *directory, const char *name) {
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  FemVtuContent content;
  Status status = fem_vtu_read(path, &content);
  if (!status) {
    status = take_row(obstacles, row, &content);
    if (status == STATUS_INPUT) status = status_prefix(status, "%s", path);
    fem_vtu_read_destroy(&content);
  }
  memory_free(path);
  return status;
}

Status app_report_obstacles_read(AppReportObstacles *obstacles, const char *directory, const FemPvdList *list,
                                 int part, const int *chosen, int frame_count) {
  Status status = STATUS_OK;
  bool is_standing = true; // the same file at all times
  for (int frame = 1; frame < frame_count; frame++)
    is_standing = is_standing && strcmp(list->files[chosen[frame] * list->part_count + part],
                                        list->files[chosen[0] * list->part_count + part]) == 0;
  *obstacles = (AppReportObstacles){.row_count = is_standing && frame_count > 0 ? 1 : frame_count};
  for (int row = 0; !status && row < obstacles->row_count; row++)
    status = read_row(obstacles, row, directory, list->files[chosen[row] * list->part_count + part]);
  if (status) app_report_obstacles_destroy(obstacles);
  return status;
}

void app_report_obstacles_destroy(AppReportObstacles *obstacles) {
  memory_free(obstacles->positions);
  memory_free(obstacles->triangles);
  *obstacles = (AppReportObstacles){0};
}
