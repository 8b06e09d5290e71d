// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/loop/state.h"

#include <string.h>

#include "app/job/origin.h"
#include "base/memory.h"

static size_t count_of(const AppLoop *loop) {
  return app_loop_groups_save(&loop->groups, NULL) + 3 * (size_t)loop->contact_count;
}

void app_loop_state_destroy(AppLoopState *state) {
  fem_checkpoint_destroy(&state->checkpoint);
  memory_free(state->values);
  app_loop_diary_destroy(&state->diary);
  *state = (AppLoopState){0};
}

static Status keep_values(const AppLoop *loop, AppLoopState *state) {
  state->count = count_of(loop);
  state->values = memory_zeroed(state->count, sizeof *state->values);
  if (!state->values) return status_no_memory("a state");
  double *impulses = state->values + app_loop_groups_save(&loop->groups, state->values);
  for (int i = 0; i < loop->contact_count; i++)
    memcpy(impulses + 3 * (size_t)i, loop->contacts[i].impulse, sizeof loop->contacts[i].impulse);
  return STATUS_OK;
}

Status app_loop_state_keep(AppLoop *loop, AppLoopState *state) {
  *state = (AppLoopState){0};
  TRY(fem_run_session_keep(loop->session, &state->checkpoint));
  TRY(app_loop_read(loop));
  TRY(app_loop_diary_anew(&loop->diary));
  TRY(app_loop_diary_copy(&state->diary, &loop->diary));
  return keep_values(loop, state);
}

Status app_loop_state_restore(AppLoop *loop, const AppLoopState *state) {
  if (state->count != count_of(loop) || state->checkpoint.vertex_count != loop->job.model.vertex_count)
    return status_fail(STATUS_INPUT, "the state is of another scene: it has %d vertices, this one has %d",
                       state->checkpoint.vertex_count, loop->job.model.vertex_count);
  const size_t groups = app_loop_groups_save(&loop->groups, NULL);
  TRY(app_loop_groups_load(&loop->groups, state->values, groups));
  TRY(fem_run_session_restore(loop->session, &state->checkpoint));
  TRY(app_loop_diary_copy(&loop->diary, &state->diary));
  TRY(app_loop_read(loop));
  for (int i = 0; i < loop->contact_count; i++)
    memcpy(loop->contacts[i].impulse, state->values + groups + 3 * (size_t)i,
           sizeof loop->contacts[i].impulse);
  return STATUS_OK;
}

// Beside the scene's, in the words that a checkpoint keeps for the program that wrote it.
static char *describe(const AppLoop *loop, const AppLoopState *state) {
  Record *record = record_new();
  record_merge(record, loop->origin);
  record_numbers(record, "values", state->values, (int)state->count);
  record_text(record, "diary", state->diary.text);
  char *text = record_text_of(record);
  record_destroy(record);
  return text;
}

Status app_loop_state_write(const AppLoop *loop, const AppLoopState *state, const char *path) {
  FemCheckpoint checkpoint = state->checkpoint; // borrows all but the words
  checkpoint.origin = describe(loop, state);
  Status status = checkpoint.origin ? fem_checkpoint_write(&checkpoint, path) : status_no_memory("a state");
  memory_free(checkpoint.origin);
  return status;
}

static Status read_words(const AppLoop *loop, const Record *words, AppLoopState *state, const char *path) {
  const Record *values = record_find(words, "values");
  const char *diary = record_find_text(words, "diary");
  TRY(app_origin_compare(words, loop->origin, path));
  if (!values || !diary)
    return status_fail(STATUS_INPUT,
                       "%s: is a checkpoint of `tetlap run`, not a state of a run that was stepped", path);
  state->count = (size_t)record_count(values);
  state->values = memory_zeroed(state->count, sizeof *state->values);
  if (!state->values) return status_no_memory("a state");
  for (size_t i = 0; i < state->count; i++) state->values[i] = record_number_value(record_at(values, (int)i));
  const AppLoopDiary words_of = {.text = (char *)diary, .size = strlen(diary)};
  return app_loop_diary_copy(&state->diary, &words_of);
}

Status app_loop_state_read(const AppLoop *loop, AppLoopState *state, const char *path) {
  Record *words = NULL;
  *state = (AppLoopState){0};
  TRY(fem_checkpoint_read(&state->checkpoint, path));
  const char *origin = state->checkpoint.origin ? state->checkpoint.origin : "{}";
  Status status = record_parse(&words, origin, strlen(origin), path);
  if (!status) status = read_words(loop, words, state, path);
  record_destroy(words);
  return status;
}
