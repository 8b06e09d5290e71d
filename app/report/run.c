// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/run.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/format.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/output/vtk/pieces_read.h"
#include "fem/output/vtk/pvd.h"
#include "overlap/source.h"

// Whole lines: of a run that goes on, or was killed, the last one may lack its end.
static Status read_history(AppReportRun *run) {
  char *path = file_join(run->directory, "history.csv");
  size_t size;
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? file_read(path, &run->history, &size) : STATUS_OK;
  memory_free(path);
  char *end = run->history ? strrchr(run->history, '\n') : NULL;
  if (end) end[1] = 0;
  return status;
}

// The scalar that stands for a tuple.
static double scalar_of(const double *tuple, int components) {
  switch (components) {
  case 1:
    return tuple[0];
  case 3:
    return sqrt(tuple[0] * tuple[0] + tuple[1] * tuple[1] + tuple[2] * tuple[2]);
  default:
    return -(tuple[0] + tuple[1] + tuple[2]) / 3;
  }
}

static size_t tuples_of(const AppReportRun *run, const AppReportField *field) {
  return (size_t)(field->is_cell ? run->tet_count : run->vertex_count);
}

// Room for the frames, laid out by what the first one has.
static Status lay_out(AppReportRun *run, const FemVtuContent *first) {
  if (first->cell != FEM_VTU_TETRAHEDRA)
    return status_fail(STATUS_INPUT, "has triangles; a frame of bodies has tetrahedra");
  run->vertex_count = first->vertex_count;
  run->tet_count = first->cell_count;
  const size_t frames = (size_t)run->frame_count;
  run->positions = memory_zeroed(frames, 3 * (size_t)run->vertex_count * sizeof *run->positions);
  run->tets = memory_copy(first->cells, 4 * (size_t)run->tet_count, sizeof *run->tets);
  bool ok = run->positions && run->tets;
  for (int k = 0; ok && k < first->field_count; k++) {
    const FemVtuField *source = &first->fields[k];
    if (source->components != 1 && source->components != 3 && source->components != 6) continue;
    AppReportField *field = &run->fields[run->field_count++];
    field->is_cell = source->is_cell;
    field->is_integer = source->is_integer && source->components == 1;
    strcpy(field->name, strcmp(source->name, "stress") == 0 ? "pressure" : source->name);
    field->values = memory_zeroed(frames, tuples_of(run, field) * sizeof *field->values);
    ok = field->values != NULL;
  }
  return ok ? STATUS_OK : status_no_memory("the frames of a run (--frames N takes fewer)");
}

static Status take_field(AppReportRun *run, AppReportField *field, int frame, const FemVtuContent *content) {
  const char *name = strcmp(field->name, "pressure") == 0 ? "stress" : field->name;
  const size_t count = tuples_of(run, field);
  double *values = field->values + (size_t)frame * count;
  for (int k = 0; k < content->field_count; k++) {
    const FemVtuField *source = &content->fields[k];
    if (source->is_cell != field->is_cell || strcmp(source->name, name) != 0) continue;
    for (size_t i = 0; i < count; i++)
      values[i] = scalar_of(source->values + i * (size_t)source->components, source->components);
    return STATUS_OK;
  }
  return status_fail(STATUS_INPUT, "the array '%s' of the first frame is missing", name);
}

static Status take_frame(AppReportRun *run, int frame, const FemVtuContent *content) {
  if (frame == 0) TRY(lay_out(run, content));
  const size_t numbers = 3 * (size_t)run->vertex_count;
  if (content->vertex_count != run->vertex_count || content->cell_count != run->tet_count ||
      memcmp(content->cells, run->tets, 4 * (size_t)run->tet_count * sizeof *run->tets) != 0)
    return status_fail(STATUS_INPUT,
                       "has another mesh than the first frame; frames of several runs are mixed");
  memcpy(run->positions + (size_t)frame * numbers, content->positions, numbers * sizeof *run->positions);
  for (int k = 0; k < run->field_count; k++) TRY(take_field(run, &run->fields[k], frame, content));
  return STATUS_OK;
}

static Status read_frame(AppReportRun *run, int frame, const char *name) {
  char *path = file_join(run->directory, name);
  if (!path) return status_no_memory("a file name");
  FemVtuContent content;
  Status status = fem_vtu_pieces_read(path, &content);
  if (!status) {
    status = take_frame(run, frame, &content);
    if (status == STATUS_INPUT) status = status_prefix(status, "%s", path);
    fem_vtu_read_destroy(&content);
  }
  memory_free(path);
  return status;
}

// Which frame of the list stands at place `frame` when `kept` of `count` are kept.
static int chosen(int frame, int kept, int count) {
  return kept < 2 ? count - 1 : (int)((long long)frame * (count - 1) / (kept - 1));
}

