// SPDX-License-Identifier: Apache-2.0
#include "overlap/foreign/guard.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/status.h"

static atomic_int calls; // in progress
static _Atomic pid_t caller;
static char last[512]; // path of the library that was called last

// Runs in exit(). A process that the library forked ends as it likes.
static void end_with_failure(void) {
  if (atomic_load(&calls) == 0 || getpid() != atomic_load(&caller)) return;
  fflush(NULL);
  fprintf(
      stderr,
      "error: %s: called exit() where the program waits for an answer: a model that fails returns a number "
      "other than 0 and a message (tetlap/model.h)\n",
      last);
  _exit(status_exit_code(STATUS_SOLVER));
}

static void register_end(void) {
  atexit(end_with_failure);
}

void overlap_foreign_guard_begin(const char *path) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, register_end);
  atomic_store(&caller, getpid());
  if (atomic_fetch_add(&calls, 1) == 0) snprintf(last, sizeof last, "%s", path);
}

void overlap_foreign_guard_end(void) {
  atomic_fetch_sub(&calls, 1);
}
