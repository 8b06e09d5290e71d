// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/replay.h"

#include <math.h>
#include <string.h>

#include "app/loop/diary.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "fem/run/session.h"

typedef struct Replay {
  const AppJob *job;
  const FemRunOptions *outer; // whose observer sees the run
  FemRunSession *session;
  AppLoopGroups groups;
  double stopped; // the step that reaches it ends the advance; INFINITY: none does [s]
} Replay;

static Status observe(void *self, const FemRunProgress *progress) {
  Replay *replay = self;
  if (replay->session && progress->time >= replay->stopped) fem_run_session_stop(replay->session);
  return replay->outer->observe ? replay->outer->observe(replay->outer->observer, progress) : STATUS_OK;
}

static Status set(Replay *replay, AppLoopKind kind, const char *name, const Record *line) {
  const FemRunState *run = fem_run_session_state(replay->session);
  const Record *to = record_find(line, "to");
  const double given = record_find_number(line, "ramp"), ramp = isnan(given) ? APP_LOOP_NEXT_ADVANCE : given;
  const int count = record_count(to);
  AppLoopGroup *group;
  bool jumps;
  TRY(app_loop_groups_find(&replay->groups, kind, name, &group));
  double *values = memory_zeroed((size_t)count, sizeof *values);
  if (!values) return status_no_memory("what is set");
  for (int i = 0; i < count; i++) values[i] = record_number_value(record_at(to, i));
  Status status = app_loop_group_set(&replay->groups, group, run->time, ramp, values, count,
                                     run->trial.positions, &jumps);
  memory_free(values);
  if (status || group->is_pending) return status;
  return fem_run_session_change(replay->session, jumps);
}

static Status advance(Replay *replay, double until, double stopped) {
  const double time = fem_run_session_state(replay->session)->time;
  bool has_changed = false;
  replay->stopped = isnan(stopped) ? INFINITY : stopped;
  TRY(fem_run_session_check(replay->session, until));
  if (until > time) TRY(app_loop_groups_begin(&replay->groups, time, until, &has_changed));
  if (has_changed) TRY(fem_run_session_change(replay->session, false));
  return fem_run_session_advance(replay->session, until);
}

static Status begin_anew(Replay *replay) {
  FemCheckpoint state;
  TRY(fem_run_session_keep(replay->session, &state));
  fem_checkpoint_destroy(&state);
  return STATUS_OK;
}

static Status check_first(const Replay *replay, const Record *line) {
  const double vertices = record_find_number(line, "vertices");
  if (record_find_number(line, "format") != APP_LOOP_DIARY_FORMAT)
    return status_fail(STATUS_INPUT, "is no record of a run that was stepped, of format %d",
                       APP_LOOP_DIARY_FORMAT);
  if (vertices == replay->job->model.vertex_count) return STATUS_OK;
  return status_fail(STATUS_INPUT, "is of a scene with %g vertices, this one has %d", vertices,
                     replay->job->model.vertex_count);
}

static Status follow(Replay *replay, const Record *line) {
  const char *drive = record_find_text(line, "drive"), *load = record_find_text(line, "load");
  const double until = record_find_number(line, "advance");
  if (drive) return set(replay, APP_LOOP_DRIVE, drive, line);
  if (load) return set(replay, APP_LOOP_LOAD, load, line);
  if (!isnan(until)) return advance(replay, until, record_find_number(line, "stopped"));
  if (record_find(line, "anew")) return begin_anew(replay);
  return status_fail(STATUS_INPUT, "expected drive, load, advance or anew");
}

static Status follow_text(Replay *replay, const char *text, const char *path) {
  int number = 1;
  for (const char *at = text, *end; *at; at = end + (*end != 0), number++) {
    Record *line;
    end = strchr(at, '\n') ? strchr(at, '\n') : at + strlen(at);
    Status status = record_parse(&line, at, (size_t)(end - at), path);
    if (!status) status = number == 1 ? check_first(replay, line) : follow(replay, line);
    record_destroy(line);
    if (status == STATUS_INPUT) return status_prefix(status, "%s:%d", path, number);
    TRY(status);
  }
  return STATUS_OK;
}

static Status go_through(Replay *replay, const char *text, const char *path) {
  TRY(follow_text(replay, text, path));
  replay->stopped = INFINITY;
  return fem_run_session_advance(replay->session, replay->job->scene.end);
}

Status app_loop_replay(AppJob *job, const FemRunOptions *options, FemRunResult *result, const char *path) {
  Replay replay = {.job = job, .outer = options, .stopped = INFINITY};
  FemRunOptions inner = *options;
  char *text;
  size_t size;
  inner.observe = observe, inner.observer = &replay;
  TRY(file_read(path, &text, &size));
  Status status = app_loop_groups_create(&replay.groups, &job->scene, &job->model);
  if (!status) status = fem_run_session_open(&replay.session, &job->model, &inner, result);
  if (!status) status = go_through(&replay, text, path);
  if (replay.session) status = fem_run_session_close(replay.session, status);
  app_loop_groups_destroy(&replay.groups);
  memory_free(text);
  return status;
}
