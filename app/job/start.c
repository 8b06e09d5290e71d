// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/start.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/scene/write.h"
#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "fem/effect/effect.h"
#include "fem/run/checkpoint/checkpoint.h"

// As meshes are: from the folder of the scene file.
static char *find_folder(const FemSceneDef *scene) {
  const char *slash = scene->path ? strrchr(scene->path, '/') : NULL;
  if (!slash || scene->start[0] == '/') return memory_copy(scene->start, strlen(scene->start) + 1, 1);
  const int length = (int)(slash - scene->path) + 1;
  const size_t size = (size_t)length + strlen(scene->start) + 1;
  char *folder = memory_zeroed(size, 1);
  if (folder) snprintf(folder, size, "%.*s%s", length, scene->path, scene->start);
  return folder;
}

// A start has velocities.
static Status check_velocities(const FemSceneDef *scene) {
  for (int b = 0; b < scene->body_count; b++)
    for (int c = 0; c < 3; c++)
      if (scene->bodies[b].velocity[c] != 0 || scene->bodies[b].spin[c] != 0)
        return status_fail(STATUS_INPUT,
                           "%s: body '%s' starts with the velocities of the run that 'start' names: remove "
                           "its 'velocity' and 'spin'",
                           fem_scene_where(scene, &scene->bodies[b].place).text, scene->bodies[b].name);
  return STATUS_OK;
}

// How the run ended; the state of one that did not finish is taken only where the scene says so.
static Status check_outcome(const FemSceneDef *scene, const char *folder) {
  Record *summary = NULL;
  TRY(record_read_in(&summary, folder, "summary.json"));
  const char *outcome = record_find_text(summary, "outcome");
  Status status = STATUS_OK;
  if (!outcome)
    status = status_fail(STATUS_INPUT,
                         "start: %s: has no summary.json that says how a run ended: name the folder that "
                         "`tetlap run` wrote into",
                         folder);
  else if (strcmp(outcome, "finished") != 0 && !scene->starts_anyhow)
    status = status_fail(STATUS_INPUT,
                         "start: %s: the run there has not finished (its outcome is '%s'): write `start: "
                         "{run: %s, outcome: any}` to go on from the last state that it has",
                         folder, outcome, scene->start);
  record_destroy(summary);
  return status;
}

// The end state; of a run that was interrupted its last checkpoint.
static Status read_state(const FemSceneDef *scene, const char *folder, FemCheckpoint *state, char **path) {
  *path = file_join(folder, FEM_CHECKPOINT_END);
  if (!*path) return status_no_memory("a file name");
  if (!file_exists(*path) && scene->starts_anyhow) {
    memory_free(*path);
    *path = file_join(folder, FEM_CHECKPOINT_FILE);
    if (!*path) return status_no_memory("a file name");
  }
  if (file_exists(*path)) return fem_checkpoint_read(state, *path);
  return status_fail(
      STATUS_INPUT,
      "start: %s: there is no state of its end, %s: run it again (with output.checkpoint.frames: "
      "0 none is written)",
      folder, FEM_CHECKPOINT_END);
}

// What differs, in one line.

static Status fail_body(const char *folder, const char *body, const char *what) {
  return status_fail(STATUS_INPUT, "start: %s: %s '%s'", folder, what, body);
}

// Index −1: `material`.
static bool is_plastic(const Record *body, int index) {
  const Record *material =
      index < 0 ? record_find(body, "material") : record_at(record_find(body, "materials"), index);
  return record_find(material, "plasticity") != NULL;
}

static bool selects_alike(const Record *a, const Record *b) {
  static const char *const keys[] = {"group", "box", "halfspace", "radius"};
  RecordDifference difference;
  for (int k = 0; k < 4; k++) {
    const Record *one = record_find(a, keys[k]), *other = record_find(b, keys[k]);
    if (!one != !other || (one && record_differ(one, other, &difference))) return false;
  }
  return true;
}

// What has yielded has a history for each of its points.
static Status check_materials(const char *folder, const Record *was, const Record *is) {
  const Record *parts_was = record_find(was, "materials"), *parts_is = record_find(is, "materials");
  const char *name = record_find_text(is, "name");
  int count = record_count(parts_is);
  bool any = false;
  for (int i = -1; i < count; i++) any = any || is_plastic(is, i);
  for (int i = -1; i < record_count(parts_was); i++) any = any || is_plastic(was, i);
  if (!any) return STATUS_OK;
  if (count != record_count(parts_was))
    return fail_body(folder, name, "`plasticity` and another number of `materials` than there, of body");
  for (int i = -1; i < count; i++)
    if (is_plastic(was, i) != is_plastic(is, i))
      return fail_body(folder, name, "`plasticity` in one of the two runs only, of body");
  for (int i = 0; i < count; i++)
    if (!selects_alike(record_at(parts_was, i), record_at(parts_is, i)))
      return fail_body(folder, name, "`plasticity` and other parts in `materials` than there, of body");
  return STATUS_OK;
}

static Status check_body(const char *folder, const Record *was, const Record *is, const Record *shapes_was,
                         const Record *shapes_is) {
  const char *name = record_find_text(is, "name"), *other = record_find_text(was, "name");
  RecordDifference d;
  if (!other || strcmp(name, other) != 0)
    return status_fail(STATUS_INPUT,
                       "start: %s: the run there has the body '%s' where this scene has '%s': bodies must be "
                       "the same, in the same order",
                       folder, other ? other : "?", name);
  if (record_differ(record_find(shapes_was, name), record_find(shapes_is, name), &d))
    return fail_body(folder, name, "another mesh, `place` or order of elements than there: of body");
  return check_materials(folder, was, is);
}

