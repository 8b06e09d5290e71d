// SPDX-License-Identifier: GPL-3.0-or-later
// A quantity of a frame along a path: at the vertices of surfaces over a coordinate, over the distance from
// an axis or along a line that they are near; or where a line runs through the elements. Lines of the scene
// are in files of their own (app/plot/named.h).
#ifndef TETLAP_APP_PLOT_SAMPLE_H
#define TETLAP_APP_PLOT_SAMPLE_H

#include <stdbool.h>

#include "base/vec3.h"
#include "fem/output/vtk/vtu_read.h"

typedef enum AppPlotPathKind {
  APP_PLOT_COORDINATE,
  APP_PLOT_RADIUS,
  APP_PLOT_LINE,
  APP_PLOT_NAMED,
} AppPlotPathKind;

typedef struct AppPlotPath {
  AppPlotPathKind kind;
  int axis;         // of a coordinate, and of what a radius is measured from: 0 … 2
  Vec3 from, to;    // the ends of a line; `from` is a point on the axis [m]
  const char *name; // of a line of the scene, borrowed
  double within;    // of a line: vertices of surfaces no farther from it; 0: elements [m]
} AppPlotPath;

// "x"; "radius:z", "radius:z:X,Y,Z" (a point on the axis); "X,Y,Z:X,Y,Z"; "line:NAME". False: it is none of
// these.
bool app_plot_path_read(AppPlotPath *path, const char *text);
// What is measured along it, with its unit.
const char *app_plot_path_title(const AppPlotPath *path, char title[64]);

// A value of a tuple: one number, a component, or of a vector the length.
typedef struct AppPlotQuantity {
  const FemVtuField *field; // borrowed
  int component;            // −1: the length
} AppPlotQuantity;

typedef struct AppPlotPoint {
  double along, value; // [m], the field's unit
  bool is_apart;       // nothing joins it to the point before
} AppPlotPoint;

typedef struct AppPlotPoints {
  int count;
  size_t capacity;
  AppPlotPoint *points; // ascending along the path                               (count)
} AppPlotPoints;

// Of the cells of one body (the array `body`) at the frame's positions. Of a quantity on cells a vertex has
// the mean over its cells, and a line the cell's. What is not finite is left out. Owned by the caller, also
// after a failure: STATUS_MEMORY.
Status app_plot_sample(AppPlotPoints *points, const FemVtuContent *frame, const AppPlotPath *path,
                       const AppPlotQuantity *quantity, int body);

#endif
