// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/point.h"

#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/format.h"
#include "app/cli/versions.h"
#include "app/job/inputs.h"
#include "app/job/start.h"
#include "app/scene/overlap.h"
#include "app/scene/write.h"
#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "fem/model/build.h"
#include "fem/run/checkpoint/checkpoint.h"

int app_sweep_point_count(const AppSweepBase *base) {
  int count = base->repeat_count;
  for (int a = 0; a < base->axis_count && count <= APP_SWEEP_MAX_POINTS; a++)
    if (!base->axes[a].is_linked) count *= base->axes[a].value_count;
  return count;
}

// Readable where it can be: "contact.stiffness=1e6,contact.overlap=clip"; what a folder's name should not
// have becomes '_', and then, or where it is long, a digest distinguishes it from others.
static void name_folder(AppSweepPoint *point, const AppSweepBase *base) {
  enum { ROOM = APP_SWEEP_FOLDER - DIGEST_TEXT - 1 };
  char whole[1024];
  size_t used = 0;
  uint64_t digest = DIGEST_START;
  for (int a = 0; a < base->axis_count; a++) {
    const AppSweepAxis *axis = &base->axes[a];
    text_append(whole, sizeof whole, &used, "%s%s=%s", a ? "," : "", axis->key,
                axis->values[point->values[a]]);
    digest = digest_bytes(digest, point->settings[a], strlen(point->settings[a]) + 1);
  }
  if (base->axis_count == 0) text_append(whole, sizeof whole, &used, "run");
  if (point->repeat > 0) {
    text_append(whole, sizeof whole, &used, ",repeat=%d", point->repeat + 1);
    digest = digest_bytes(digest, &point->repeat, sizeof point->repeat);
  }
  bool is_plain = used < ROOM;
  size_t length = is_plain ? used : ROOM;
  for (size_t i = 0; i < length; i++) {
    bool is_fit = isalnum((unsigned char)whole[i]) || strchr("=,.+-_", whole[i]);
    point->folder[i] = is_fit ? whole[i] : '_';
    is_plain = is_plain && is_fit;
  }
  if (is_plain) return;
  point->folder[length] = '-';
  digest_print(digest, point->folder + length + 1);
}

// Returns the repeat.
static int number_values(AppSweepPoint *point, const AppSweepBase *base, int index) {
  for (int a = base->axis_count - 1; a >= 0; a--) {
    if (base->axes[a].is_linked) continue;
    point->values[a] = index % base->axes[a].value_count;
    index /= base->axes[a].value_count;
    for (int b = a + 1; b < base->axis_count && base->axes[b].is_linked; b++)
      point->values[b] = point->values[a];
  }
  return index;
}

Status app_sweep_point_create(AppSweepPoint *point, const AppSweepBase *base, int index) {
  *point = (AppSweepPoint){0};
  point->repeat = number_values(point, base, index);
  for (int a = 0; a < base->axis_count; a++) {
    const AppSweepAxis *axis = &base->axes[a];
    const char *value = axis->values[point->values[a]];
    size_t size = strlen(axis->key) + strlen(value) + 2;
    point->settings[a] = memory_zeroed(size, 1);
    if (!point->settings[a]) return status_no_memory("the points of a sweep");
    snprintf(point->settings[a], size, "%s=%s", axis->key, value);
  }
  name_folder(point, base);
  point->directory = file_join(base->directory, point->folder);
  return point->directory ? STATUS_OK : status_no_memory("the points of a sweep");
}

void app_sweep_point_destroy(AppSweepPoint *point) {
  for (int a = 0; a < APP_SWEEP_MAX_AXES; a++) memory_free(point->settings[a]);
  memory_free(point->directory);
  memory_free(point->history);
  record_destroy(point->summary);
  *point = (AppSweepPoint){0};
}

static Status read_scene(const AppSweepPoint *point, const AppSweepBase *base, FemSceneDef *scene) {
  const char **overrides =
      memory_zeroed((size_t)(base->override_count + base->axis_count), sizeof *overrides);
  if (!overrides) return status_no_memory("the points of a sweep");
  int count = 0;
  for (; count < base->override_count; count++) overrides[count] = base->overrides[count];
  for (int a = 0; a < base->axis_count; a++) overrides[count++] = point->settings[a];
  Status status = app_scene_overlap_read(base->scene_path, overrides, count, base->overlap, scene);
  memory_free(overrides);
  return status;
}

// A file of the folder as a record; NULL: it is not there, or is no record.
static Record *read_record(const char *directory, const char *name) {
  Record *record;
  return record_read_in(&record, directory, name) == STATUS_OK ? record : NULL;
}

static bool has_file(const char *directory, const char *name) {
  char *path = file_join(directory, name);
  bool is_there = path && file_exists(path);
  memory_free(path);
  return is_there;
}

// Whether a run of this scene, as it would be read now by this program, is the one in the manifest.
// Threads change no result.
static bool is_same_scene(const Record *manifest, const FemSceneDef *scene) {
  const char *version = record_find_text(record_find(manifest, "versions"), "tetlap");
  const Record *was = record_find(manifest, "scene");
  double threads = record_find_number(record_find(was, "solver"), "threads");
  FemSceneDef same = *scene; // borrows all that it points to
  same.threads = threads >= 0 ? (int)threads : 0;
  Record *now = record_new();
  RecordDifference difference;
  bool is_same = now && version && strcmp(version, app_versions_program()) == 0 &&
                 record_find_number(manifest, "format") == APP_FORMAT &&
                 app_scene_write_resolved(&same, now) == STATUS_OK &&
                 !record_differ(was, record_find(now, "scene"), &difference);
  record_destroy(now);
  return is_same;
}

