// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "contact/surface/surface.h"

static const double JOINED = 1e-9; // of a line: a gap between elements that is rounding

static int axis_of(char letter) {
  const char *axes = "xyz", *at = letter ? strchr(axes, letter) : NULL;
  return at ? (int)(at - axes) : -1;
}

static bool read_place(const char *text, Vec3 *place, int *length) {
  *length = 0;
  return sscanf(text, "%lf,%lf,%lf%n", &place->x, &place->y, &place->z, length) == 3 && *length > 0 &&
         isfinite(vec3_length(*place));
}

bool app_plot_path_read(AppPlotPath *path, const char *text) {
  static const char radius[] = "radius:", line[] = "line:";
  int length;
  *path = (AppPlotPath){.kind = APP_PLOT_COORDINATE, .axis = axis_of(text[0])};
  if (path->axis >= 0 && !text[1]) return true;
  if (strncmp(text, radius, strlen(radius)) == 0) {
    text += strlen(radius);
    path->kind = APP_PLOT_RADIUS, path->axis = axis_of(text[0]);
    if (path->axis < 0) return false;
    return !text[1] || (text[1] == ':' && read_place(text + 2, &path->from, &length) && !text[2 + length]);
  }
  if (strncmp(text, line, strlen(line)) == 0) {
    path->kind = APP_PLOT_NAMED, path->name = text + strlen(line);
    return *path->name;
  }
  path->kind = APP_PLOT_LINE;
  if (!read_place(text, &path->from, &length) || text[length] != ':') return false;
  text += length + 1;
  return read_place(text, &path->to, &length) && !text[length] &&
         vec3_length(vec3_sub(path->to, path->from)) > 0;
}

const char *app_plot_path_title(const AppPlotPath *path, char title[64]) {
  const char axis = "xyz"[path->axis < 0 ? 0 : path->axis];
  switch (path->kind) {
  case APP_PLOT_COORDINATE:
    snprintf(title, 64, "%c [m]", axis);
    break;
  case APP_PLOT_RADIUS:
    snprintf(title, 64, "distance from the axis along %c [m]", axis);
    break;
  case APP_PLOT_LINE:
    snprintf(title, 64, "way along the line [m]");
    break;
  case APP_PLOT_NAMED:
    snprintf(title, 64, "way along '%.40s' [m]", path->name);
    break;
  }
  return title;
}

static double value_of(const AppPlotQuantity *quantity, int tuple) {
  int components = quantity->field->components;
  const double *values = quantity->field->values + (size_t)tuple * (size_t)components;
  if (components == 1) return values[0];
  return quantity->component >= 0 ? values[quantity->component] : vec3_length(vec3_at(values));
}

static Status add_point(AppPlotPoints *points, double along, double value) {
  if (!isfinite(along) || !isfinite(value)) return STATUS_OK;
  if (!memory_reserve((void **)&points->points, &points->capacity, (size_t)points->count + 1,
                      sizeof *points->points))
    return status_no_memory("the points of a plot");
  points->points[points->count++] = (AppPlotPoint){.along = along, .value = value, .is_apart = true};
  return STATUS_OK;
}

// ---- Vertices of the surface.

// How far along the path a place lies; NaN: not on it.
static double along_of(const AppPlotPath *path, Vec3 x) {
  const double coordinates[3] = {x.x, x.y, x.z};
  if (path->kind == APP_PLOT_COORDINATE) return coordinates[path->axis];
  Vec3 arm = vec3_sub(x, path->from), way = {path->axis == 0, path->axis == 1, path->axis == 2};
  if (path->kind == APP_PLOT_RADIUS) return vec3_length(vec3_sub(arm, vec3_scale(vec3_dot(arm, way), way)));
  way = vec3_sub(path->to, path->from);
  double length = vec3_length(way), along = vec3_dot(arm, way) / length;
  double off = vec3_length(vec3_sub(arm, vec3_scale(along / length, way)));
  return off <= path->within && along >= 0 && along <= length ? along : NAN;
}

// What a vertex knows of the cells about it.
typedef struct Corner {
  bool is_surface;
  int count;
  double sum;
} Corner;

static void add_cells(Corner *corners, const FemVtuContent *frame, const AppPlotQuantity *quantity,
                      const FemVtuField *bodies, int body) {
  for (int c = 0; c < frame->cell_count; c++) {
    if (bodies->values[c] != body) continue;
    for (int v = 0; v < 4; v++) {
      Corner *corner = &corners[frame->cells[4 * (size_t)c + (size_t)v]];
      corner->count++;
      corner->sum += quantity->field->is_cell ? value_of(quantity, c) : 0;
    }
  }
}

