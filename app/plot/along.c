// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/plot/along.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/plot/gnuplot.h"
#include "app/plot/named.h"
#include "base/files/file.h"
#include "base/files/record.h"
#include "base/memory.h"
#include "fem/output/vtk/pieces_read.h"
#include "fem/output/vtk/pvd.h"

enum { WIDTH = 620, HEIGHT = 380, MAX_LABEL = 256 };

static const char *const hues[] = {"#2f6fc4", "#d2691e", "#2a8f78", "#8a56b8", "#b8487a", "#8a7a1f"};

static const char *unit_of(const char *name) {
  static const struct {
    const char *name, *unit;
  } units[] = {{"displacement", "m"},      {"velocity", "m/s"},     {"contact_force", "N"},
               {"contact_pressure", "Pa"}, {"contact_depth", "m"},  {"contact_traction", "Pa"},
               {"contact_gap", "m"},       {"friction_force", "N"}, {"slip", "m"},
               {"slip_way", "m"},          {"friction_work", "J"},  {"reaction", "N"},
               {"stress", "Pa"},           {"von_mises", "Pa"}};
  for (size_t k = 0; k < sizeof units / sizeof *units; k++)
    if (strcmp(units[k].name, name) == 0) return units[k].unit;
  return NULL;
}

// ---- What is asked for.

// Adds ", NAME" to a list of what there is.
static void list(char *text, size_t size, const char *name) {
  size_t length = strlen(text);
  snprintf(text + length, size - length, "%s%s", length ? ", " : "", name);
}

static Status find_component(const AppPlotAlong *along, const FemVtuField *field, const char *component,
                             int *found) {
  static const char *const vector[] = {"x", "y", "z"}, *const tensor[] = {"xx", "yy", "zz", "xy", "yz", "xz"};
  const char *const *names = field->components == 3 ? vector : tensor;
  char there[64] = "";
  *found = -1;
  if (field->components != 3 && field->components != 6) {
    if (field->components == 1 && !component) return STATUS_OK;
    return status_fail(STATUS_INPUT, "--of is '%s', and %s has no components to choose by name",
                       along->quantity, field->name);
  }
  if (!component && field->components == 3) return STATUS_OK;
  for (int k = 0; k < field->components; k++) {
    if (component && strcmp(component, names[k]) == 0) *found = k;
    list(there, sizeof there, names[k]);
  }
  if (*found >= 0) return STATUS_OK;
  return status_fail(STATUS_INPUT, "--of is '%s'; name a component of %s, as in %s:%s: %s", along->quantity,
                     field->name, field->name, names[field->components - 1], there);
}

static Status find_quantity(const AppPlotAlong *along, const FemVtuContent *frame,
                            AppPlotQuantity *quantity) {
  const char *colon = strchr(along->quantity, ':');
  size_t length = colon ? (size_t)(colon - along->quantity) : strlen(along->quantity);
  char there[1024] = "";
  for (int k = 0; k < frame->field_count; k++) {
    const FemVtuField *field = &frame->fields[k];
    list(there, sizeof there, field->name);
    if (strlen(field->name) != length || strncmp(field->name, along->quantity, length) != 0) continue;
    quantity->field = field;
    return find_component(along, field, colon ? colon + 1 : NULL, &quantity->component);
  }
  return status_fail(STATUS_INPUT, "has no array '%.*s'; it has %s", (int)length, along->quantity, there);
}

// ---- A run.

typedef struct Source {
  const char *directory, *label; // borrowed
  Record *manifest;              // NULL: none
  FemPvdList frames;
} Source;

static void close_source(Source *source) {
  record_destroy(source->manifest);
  fem_pvd_destroy(&source->frames);
}

static Status read_frames(FemPvdList *frames, const char *directory) {
  char *path = file_join(directory, "frames.pvd");
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? fem_pvd_read(path, frames) : STATUS_OK;
  memory_free(path);
  if (status || frames->count > 0) return status;
  return status_fail(STATUS_INPUT,
                     "%s: has no frames to plot along a path; give the DIR of `tetlap run SCENE -o DIR` with "
                     "output.vtu: true, or --along line:NAME of the scene's bodies[].lines",
                     directory);
}

static Status open_source(Source *source, const AppPlotAlong *along, const char *directory,
                          const char *label) {
  *source = (Source){.directory = directory, .label = label};
  Status status = along->path.kind == APP_PLOT_NAMED ? app_plot_named_frames(directory, &source->frames)
                                                     : read_frames(&source->frames, directory);
  if (!status) status = record_read_in(&source->manifest, directory, "manifest.json");
  if (status) close_source(source);
  return status;
}