static Status check_bodies(const char *folder, const Record *origin, const Record *scene,
                           const Record *inputs) {
  const Record *was = record_find(record_find(origin, "scene"), "bodies"), *is = record_find(scene, "bodies");
  if (!was)
    return status_fail(STATUS_INPUT, "start: %s: its end state does not say of which scene it is", folder);
  if (record_count(was) != record_count(is))
    return status_fail(
        STATUS_INPUT,
        "start: %s: the run there and this scene must have the same bodies, but their numbers are %d and %d",
        folder, record_count(was), record_count(is));
  for (int b = 0; b < record_count(is); b++)
    TRY(check_body(folder, record_at(was, b), record_at(is, b), record_find(origin, "shapes"),
                   record_find(inputs, "shapes")));
  return STATUS_OK;
}

static Status check_origin(const FemModel *model, const char *folder, const FemCheckpoint *state,
                           const Record *inputs) {
  Record *origin = NULL, *own = record_new();
  if (!own) return status_no_memory("the start");
  Status status = record_parse(&origin, state->origin, strlen(state->origin), folder);
  if (!status) status = app_scene_write_resolved(model->scene, own);
  if (!status) status = check_bodies(folder, origin, record_find(own, "scene"), inputs);
  if (origin) record_destroy(origin);
  record_destroy(own);
  return status;
}

// What is taken.

static Status take_history(FemStart *start, const FemCheckpoint *state, const char *effect) {
  for (int i = 0; i < state->effect_count; i++) {
    if (strcmp(state->effects[i].name, effect) != 0) continue;
    FemStartHistory *history = &start->histories[start->history_count];
    snprintf(history->effect, sizeof history->effect, "%s", effect);
    history->count = state->effects[i].count;
    history->values = memory_copy(state->effects[i].values, history->count, sizeof *history->values);
    if (!history->values) return status_no_memory("the start");
    start->history_count++;
  }
  return STATUS_OK;
}

// Bodies come first in both, with the same vertices; obstacles begin where this scene says.
static void take_places(FemModel *model, const FemCheckpoint *state) {
  FemStart *start = model->start;
  const int vertices = model->bodies[model->scene->body_count - 1].vertex_end;
  for (int i = 0; i < 3 * vertices; i++) {
    start->displacement[i] = state->displacement[i];
    start->positions[i] += state->displacement[i];
    model->initial_velocity[i] = model->scene->is_static ? 0 : state->velocity[i];
  }
}

static Status take(FemModel *model, const FemCheckpoint *state) {
  const size_t values = 3 * (size_t)model->vertex_count;
  FemStart *start = model->start = memory_zeroed(1, sizeof *start);
  if (!start) return status_no_memory("the start");
  start->time = state->time;
  start->displacement = memory_zeroed(values, sizeof *start->displacement);
  start->positions = memory_copy(model->rest, values, sizeof *model->rest);
  start->interfaces = memory_copy(state->interfaces, strlen(state->interfaces) + 1, 1);
  if (!start->displacement || !start->positions || !start->interfaces) return status_no_memory("the start");
  take_places(model, state);
  TRY(take_history(start, state, fem_effect_plasticity.name));
  return take_history(start, state, fem_effect_stick.name);
}

static bool has_history(const FemStart *start, const char *effect) {
  for (int i = 0; i < start->history_count; i++)
    if (strcmp(start->histories[i].effect, effect) == 0) return true;
  return false;
}

static void tell(const FemModel *model, const char *folder) {
  const FemStart *start = model->start;
  log_info("starts from the end of %s, its t = %g s: positions%s%s%s", folder, start->time,
           model->scene->is_static ? "" : ", velocities",
           has_history(start, fem_effect_plasticity.name) ? ", plastic strains" : "",
           has_history(start, fem_effect_stick.name) ? ", what friction remembers" : "");
}

static Status record_state(const char *path, Record *inputs) {
  char *content, digest[DIGEST_TEXT];
  size_t size;
  TRY(file_read(path, &content, &size));
  digest_print(digest_bytes(DIGEST_START, content, size), digest);
  record_text(inputs, "start", digest);
  memory_free(content);
  return STATUS_OK;
}

static Status read_from(FemModel *model, const char *folder, Record *inputs) {
  FemCheckpoint state = {0};
  char *path = NULL;
  Status status = check_velocities(model->scene);
  if (!status) status = check_outcome(model->scene, folder);
  if (!status) status = read_state(model->scene, folder, &state, &path);
  if (!status) status = check_origin(model, folder, &state, inputs);
  if (!status) status = take(model, &state);
  if (!status) status = record_state(path, inputs);
  if (!status) tell(model, folder);
  fem_checkpoint_destroy(&state);
  memory_free(path);
  return status;
}

Status app_start_read(FemModel *model, const char *directory, Record *inputs) {
  if (!model->scene->start) return STATUS_OK;
  char *folder = find_folder(model->scene), here[PATH_MAX], there[PATH_MAX];
  if (!folder) return status_no_memory("the start");
  bool is_same =
      directory && realpath(directory, here) && realpath(folder, there) && strcmp(here, there) == 0;
  Status status = is_same
                      ? status_fail(STATUS_INPUT,
                                    "start: %s: is the folder that this run would write into: give another "
                                    "by -o",
                                    folder)
                      : read_from(model, folder, inputs);
  memory_free(folder);
  return status;
}
