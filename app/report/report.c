// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/versions.h"
#include "app/report/codes.h"
#include "app/report/page.h"
#include "app/report/surface.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/vec3.h"

// How many frames a run and the reference have at the same times, vertex for vertex.
static int common_frames(const AppReport *report, int run) {
  const AppReportRun *a = &report->runs[report->reference], *b = &report->runs[run];
  if (a->vertex_count != b->vertex_count || a->frame_count == 0) return 0;
  int least = a->frame_count < b->frame_count ? a->frame_count : b->frame_count, frame = 0;
  double span = a->times[a->frame_count - 1] - a->times[0];
  while (frame < least && fabs(a->times[frame] - b->times[frame]) <= 1e-9 * span) frame++;
  return frame;
}

bool app_report_distance(const AppReport *report, int run, int frame, double *mean, double *largest) {
  if (frame >= common_frames(report, run)) return false;
  const AppReportRun *a = &report->runs[report->reference], *b = &report->runs[run];
  const size_t count = (size_t)a->vertex_count, begin = 3 * (size_t)frame * count;
  double sum = 0;
  *largest = 0;
  for (size_t i = 0; i < count; i++) {
    Vec3 apart = vec3_sub(vec3_at(a->positions + begin + 3 * i), vec3_at(b->positions + begin + 3 * i));
    sum += vec3_dot(apart, apart);
    *largest = fmax(*largest, vec3_length(apart));
  }
  *mean = count ? sqrt(sum / (double)count) : 0;
  return true;
}

static void record_difference(const AppReport *report, int run, RecordList *list) {
  int frames = common_frames(report, run);
  if (run == report->reference || frames < 2) return;
  Record *difference = record_append(list);
  record_integer(difference, "run", run);
  record_numbers(difference, "time_s", report->runs[run].times, frames);
  RecordList *means = record_list(difference, "rms_m"), *largest = record_list(difference, "max_m");
  for (int frame = 0; frame < frames; frame++) {
    double mean, most;
    if (!app_report_distance(report, run, frame, &mean, &most)) return;
    record_append_number(means, mean);
    record_append_number(largest, most);
  }
}

static void record_differences(const AppReport *report, Record *data) {
  if (report->run_count < 2) return;
  record_integer(data, "reference", report->reference);
  RecordList *list = record_list(data, "differences");
  for (int run = 0; run < report->run_count; run++) record_difference(report, run, list);
}

// The last part of a path, whatever slashes it ends in.
static void name_run(const AppReportRun *run, Record *record) {
  size_t end = strlen(run->directory);
  while (end > 1 && run->directory[end - 1] == '/') end--;
  size_t begin = end;
  while (begin > 0 && run->directory[begin - 1] != '/') begin--;
  char *name = memory_zeroed(end - begin + 1, 1);
  if (!name) return; // the page then calls the run by a letter
  memcpy(name, run->directory + begin, end - begin);
  record_text(record, "name", name);
  memory_free(name);
}

// Points in rows, as the frames or a surface have them.
typedef struct Points {
  const double *positions; // [m]                            (row_count, vertex_count, 3)
  int row_count, vertex_count;
} Points;

static Points points_of(const AppReportRun *run) {
  return (Points){run->positions, run->frame_count, run->vertex_count};
}

static Points points_of_obstacles(const AppReportObstacles *obstacles) {
  return (Points){obstacles->positions, obstacles->row_count, obstacles->vertex_count};
}

static AppReportScale points_scale(Points points, int axis) {
  return app_report_codes_scale(points.positions + axis,
                                (size_t)points.row_count * (size_t)points.vertex_count, 3);
}

static void record_scales(Points points, Record *record) {
  double low[3], high[3];
  for (int axis = 0; axis < 3; axis++) {
    AppReportScale scale = points_scale(points, axis);
    low[axis] = scale.low, high[axis] = scale.high;
  }
  record_numbers(record, "low", low, 3);
  record_numbers(record, "high", high, 3);
}

static size_t field_size(const AppReportRun *run, const AppReportField *field) {
  return (size_t)(field->is_cell ? run->tet_count : run->vertex_count);
}

static AppReportScale field_scale(const AppReportRun *run, const AppReportField *field) {
  return app_report_codes_scale(field->values, (size_t)run->frame_count * field_size(run, field), 1);
}

static void record_obstacles(const AppReportRun *run, Record *frames) {
  if (run->obstacles_count == 0) return;
  RecordList *list = record_list(frames, "obstacles");
  for (int k = 0; k < run->obstacles_count; k++) {
    Record *row = record_append(list);
    record_integer(row, "vertices", run->obstacles[k].vertex_count);
    record_integer(row, "triangles", run->obstacles[k].triangle_count);
    record_scales(points_of_obstacles(&run->obstacles[k]), row);
  }
}