static Status sample_vertices(AppPlotPoints *points, const FemVtuContent *frame, const AppPlotPath *path,
                              const AppPlotQuantity *quantity, const FemVtuField *bodies, int body) {
  ContactSurface surface = {0};
  int begin = 0, end = frame->cell_count; // cells of a body stand together
  while (begin < end && bodies->values[begin] != body) begin++;
  while (end > begin && bodies->values[end - 1] != body) end--;
  Corner *corners = memory_zeroed((size_t)frame->vertex_count, sizeof *corners);
  Status status = corners ? contact_surface_find(&surface, (const int(*)[4])frame->cells, begin, end)
                          : status_no_memory("the points of a plot");
  if (!status) add_cells(corners, frame, quantity, bodies, body);
  for (int f = 0; f < surface.count && !status; f++)
    for (int v = 0; v < 3; v++) corners[surface.faces[f].vertices[v]].is_surface = true;
  for (int v = 0; v < frame->vertex_count && !status; v++) {
    const Corner *corner = &corners[v];
    if (!corner->is_surface || corner->count == 0) continue;
    double value = quantity->field->is_cell ? corner->sum / corner->count : value_of(quantity, v);
    status = add_point(points, along_of(path, vec3_at(frame->positions + 3 * (size_t)v)), value);
  }
  contact_surface_destroy(&surface);
  memory_free(corners);
  return status;
}

// ---- Through elements.

// The barycentric coordinates of a place; false: the tetrahedron is flat, or has no place.
static bool locate(const Vec3 x[4], Vec3 at, double shares[4]) {
  double volume = vec3_det4(x[0], x[1], x[2], x[3]);
  for (int k = 0; k < 4; k++) {
    Vec3 y[4] = {x[0], x[1], x[2], x[3]};
    y[k] = at;
    shares[k] = vec3_det4(y[0], y[1], y[2], y[3]) / volume;
  }
  return isfinite(volume) && volume != 0;
}

static double value_within(const FemVtuContent *frame, const AppPlotQuantity *quantity, int cell,
                           const double at_begin[4], const double at_end[4], double t) {
  double value = 0;
  if (quantity->field->is_cell) return value_of(quantity, cell);
  for (int k = 0; k < 4; k++)
    value += (at_begin[k] + t * (at_end[k] - at_begin[k])) *
             value_of(quantity, frame->cells[4 * (size_t)cell + (size_t)k]);
  return value;
}

// The part of the line with no barycentric coordinate below 0, as two points.
static Status cross(AppPlotPoints *points, const FemVtuContent *frame, const AppPlotPath *path,
                    const AppPlotQuantity *quantity, int cell) {
  Vec3 x[4];
  double begin = 0, end = 1, at_begin[4], at_end[4], length = vec3_length(vec3_sub(path->to, path->from));
  for (int k = 0; k < 4; k++)
    x[k] = vec3_at(frame->positions + 3 * (size_t)frame->cells[4 * (size_t)cell + (size_t)k]);
  if (!locate(x, path->from, at_begin) || !locate(x, path->to, at_end)) return STATUS_OK;
  for (int k = 0; k < 4; k++) {
    double change = at_end[k] - at_begin[k];
    if (change > 0) begin = fmax(begin, -at_begin[k] / change);
    if (change < 0) end = fmin(end, -at_begin[k] / change);
    if (change == 0 && at_begin[k] < 0) return STATUS_OK;
  }
  if (!(begin < end)) return STATUS_OK;
  TRY(add_point(points, begin * length, value_within(frame, quantity, cell, at_begin, at_end, begin)));
  return add_point(points, end * length, value_within(frame, quantity, cell, at_begin, at_end, end));
}

static int compare(const void *left, const void *right) {
  const AppPlotPoint *a = left, *b = right;
  return (a->along > b->along) - (a->along < b->along);
}

// Pairs of points are elements that the line crosses: joined to the one before where that ends.
static void join(AppPlotPoints *points, double length) {
  double reached = -INFINITY;
  for (int k = 0; k + 1 < points->count; k += 2) {
    points->points[k].is_apart = points->points[k].along > reached + JOINED * length;
    points->points[k + 1].is_apart = false;
    reached = fmax(reached, points->points[k + 1].along);
  }
}

static Status sample_line(AppPlotPoints *points, const FemVtuContent *frame, const AppPlotPath *path,
                          const AppPlotQuantity *quantity, const FemVtuField *bodies, int body) {
  for (int c = 0; c < frame->cell_count; c++)
    if (bodies->values[c] == body) TRY(cross(points, frame, path, quantity, c));
  if (points->count) qsort(points->points, (size_t)points->count / 2, 2 * sizeof *points->points, compare);
  join(points, vec3_length(vec3_sub(path->to, path->from)));
  return STATUS_OK;
}

Status app_plot_sample(AppPlotPoints *points, const FemVtuContent *frame, const AppPlotPath *path,
                       const AppPlotQuantity *quantity, int body) {
  const FemVtuField *bodies = NULL;
  *points = (AppPlotPoints){0};
  for (int k = 0; k < frame->field_count; k++)
    if (strcmp(frame->fields[k].name, "body") == 0 && frame->fields[k].is_cell) bodies = &frame->fields[k];
  if (!bodies) return status_fail(STATUS_INPUT, "has no array 'body' on its cells");
  if (path->kind == APP_PLOT_LINE && !(path->within > 0))
    return sample_line(points, frame, path, quantity, bodies, body);
  TRY(sample_vertices(points, frame, path, quantity, bodies, body));
  if (points->count) qsort(points->points, (size_t)points->count, sizeof *points->points, compare);
  return STATUS_OK;
}
