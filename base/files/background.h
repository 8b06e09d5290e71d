// SPDX-License-Identifier: Apache-2.0
// Work that goes on in a thread of its own while the caller computes, as writing a file: one piece at a time.
// OpenMP's regions within it have one thread, signals go to other threads. Where the program computes on one
// thread, or no further one can be had, the work is done at once.
#ifndef TETLAP_BASE_FILES_BACKGROUND_H
#define TETLAP_BASE_FILES_BACKGROUND_H

#include <pthread.h>
#include <stdbool.h>

#include "base/status.h"

typedef Status BackgroundWork(void *self);

// A zeroed one does nothing. Used by one thread.
typedef struct Background {
  pthread_t thread;
  bool is_running;
  BackgroundWork *work;
  void *self;
  Status status;      // of the work, once it has ended
  char message[2048]; // likewise
} Background;

// Whether the program has threads to spare for it.
bool background_is_apart(void);

// Waits for the work before it, whose failure is given and leaves this undone; then begins. `self` is
// borrowed until background_wait.
Status background_begin(Background *background, BackgroundWork *work, void *self);

// Waits for the work; its Status and message, once.
Status background_wait(Background *background);

#endif