// What the page must know of the frames to read their arrays.
static void record_frames(const AppReportRun *run, const AppReportSurface *surface, Record *record) {
  if (run->frame_count == 0) return;
  Record *frames = record_child(record, "frames");
  record_numbers(frames, "time_s", run->times, run->frame_count);
  record_integer(frames, "vertices", run->vertex_count);
  record_integer(frames, "tetrahedra", run->tet_count);
  record_integer(frames, "triangles", surface->triangle_count);
  record_bool(frames, "has_inside", run->tets != NULL);
  record_scales(points_of(run), frames);
  RecordList *fields = record_list(frames, "fields");
  for (int k = 0; k < run->field_count; k++) {
    const AppReportField *field = &run->fields[k];
    AppReportScale scale = field_scale(run, field);
    Record *row = record_append(fields);
    record_text(row, "name", field->name);
    record_text(row, "on", field->is_cell ? "tetrahedra" : "vertices");
    record_bool(row, "is_integer", field->is_integer);
    record_number(row, "low", scale.low);
    record_number(row, "high", scale.high);
  }
  record_obstacles(run, frames);
}

static void record_run(AppReportRun *run, const AppReportSurface *surface, Record *record) {
  name_run(run, record);
  record_adopt(record, "summary", run->summary);
  record_adopt(record, "manifest", run->manifest);
  run->summary = run->manifest = NULL;
  if (run->history) record_text(record, "history", run->history);
  record_frames(run, surface, record);
}

static void record_stresses(AppReport *report, Record *data) {
  if (report->stress_count == 0) return;
  RecordList *list = record_list(data, "stress");
  for (int k = 0; k < report->stress_count; k++) {
    record_adopt(record_append(list), "table", report->stresses[k]);
    report->stresses[k] = NULL;
  }
}

static void record_rest(AppReport *report, Record *data) {
  record_adopt(data, "comparison", report->comparison);
  record_adopt(data, "pareto", report->pareto);
  record_adopt(data, "sweep", report->sweep);
  record_adopt(data, "verdict", report->verdict);
  record_adopt(data, "live", report->live);
  report->comparison = report->pareto = report->sweep = report->verdict = report->live = NULL;
  record_stresses(report, data);
}

// JSON inside a page: no `<` may stand in it, lest it end the element; it can only be part of a text.
static void print_escaped(const char *json, size_t size, FILE *stream) {
  for (size_t i = 0; i < size; i++)
    if (json[i] == '<')
      fputs("\\u003c", stream);
    else
      fputc(json[i], stream);
}

static Status print_record(const Record *data, FILE *stream) {
  char *json = NULL;
  size_t size = 0;
  FILE *buffer = open_memstream(&json, &size);
  if (!buffer) return status_no_memory("the page's records");
  Status status = record_print_line(data, buffer);
  if (fclose(buffer) != 0 && !status) status = status_no_memory("the page's records");
  if (!status) {
    fputs("<script type=\"application/json\" id=\"tetlap-data\">", stream);
    print_escaped(json, size, stream);
    fputs("</script>\n", stream);
  }
  free(json); // by open_memstream
  return status;
}

static void open_array(FILE *stream, int run, const char *name, int k) {
  fprintf(stream, "<script type=\"text/plain\" id=\"run-%d-%s", run, name);
  if (k >= 0) fprintf(stream, "-%d", k);
  fputs("\">", stream);
}

static void close_array(FILE *stream) {
  fputs("</script>\n", stream);
}

static Status print_points(Points points, FILE *stream) {
  const size_t rows = (size_t)points.row_count, row_size = 3 * (size_t)points.vertex_count;
  uint16_t *codes = memory_zeroed(rows * row_size, sizeof *codes);
  if (!codes) return status_no_memory("the positions of a run");
  for (int axis = 0; axis < 3; axis++) {
    AppReportScale scale = points_scale(points, axis);
    for (size_t i = (size_t)axis; i < rows * row_size; i += 3)
      codes[i] = app_report_codes_encode(scale, points.positions[i]);
  }
  Status status = app_report_codes_write(stream, codes, rows, row_size, 3);
  memory_free(codes);
  return status;
}

static Status print_field(const AppReportRun *run, int index, int k, FILE *stream) {
  const AppReportField *field = &run->fields[k];
  const size_t rows = (size_t)run->frame_count, row_size = field_size(run, field);
  AppReportScale scale = field_scale(run, field);
  uint16_t *codes = memory_zeroed(rows * row_size, sizeof *codes);
  if (!codes) return status_no_memory("a field of a run");
  for (size_t i = 0; i < rows * row_size; i++) codes[i] = app_report_codes_encode(scale, field->values[i]);
  open_array(stream, index, "field", k);
  Status status = app_report_codes_write(stream, codes, rows, row_size, 1);
  close_array(stream);
  memory_free(codes);
  return status;
}

static Status print_obstacles(const AppReportObstacles *obstacles, int index, int k, FILE *stream) {
  open_array(stream, index, "obstacle-triangles", k);
  TRY(app_report_codes_write_integers(stream, obstacles->triangles, 5 * (size_t)obstacles->triangle_count,
                                      5));
  close_array(stream);
  open_array(stream, index, "obstacle-positions", k);
  TRY(print_points(points_of_obstacles(obstacles), stream));
  close_array(stream);
  return STATUS_OK;
}