// Of a body or an obstacle with a mesh, in their order; NULL: there are no more.
static const char *name_of(const Source *source, int body) {
  const Record *scene = record_find(source->manifest, "scene"), *bodies = record_find(scene, "bodies");
  const Record *obstacles = record_find(scene, "obstacles");
  int number = record_count(bodies);
  if (body < number) return record_find_text(record_at(bodies, body), "name");
  for (int k = 0; k < record_count(obstacles); k++)
    if (record_find(record_at(obstacles, k), "mesh") && number++ == body)
      return record_find_text(record_at(obstacles, k), "name");
  return NULL;
}

static Status find_body(const AppPlotAlong *along, const Source *source, int count, int *found) {
  char there[1024] = "";
  *found = -1;
  for (int body = 0; body < count && along->body; body++) {
    const char *name = name_of(source, body);
    if (!name) continue;
    if (strcmp(name, along->body) == 0) *found = body;
    list(there, sizeof there, name);
  }
  if (!along->body || *found >= 0) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: has no body '%s' with elements; it has %s", source->directory,
                     along->body, there);
}

static int nearest(const FemPvdList *frames, double time) {
  int best = 0;
  for (int k = 1; k < frames->count; k++)
    if (fabs(frames->times[k] - time) < fabs(frames->times[best] - time)) best = k;
  return best;
}

static Status choose_frames(const AppPlotAlong *along, const Source *source, int *frames, int *count) {
  double first = source->frames.times[0], last = source->frames.times[source->frames.count - 1];
  *count = 0;
  if (along->time_count == 0) frames[(*count)++] = source->frames.count - 1;
  for (int k = 0; k < along->time_count; k++) {
    if (!(along->times[k] >= first && along->times[k] <= last))
      return status_fail(STATUS_INPUT, "%s: --at has %g, and its frames are from %g to %g s",
                         source->directory, along->times[k], first, last);
    frames[(*count)++] = nearest(&source->frames, along->times[k]);
  }
  return STATUS_OK;
}

// ---- Series.

// Two streams: the data, which come first in the script, and the line that plots them.
typedef struct Series {
  FILE *data, *plot;
  bool is_line; // points are joined
  int count, run_count;
} Series;

static void write_series(Series *series, const AppPlotPoints *points, const char *label, int run) {
  const int number = series->count++;
  const char *hue = hues[number % (int)(sizeof hues / sizeof *hues)];
  fprintf(series->data, "$series%d << END\n", number);
  for (int k = 0; k < points->count; k++) {
    if (k && series->is_line && points->points[k].is_apart) fputs("\n", series->data);
    fprintf(series->data, "%.9g %.9g\n", points->points[k].along, points->points[k].value);
  }
  fputs("END\n", series->data);
  fprintf(series->plot, "%s$series%d using 1:2 ", number ? ", \\\n  " : "plot ", number);
  if (series->is_line)
    fprintf(series->plot, "with lines lw 1.5 lc rgb '%s' dt %s title ", hue, run ? "(6,4)" : "1");
  else
    fprintf(series->plot, "with points pt %d ps 0.5 lc rgb '%s' title ", run ? 6 : 7, hue);
  app_gnuplot_quote(series->plot, label);
}

static Status sample_body(Series *series, const AppPlotAlong *along, const Source *source, int run,
                          const FemVtuContent *frame, double time, int body) {
  AppPlotQuantity quantity;
  AppPlotPoints points;
  char label[MAX_LABEL];
  const char *name = name_of(source, body);
  TRY(find_quantity(along, frame, &quantity));
  Status status = app_plot_sample(&points, frame, &along->path, &quantity, body);
  if (!status && points.count) {
    snprintf(label, sizeof label, "%s%s%s, %.4g s", series->run_count > 1 ? source->label : "",
             series->run_count > 1 ? ", " : "", name ? name : "body", time);
    write_series(series, &points, label, run);
  }
  memory_free(points.points);
  return status;
}

static int count_bodies(const FemVtuContent *frame) {
  double most = -1;
  for (int k = 0; k < frame->field_count; k++) {
    bool is_body = strcmp(frame->fields[k].name, "body") == 0;
    for (int c = 0; is_body && c < frame->cell_count; c++) most = fmax(most, frame->fields[k].values[c]);
  }
  return (int)most + 1;
}

