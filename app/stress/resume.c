// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/resume.h"

#include <errno.h>
#include <math.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/files/temporary.h"
#include "base/memory.h"
#include "fem/run/checkpoint/checkpoint.h"

// run->extra
enum { STOPPED, KILLED, STOPPED_AT, KILLED_AT, STOPPED_DIFFERENCE, KILLED_DIFFERENCE };

typedef struct Interruption {
  double time; // the first step beyond it is the last
  bool by_kill;
  volatile sig_atomic_t stop;
} Interruption;

static Status interrupt(void *self, const FemRunProgress *progress) {
  Interruption *interruption = self;
  if (progress->time < interruption->time) return STATUS_OK;
  if (interruption->by_kill) kill(getpid(), SIGKILL);
  interruption->stop = 1;
  return STATUS_OK;
}

static Status run_until(const AppStressRun *run, const char *directory, Interruption *interruption) {
  FemRunOptions options = {.directory = directory,
                           .stop = &interruption->stop,
                           .observe = interrupt,
                           .observer = interruption,
                           .keep_trajectory = true};
  FemRunResult result;
  Status status = fem_run(&run->model, &options, &result);
  fem_run_result_destroy(&result);
  return status;
}

// In a process of its own, which is killed: whether it was.
static bool run_killed(const AppStressRun *run, const char *directory, double time) {
  Interruption interruption = {.time = time, .by_kill = true};
  pid_t child = fork();
  if (child == 0) {
    omp_set_num_threads(1); // the parent's other threads did not come along
    _exit(run_until(run, directory, &interruption) ? 1 : 0);
  }
  int state = 0;
  while (child > 0 && waitpid(child, &state, 0) < 0 && errno == EINTR) continue;
  return child > 0 && WIFSIGNALED(state) && WTERMSIG(state) == SIGKILL;
}

// The largest difference between the frames of a resumed run and the last ones of the untouched [m]; NaN: it
// has none.
static double difference_of(const AppStressRun *run, const FemRunResult *resumed) {
  const FemRunResult *whole = &run->result;
  size_t count = 3 * (size_t)resumed->vertex_count * (size_t)resumed->frame_count;
  size_t all = 3 * (size_t)whole->vertex_count * (size_t)whole->frame_count;
  if (count == 0 || count > all) return NAN;
  double difference = fabs(resumed->end_time - whole->end_time);
  if (resumed->integrator.steps != whole->integrator.steps) return NAN;
  for (size_t i = 0; i < count; i++)
    difference = fmax(difference, fabs(resumed->trajectory[i] - whole->trajectory[all - count + i]));
  return difference;
}

// Goes on from the folder's checkpoint.
static Status resume(AppStressRun *run, const char *directory, double *at, double *difference) {
  char *path = file_join(directory, FEM_CHECKPOINT_FILE);
  if (!path) return status_no_memory("a file name");
  FemCheckpoint checkpoint = {0};
  FemRunResult result;
  Status status = fem_checkpoint_read(&checkpoint, path);
  memory_free(path);
  if (status) return status;
  *at = checkpoint.time / run->scene.end;
  FemRunOptions options = {.directory = directory, .keep_trajectory = true, .from = &checkpoint};
  status = fem_run(&run->model, &options, &result);
  if (!status) *difference = difference_of(run, &result);
  fem_run_result_destroy(&result);
  fem_checkpoint_destroy(&checkpoint);
  return status;
}

static Status stop_and_kill(AppStressRun *run, const char *folder) {
  char *stopped = file_join(folder, "stopped"), *killed = file_join(folder, "killed");
  Interruption half = {.time = 0.5 * run->scene.end};
  Status status = stopped && killed ? STATUS_OK : status_no_memory("a file name");
  if (!status) {
    run->extra[STOPPED] = run_until(run, stopped, &half) == STATUS_INTERRUPTED;
    run->extra[KILLED] = run_killed(run, killed, 0.7 * run->scene.end);
    status = resume(run, stopped, &run->extra[STOPPED_AT], &run->extra[STOPPED_DIFFERENCE]);
  }
  if (!status) status = resume(run, killed, &run->extra[KILLED_AT], &run->extra[KILLED_DIFFERENCE]);
  memory_free(stopped);
  memory_free(killed);
  return status;
}

Status app_stress_resume_run(AppStressRun *run) {
  char *folder;
  Status status = app_stress_run_scene(run);
  run->extra[STOPPED_DIFFERENCE] = run->extra[KILLED_DIFFERENCE] = NAN;
  if (!status && !run->is_cut && !run->status) {
    Status done = temporary_directory("stress", &folder);
    if (!done) done = stop_and_kill(run, folder);
    if (done) snprintf(run->message, sizeof run->message, "%s", status_message());
    temporary_remove(folder);
    if (done == STATUS_MEMORY) status = done;
  }
  return status;
}

void app_stress_resume_judge(const AppStressRun *run, AppStressRow *row) {
  const double *extra = run->extra;
  app_stress_ask_occurred(row, "stopped", extra[STOPPED], 1);
  app_stress_ask_occurred(row, "killed by SIGKILL", extra[KILLED], 1);
  app_stress_ask_occurred(row, "resumed at, after a stop", extra[STOPPED_AT], 0.3);
  app_stress_ask_occurred(row, "resumed at, after a kill", extra[KILLED_AT], 0.3);
  app_stress_ask_most(row, "difference after a stop [m]", extra[STOPPED_DIFFERENCE], 0);
  app_stress_ask_most(row, "difference after a kill [m]", extra[KILLED_DIFFERENCE], 0);
}