// Whether meshes, weights and the end state to start from, as they are now, are those that the manifest has
// digests of. What cannot be read now is another.
static bool is_same_input(const Record *manifest, const FemSceneDef *scene) {
  FemModel model;
  Record *now = record_new();
  bool is_same = now && fem_model_create(&model, scene) == STATUS_OK;
  if (is_same) {
    is_same = app_inputs_record(scene, &model, now) == STATUS_OK &&
              app_start_read(&model, NULL, now) == STATUS_OK &&
              !app_inputs_differ(record_find(manifest, "inputs"), now);
    fem_model_destroy(&model);
  }
  record_destroy(now);
  return is_same;
}

// How the earlier sweep saw this point end; −1: it does not tell.
static int exit_code_before(const AppSweepPoint *point, const Record *before) {
  const Record *runs = record_find(before, "runs");
  for (int k = 0; k < record_count(runs); k++) {
    const char *folder = record_find_text(record_at(runs, k), "folder");
    double code = record_find_number(record_at(runs, k), "exit_code");
    if (folder && strcmp(folder, point->folder) == 0 && code >= 0) return (int)code;
  }
  return -1;
}

static void set_message(AppSweepPoint *point, const char *message) {
  snprintf(point->message, sizeof point->message, "%s", message ? message : "");
}

// Without memory the page goes without this course.
static void read_history(AppSweepPoint *point) {
  if (!point->history) point->history = memory_zeroed(1, sizeof *point->history);
  if (point->history && app_sweep_history_read(point->history, point->directory)) point->history->count = 0;
}

// What to do with a folder that is there already.
static void decide_state(AppSweepPoint *point, const FemSceneDef *scene, const Record *before, bool again) {
  Record *summary = read_record(point->directory, "summary.json"),
         *manifest = read_record(point->directory, "manifest.json");
  const char *outcome = record_find_text(summary, "outcome");
  bool is_scene = is_same_scene(manifest, scene),
       is_same = outcome && is_scene && is_same_input(manifest, scene);
  record_destroy(manifest);
  int code = exit_code_before(point, before), gave_up = status_exit_code(STATUS_SOLVER);
  bool has_finished =
      is_same && (strcmp(outcome, "finished") == 0 || (code == 0 && strcmp(outcome, "interrupted") != 0));
  if (has_finished)
    point->state = APP_SWEEP_FINISHED;
  else if (is_same && !again && strcmp(outcome, "failed") == 0 && code == gave_up)
    point->state = APP_SWEEP_FAILED, point->exit_code = gave_up;
  else
    point->state =
        is_scene && has_file(point->directory, FEM_CHECKPOINT_FILE) ? APP_SWEEP_RESUMABLE : APP_SWEEP_WAITING;
  bool has_ended = point->state == APP_SWEEP_FINISHED || point->state == APP_SWEEP_FAILED;
  if (point->state == APP_SWEEP_FAILED) set_message(point, record_find_text(summary, "message"));
  point->summary = has_ended ? summary : NULL;
  if (has_ended)
    read_history(point);
  else
    record_destroy(summary);
}

Status app_sweep_point_examine(AppSweepPoint *point, const AppSweepBase *base, const Record *before,
                               bool again) {
  FemSceneDef scene;
  Status status = read_scene(point, base, &scene);
  if (status) {
    point->state = APP_SWEEP_FAILED;
    point->exit_code = status_exit_code(status);
    set_message(point, status_message());
    return status;
  }
  decide_state(point, &scene, before, again);
  fem_scene_destroy(&scene);
  return STATUS_OK;
}

// Copies the line that begins at `line`.
static void set_line(AppSweepPoint *point, const char *line) {
  snprintf(point->message, sizeof point->message, "%.*s", (int)strcspn(line, "\n"), line);
}

// The last error that this process logged, else how it ended.
static void explain(AppSweepPoint *point) {
  static const char mark[] = "error: ";
  char *path = file_join(point->directory, APP_SWEEP_LOG), *text = NULL;
  size_t size;
  snprintf(point->message, sizeof point->message,
           point->exit_code > 128 ? "the process was ended by signal %d" : "exit code %d; see " APP_SWEEP_LOG,
           point->exit_code > 128 ? point->exit_code - 128 : point->exit_code);
  if (path && file_read(path, &text, &size) == STATUS_OK && point->log_begin <= size)
    for (char *at = strstr(text + point->log_begin, mark); at; at = strstr(at + 1, mark))
      set_line(point, at + sizeof mark - 1);
  memory_free(text);
  memory_free(path);
}

void app_sweep_point_conclude(AppSweepPoint *point, int exit_code) {
  record_destroy(point->summary);
  point->exit_code = exit_code;
  point->summary = read_record(point->directory, "summary.json");
  point->state = exit_code == 0 ? APP_SWEEP_FINISHED : APP_SWEEP_FAILED;
  point->message[0] = 0;
  read_history(point);
  if (exit_code == 0) return;
  const char *message = record_find_text(point->summary, "message");
  if (message)
    set_message(point, message);
  else
    explain(point);
}