static Status print_arrays(const AppReportRun *run, const AppReportSurface *surface, int index,
                           FILE *stream) {
  if (run->frame_count == 0) return STATUS_OK;
  open_array(stream, index, "triangles", -1);
  TRY(app_report_codes_write_integers(stream, surface->triangles, 4 * (size_t)surface->triangle_count, 4));
  close_array(stream);
  if (run->tets) {
    open_array(stream, index, "tetrahedra", -1);
    TRY(app_report_codes_write_integers(stream, run->tets, 4 * (size_t)run->tet_count, 4));
    close_array(stream);
  }
  open_array(stream, index, "positions", -1);
  TRY(print_points(points_of(run), stream));
  close_array(stream);
  for (int k = 0; k < run->field_count; k++) TRY(print_field(run, index, k, stream));
  for (int k = 0; k < run->obstacles_count; k++) TRY(print_obstacles(&run->obstacles[k], index, k, stream));
  return STATUS_OK;
}

static bool is_too_large(const AppReportRun *run) {
  size_t numbers = 3 * (size_t)run->vertex_count;
  for (int k = 0; k < run->field_count; k++) numbers += field_size(run, &run->fields[k]);
  return numbers * (size_t)run->frame_count > APP_REPORT_MAX_NUMBERS;
}

static Status find_surface(AppReport *report, int r, AppReportSurface *surface) {
  AppReportRun *run = &report->runs[r];
  if (run->frame_count == 0) return STATUS_OK;
  TRY(app_report_surface_find(surface, run));
  bool has_surface_only = report->has_surface_only;
  if (!has_surface_only && is_too_large(run)) {
    log_info("%s: large, so the page cannot cut its bodies open (--frames N takes fewer frames)",
             run->directory);
    has_surface_only = true;
  }
  return has_surface_only ? app_report_surface_strip(surface, run) : STATUS_OK;
}

static Status print_data(AppReport *report, Record *data, AppReportSurface *surfaces, FILE *stream) {
  record_text(data, "version", app_versions_program());
  record_differences(report, data); // needs all vertices
  RecordList *runs = record_list(data, "runs");
  AppModelName models[APP_REPORT_MAX_RUNS];
  // A comparison has named the models of its runs.
  bool has_models = !report->comparison && app_report_run_models(report->runs, report->run_count, models);
  for (int r = 0; r < report->run_count; r++) {
    TRY(find_surface(report, r, &surfaces[r]));
    Record *record = record_append(runs);
    if (has_models) record_text(record, "model", models[r]);
    record_run(&report->runs[r], &surfaces[r], record);
  }
  record_rest(report, data);
  TRY(print_record(data, stream));
  for (int r = 0; r < report->run_count; r++) TRY(print_arrays(&report->runs[r], &surfaces[r], r, stream));
  return STATUS_OK;
}

// The page up to its data. One that is to follow a run may ask the server that it came from.
static void print_head(const char *page, const char *mark, bool is_live, FILE *stream) {
  const char *end = is_live ? strstr(page, APP_REPORT_PAGE_POLICY_END) : NULL;
  if (end && end < mark) {
    fwrite(page, 1, (size_t)(end - page), stream);
    fputs("; connect-src 'self'", stream);
    page = end;
  }
  fwrite(page, 1, (size_t)(mark - page), stream);
}

Status app_report_print(AppReport *report, FILE *stream) {
  const char *page = app_report_page_text(), *mark = strstr(page, APP_REPORT_PAGE_MARK);
  if (!mark) return status_fail(STATUS_IO, "the page in this program has no place for data; build it again");
  Record *data = record_new();
  if (!data) return status_no_memory("the page's records");
  AppReportSurface surfaces[APP_REPORT_MAX_RUNS] = {{0}};
  const char *rest = mark + strlen(APP_REPORT_PAGE_MARK);
  print_head(page, mark, report->live != NULL, stream);
  Status status = print_data(report, data, surfaces, stream);
  fputs(rest, stream);
  for (int r = 0; r < report->run_count; r++) app_report_surface_destroy(&surfaces[r]);
  record_destroy(data);
  return status;
}

Status app_report_write(AppReport *report, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  Status status = app_report_print(report, writer.stream);
  if (!status) return file_commit(&writer);
  file_abandon(&writer);
  return status;
}

void app_report_destroy(AppReport *report) {
  for (int r = 0; r < report->run_count; r++) app_report_run_destroy(&report->runs[r]);
  for (int k = 0; k < report->stress_count; k++) record_destroy(report->stresses[k]);
  record_destroy(report->comparison);
  record_destroy(report->pareto);
  record_destroy(report->sweep);
  record_destroy(report->verdict);
  record_destroy(report->live);
  *report = (AppReport){0};
}
