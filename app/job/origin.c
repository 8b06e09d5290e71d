// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/origin.h"

#include <limits.h>
#include <stdlib.h>

#include "app/cli/model_names.h"
#include "app/cli/versions.h"
#include "app/scene/write.h"

// The scene but for what changes no result.
static Status record_scene(const FemSceneDef *scene, Record *origin) {
  FemSceneDef same = *scene; // borrows all that it points to
  same.threads = 0;
  same.checkpoint_seconds = 0;
  return app_scene_write_resolved(&same, origin);
}

Status app_origin_make(const AppJob *job, const AppJobOptions *options, const char *overlap,
                       Record **origin) {
  Record *record = *origin = record_new();
  if (!record) return status_no_memory("the run's origin");
  record_text(record, "program", app_versions_line());
  record_text(record, "instructions", app_versions_simd());
  record_text(record, "command", app_versions_command());
  char absolute[PATH_MAX], word[PATH_MAX];
  const char *path = options->scene_path;
  record_text(record, "scene_file", realpath(path, absolute) ? absolute : path);
  RecordList *overrides = record_list(record, "set");
  for (int i = 0; i < options->override_count; i++) record_append_text(overrides, options->overrides[i]);
  record_text(record, "overlap", overlap && app_model_names_settle(overlap, word) ? word : overlap);
  record_merge(record, job->inputs);
  Status status = record_scene(&job->scene, record);
  if (!status) return STATUS_OK;
  record_destroy(record);
  *origin = NULL;
  return status;
}

Status app_origin_compare(const Record *was, const Record *is, const char *path) {
  static const char *const keys[] = {"program", "scene", "meshes", "weights", "start"};
  RecordDifference d = {{0}, {0}, {0}};
  int k = 0;
  while (k < 5 && !record_differ(record_find(was, keys[k]), record_find(is, keys[k]), &d)) k++;
  static const char advice[] = "put it back, or begin anew";
  switch (k) {
  case 0:
    return status_fail(STATUS_INPUT,
                       "%s: was written by %s; this is %s: resume with that program, or start again", path,
                       d.a, d.b);
  case 1:
    return status_fail(STATUS_INPUT, "%s: the scene has changed: %s was %s and is now %s; %s", path, d.place,
                       d.a, d.b, advice);
  case 2:
    return status_fail(STATUS_INPUT, "%s: the mesh of '%s' has changed; %s", path, d.place, advice);
  case 3:
    return status_fail(STATUS_INPUT, "%s: the weights in %s have changed; %s", path,
                       record_find_text(is, "weights_file"), advice);
  case 4:
    return status_fail(STATUS_INPUT, "%s: the end state that the run started from has changed; %s", path,
                       advice);
  default:
    return STATUS_OK;
  }
}

Status app_origin_read(const Record *origin, const char *path, AppJobOptions *options, const char **overlap) {
  options->scene_path = record_find_text(origin, "scene_file");
  *overlap = record_find_text(origin, "overlap");
  const Record *overrides = record_find(origin, "set");
  if (record_find(origin, "replay"))
    return status_fail(STATUS_INPUT,
                       "%s: is of a run with --replay %s, which cannot be taken up: start it again", path,
                       record_find_text(origin, "replay"));
  if (!options->scene_path || !overrides || record_count(overrides) > APP_MAX_OVERRIDES)
    return status_fail(STATUS_INPUT, "%s: does not say which scene it belongs to", path);
  for (int i = 0; i < record_count(overrides); i++) {
    const char *text = record_text_value(record_at(overrides, i));
    if (!text) return status_fail(STATUS_INPUT, "%s: does not say which scene it belongs to", path);
    options->overrides[options->override_count++] = text;
  }
  return STATUS_OK;
}
