// SPDX-License-Identifier: GPL-3.0-or-later
#include "faults.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FUNCTIONS = 40 };

static struct {
  const char *names[MOST_FUNCTIONS]; // the functions', constant texts
  int calls[MOST_FUNCTIONS];
  int count, all, kept;
  char function[64]; // that fails; "": any
  int call, code;
  FakeKind kind;
  int is_down;        // all that follows fails
  const char *failed; // the first that did
} state = {.call = -1};

void fake_fail(const char *function, int call, int code, FakeKind kind) {
  memset(state.calls, 0, sizeof state.calls);
  state.all = state.is_down = 0, state.failed = NULL;
  snprintf(state.function, sizeof state.function, "%s", function ? function : "");
  state.call = call, state.code = code, state.kind = kind;
}

static int find(const char *function) {
  for (int k = 0; k < state.count; k++)
    if (strcmp(state.names[k], function) == 0) return k;
  return -1;
}

int fake_calls(const char *function) {
  const int k = function ? find(function) : -1;
  return !function ? state.all : k < 0 ? 0 : state.calls[k];
}

const char *fake_failed(void) {
  return state.failed;
}

int fake_kept(void) {
  return state.kept;
}

void fake_keep(int objects) {
  state.kept += objects;
}

int fake_ask(const char *function) {
  int k = find(function);
  if (k < 0) {
    if (state.count == MOST_FUNCTIONS) abort();
    k = state.count++;
    state.names[k] = function;
  }
  const int call_of_it = state.calls[k]++, call_of_all = state.all++;
  const int is_told = state.function[0] ? strcmp(state.function, function) == 0 && call_of_it == state.call
                                        : call_of_all == state.call;
  const int fails = state.is_down || (is_told && state.kind != FAKE_LATER);
  if (is_told && state.kind != FAKE_ONCE) state.is_down = 1;
  if (fails && !state.failed) state.failed = function;
  return fails ? state.code : 0;
}

__attribute__((constructor)) static void read_environment(void) {
  const char *told = getenv("FAKE_FAIL");
  char function[64], kind[16] = "once";
  int call, code;
  if (!told || sscanf(told, "%63[^:]:%d:%d:%15s", function, &call, &code, kind) < 3) return;
  fake_fail(function, call, code,
            strcmp(kind, "lost") == 0    ? FAKE_LOST
            : strcmp(kind, "later") == 0 ? FAKE_LATER
                                         : FAKE_ONCE);
}

__attribute__((destructor)) static void tell_calls(void) {
  const char *path = getenv("FAKE_CALLS");
  FILE *file = path ? fopen(path, "a") : NULL;
  for (int k = 0; k < state.count && file; k++) fprintf(file, "%s %d\n", state.names[k], state.calls[k]);
  if (file) fclose(file);
  if (state.kept != 0) fprintf(stderr, "driver of tests: %d objects are kept\n", state.kept);
}
