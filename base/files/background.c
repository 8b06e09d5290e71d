// SPDX-License-Identifier: Apache-2.0
#include "base/files/background.h"

#include <omp.h>
#include <signal.h>
#include <stdio.h>

bool background_is_apart(void) {
  return omp_get_max_threads() > 1;
}

static void *run(void *argument) {
  Background *background = argument;
  omp_set_num_threads(1); // of this thread's regions
  background->status = background->work(background->self);
  if (background->status) snprintf(background->message, sizeof background->message, "%s", status_message());
  return NULL;
}

// A thread inherits which signals are blocked: all are.
static bool start(Background *background) {
  sigset_t all, before;
  sigfillset(&all);
  if (pthread_sigmask(SIG_SETMASK, &all, &before) != 0) return false;
  bool is_started = pthread_create(&background->thread, NULL, run, background) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return is_started;
}

Status background_begin(Background *background, BackgroundWork *work, void *self) {
  TRY(background_wait(background));
  background->work = work, background->self = self;
  if (background_is_apart()) background->is_running = start(background);
  return background->is_running ? STATUS_OK : work(self);
}

Status background_wait(Background *background) {
  if (!background->is_running) return STATUS_OK;
  pthread_join(background->thread, NULL);
  background->is_running = false;
  return background->status ? status_fail(background->status, "%s", background->message) : STATUS_OK;
}