// The obstacles without a mesh at those frames of the list.
static Status read_obstacles(AppReportRun *run, const FemPvdList *list, const int *chosen_frames) {
  if (list->part_count - 1 > APP_REPORT_MAX_OBSTACLES)
    return status_fail(STATUS_INPUT, "%s: frames.pvd has %d parts, at most %d are known", run->directory,
                       list->part_count, 1 + APP_REPORT_MAX_OBSTACLES);
  for (int part = 1; part < list->part_count; part++) {
    AppReportObstacles *obstacles = &run->obstacles[part - 1];
    TRY(app_report_obstacles_read(obstacles, run->directory, list, part, chosen_frames, run->frame_count));
    run->obstacles_count++;
  }
  return STATUS_OK;
}

static Status read_frames(AppReportRun *run, int max_frames) {
  char *path = file_join(run->directory, "frames.pvd");
  if (!path) return status_no_memory("a file name");
  FemPvdList list = {0};
  Status status = file_exists(path) ? fem_pvd_read(path, &list) : STATUS_OK;
  memory_free(path);
  if (status) return status;
  run->frame_count = max_frames > 0 && max_frames < list.count ? max_frames : list.count;
  run->times = memory_zeroed((size_t)run->frame_count, sizeof *run->times);
  int *chosen_frames = memory_zeroed((size_t)run->frame_count, sizeof *chosen_frames);
  if (!run->times || !chosen_frames) status = status_no_memory("the times of the frames");
  for (int frame = 0; !status && frame < run->frame_count; frame++) {
    int k = chosen(frame, run->frame_count, list.count);
    chosen_frames[frame] = k;
    run->times[frame] = list.times[k];
    status = read_frame(run, frame, list.files[k * list.part_count]);
  }
  if (!status) status = read_obstacles(run, &list, chosen_frames);
  memory_free(chosen_frames);
  fem_pvd_destroy(&list);
  return status;
}

static Status check_format(const AppReportRun *run) {
  const char *program = record_find_text(record_find(run->manifest, "versions"), "tetlap");
  TRY(app_format_check(run->manifest, run->directory, "manifest.json", program));
  return app_format_check(run->summary, run->directory, "summary.json", program);
}

static Status read_all(AppReportRun *run, int max_frames) {
  TRY(record_read_in(&run->summary, run->directory, "summary.json"));
  TRY(record_read_in(&run->manifest, run->directory, "manifest.json"));
  TRY(check_format(run));
  TRY(read_history(run));
  TRY(read_frames(run, max_frames));
  if (!run->summary && !run->manifest && !run->history && run->frame_count == 0)
    return status_fail(STATUS_INPUT,
                       "%s: is not the directory of a run: there is no summary.json, no history.csv and no "
                       "frames.pvd; give the DIR of `tetlap run SCENE -o DIR`",
                       run->directory);
  return STATUS_OK;
}

Status app_report_run_read(AppReportRun *run, const char *directory, int max_frames) {
  *run = (AppReportRun){0};
  run->directory = memory_copy(directory, strlen(directory) + 1, 1);
  Status status = run->directory ? read_all(run, max_frames) : status_no_memory("a file name");
  if (status) app_report_run_destroy(run);
  return status;
}

void app_report_run_destroy(AppReportRun *run) {
  for (int k = 0; k < run->field_count; k++) memory_free(run->fields[k].values);
  for (int k = 0; k < run->obstacles_count; k++) app_report_obstacles_destroy(&run->obstacles[k]);
  record_destroy(run->summary);
  record_destroy(run->manifest);
  memory_free(run->history);
  memory_free(run->times);
  memory_free(run->positions);
  memory_free(run->tets);
  memory_free(run->directory);
  *run = (AppReportRun){0};
}

enum { SOURCE_SIZE = PATH_MAX + APP_MODEL_NAME };

// As a command line would name the model that a summary names. False: it names none.
static bool find_source(const Record *summary, char source[SOURCE_SIZE]) {
  const char *overlap = record_find_text(summary, "overlap"), *weights = record_find_text(summary, "weights");
  if (!overlap) return false;
  const int before = weights ? (int)(overlap_source_model(overlap) - overlap) : 0; // its wrappers
  snprintf(source, SOURCE_SIZE, "%.*s%s", before, overlap, weights ? weights : overlap);
  return true;
}

bool app_report_run_models(const AppReportRun *runs, int count, AppModelName *names) {
  char(*texts)[SOURCE_SIZE] = memory_zeroed((size_t)count + 1, sizeof *texts);
  const char **sources = memory_zeroed((size_t)count + 1, sizeof *sources);
  bool is_known = texts && sources;
  for (int r = 0; r < count && is_known; r++) {
    is_known = find_source(runs[r].summary, texts[r]);
    sources[r] = texts[r];
  }
  is_known = is_known && app_model_names_find(count, sources, names) == STATUS_OK;
  memory_free(texts), memory_free(sources);
  return is_known;
}
