// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/guard.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/status.h"

// Of this thread: the process and the library of the call in progress.
static _Thread_local pid_t caller; // 0: none
static _Thread_local const char *called;
static void (*at_end)(int code);

int overlap_foreign_guard_leave(const char *function, int code) {
  if (getpid() != caller) return code;
  caller = 0;
  fflush(NULL);
  fprintf(stderr,
          "error: %s: called %s where the program waits for an answer: a model that fails returns a number "
          "other than 0 and a message (tetlap/model.h)\n",
          called, function);
  const int exit_code = status_exit_code(STATUS_SOLVER);
  if (at_end) at_end(exit_code);
  return exit_code;
}

void overlap_foreign_guard_set_end(void (*end)(int code)) {
  at_end = end;
}

// Runs in exit(), in the thread that called it.
static void end_with_failure(void) {
  if (getpid() == caller) _exit(overlap_foreign_guard_leave("exit()", 0));
}

static void register_end(void) {
  atexit(end_with_failure);
}

void overlap_foreign_guard_begin(const char *path) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, register_end);
  caller = getpid(), called = path;
}

void overlap_foreign_guard_end(void) {
  caller = 0;
}