static Status sample_frame(Series *series, const AppPlotAlong *along, const Source *source, int run,
                           int frame) {
  int chosen, count;
  FemVtuContent content;
  char *path = file_join(source->directory, source->frames.files[frame * source->frames.part_count]);
  if (!path) return status_no_memory("a file name");
  Status status = fem_vtu_pieces_read(path, &content);
  if (status) {
    memory_free(path);
    return status;
  }
  count = count_bodies(&content);
  status = find_body(along, source, count, &chosen);
  for (int body = 0; body < count && !status; body++) {
    if (along->body && body != chosen) continue;
    status = sample_body(series, along, source, run, &content, source->frames.times[frame], body);
    if (status == STATUS_INPUT) status = status_prefix(status, "%s", path);
  }
  fem_vtu_read_destroy(&content);
  memory_free(path);
  return status;
}

static Status sample_line(Series *series, const AppPlotAlong *along, const Source *source, int run,
                          int frame) {
  AppPlotPoints points = {0};
  char label[MAX_LABEL];
  Status status = app_plot_named_read(&points, source->directory, frame, along->path.name, along->quantity);
  if (!status && points.count) {
    snprintf(label, sizeof label, "%s%s%.4g s", series->run_count > 1 ? source->label : "",
             series->run_count > 1 ? ", " : "", source->frames.times[frame]);
    write_series(series, &points, label, run);
  }
  memory_free(points.points);
  return status;
}

static Status sample_run(Series *series, const AppPlotAlong *along, const char *directory, const char *label,
                         int run) {
  Source source;
  int frames[APP_PLOT_MAX_TIMES], count = 0;
  TRY(open_source(&source, along, directory, label));
  Status status = choose_frames(along, &source, frames, &count);
  for (int k = 0; k < count && !status; k++)
    status = along->path.kind == APP_PLOT_NAMED ? sample_line(series, along, &source, run, frames[k])
                                                : sample_frame(series, along, &source, run, frames[k]);
  close_source(&source);
  return status;
}

// ---- The script.

static Status write_script(FILE *script, const char *picture, const AppPlotAlong *along, const char *data,
                           const char *plot) {
  char title[64], label[MAX_LABEL], name[FEM_VTU_MAX_NAME];
  snprintf(name, sizeof name, "%.*s", (int)strcspn(along->quantity, ":"), along->quantity);
  const char *unit = unit_of(name);
  snprintf(label, sizeof label, unit ? "%s [%s]" : "%s", along->quantity, unit);
  fprintf(script, "# gnuplot script; run it again with: gnuplot THIS_FILE\n%s", data);
  TRY(app_gnuplot_open(script, picture, WIDTH, HEIGHT));
  fputs("set border 3\nset tics nomirror\nset grid lc rgb '#e4e4e4' lt 1 lw 0.5\n"
        "set key outside right top Left reverse noenhanced font small samplen 2\nset xlabel ",
        script);
  app_gnuplot_quote(script, app_plot_path_title(&along->path, title));
  fputs(" noenhanced\nset ylabel ", script);
  app_gnuplot_quote(script, label);
  fprintf(script, " noenhanced\n%s\n", plot);
  return STATUS_OK;
}

Status app_plot_along(FILE *script, const char *picture, const AppPlotAlong *along,
                      const char *const *directories, int count, const char *const *labels) {
  char *data = NULL, *plot = NULL;
  size_t data_size, plot_size;
  bool is_line = along->path.kind == APP_PLOT_LINE || along->path.kind == APP_PLOT_NAMED;
  Series series = {.is_line = is_line && !(along->path.within > 0),
                   .run_count = count,
                   .data = open_memstream(&data, &data_size),
                   .plot = open_memstream(&plot, &plot_size)};
  Status status = series.data && series.plot ? STATUS_OK : status_no_memory("a plot");
  for (int r = 0; r < count && !status; r++)
    status = sample_run(&series, along, directories[r], labels[r], r);
  if (!status && series.count == 0)
    status = status_fail(STATUS_INPUT, "%s: no %s of the frame; look at its positions", directories[0],
                         along->path.kind == APP_PLOT_NAMED  ? "number along that line"
                         : series.is_line                    ? "line through elements"
                         : along->path.kind == APP_PLOT_LINE ? "vertex of a surface within --within"
                                                             : "vertex of a surface");
  bool is_whole = true;
  if (series.data) is_whole = fclose(series.data) == 0;
  if (series.plot) is_whole = fclose(series.plot) == 0 && is_whole;
  if (!status && !is_whole) status = status_no_memory("a plot");
  if (!status) status = write_script(script, picture, along, data, plot);
  free(data);
  free(plot);
  return status;
}
