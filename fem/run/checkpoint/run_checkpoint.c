// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/checkpoint/run_checkpoint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/files/file.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "fem/run/checkpoint/restart.h"

static Status write_file(const FemRunState *run, const FemCheckpoint *checkpoint, const char *name) {
  char *path = file_join(run->options->directory, name);
  if (!path) return status_no_memory("a file name");
  Status status = fem_checkpoint_write(checkpoint, path);
  memory_free(path);
  return status;
}

static Status write_checkpoint(FemRunState *run) {
  Status status = write_file(run, &run->checkpoint, FEM_CHECKPOINT_FILE);
  run->is_written = status == STATUS_OK;
  run->written_s = clock_wall_s();
  return status;
}

Status fem_run_checkpoint_offer(FemRunState *run) {
  const FemSceneDef *scene = run->model->scene;
  bool is_wanted = run->options->directory && scene->checkpoint_frames != 0 && !run->is_written;
  bool is_time = clock_wall_s() - run->written_s >= scene->checkpoint_seconds;
  return is_wanted && is_time ? write_checkpoint(run) : STATUS_OK;
}

static Status remove_file(const FemRunState *run, const char *name) {
  char *path = file_join(run->options->directory, name);
  if (!path) return status_no_memory("a file name");
  file_remove(path);
  memory_free(path);
  return STATUS_OK;
}

Status fem_run_checkpoint_remove(const FemRunState *run) {
  if (!run->options->directory) return STATUS_OK;
  TRY(remove_file(run, FEM_CHECKPOINT_FILE));
  return remove_file(run, FEM_CHECKPOINT_END);
}

long long fem_run_checkpoint_steps(int unknown_count) {
  static const double WORK = 1e6; // steps times unknowns: some seconds to a minute
  enum { LEAST = 200 };           // a new beginning costs some ten steps, which must be few beside these
  return (long long)fmax(LEAST, WORK / unknown_count);
}

// The first checkpoints come sooner, after 2, 8 and 32 % of the time, so that what is stopped early does not
// begin at the start again; none in the last half, where that is all but done. Time is asked, not frames: a
// run does not depend on how many frames are written.
static const double EARLY_SHARE = 0.02, EARLY_GROWTH = 4;
enum { EARLY_STEPS = 20 };
static bool is_early(const FemRunState *run) {
  double last = run->checkpoint.time, end = run->model->scene->end;
  return run->time >= (last > 0 ? EARLY_GROWTH * last : EARLY_SHARE * end) && 2 * run->time <= end;
}

// A checkpoint restarts the integrator at order 1, which follows an impact less well: a landing's impulse by
// a thousandth. So it waits for a step that is no shorter than the mean of all.
enum { PATIENCE = 2 };
static bool is_calm(const FemRunState *run, const FemIntegratorStats *stats) {
  return stats->current_step * (double)stats->steps >= run->time;
}

// Equilibria are few and expensive, and there is no order to lose.
enum { STATIC_STEPS = 4 };

bool fem_run_checkpoint_is_due(const FemRunState *run, const FemIntegratorStats *stats) {
  const FemSceneDef *scene = run->model->scene;
  if (fem_run_state_has_ended(run) || (!scene->is_static && run->time >= run->stage_end)) return false;
  if (scene->checkpoint_frames >= 0)
    return scene->checkpoint_frames > 0 &&
           run->next_frame >= run->checkpoint.next_frame + scene->checkpoint_frames;
  long long steps = stats->steps - run->checkpoint.so_far.integrator.steps;
  if (scene->is_static) return steps >= STATIC_STEPS;
  long long enough = fem_run_checkpoint_steps(run->model->free_count);
  bool is_wanted = steps >= enough || (steps >= EARLY_STEPS && is_early(run));
  return steps >= PATIENCE * enough || (is_wanted && is_calm(run, stats));
}

static Status keep_ledger(const FemRunState *run, FemCheckpoint *next) {
  double *ledger = NULL;
  TRY(fem_ledger_save(&run->recorder.ledger, &ledger, &next->ledger_count));
  memory_free(next->ledger);
  next->ledger = ledger;
  memory_free(next->rest);
  next->rest = NULL;
  return fem_rest_save(run->rest, &next->rest, &next->rest_count);
}

// The former checkpoint stands until the next one is whole, and all frames before it: a run that fails on the
// way leaves that one.
Status fem_run_checkpoint_take(FemRunState *run, double force_scale, double driven_work) {
  FemCheckpoint next;
  TRY(fem_recorder_wait(&run->recorder));
  fem_system_scatter(&run->system, run->time, run->u, run->v, &run->trial);
  TRY(fem_restart_collect(&next, &run->system, &run->trial, run->u, run->v, run->result));
  Status status = keep_ledger(run, &next);
  if (status) {
    fem_checkpoint_destroy(&next);
    return status;
  }
  // 0: IDA's choice. At order 1 a step as long as the last one would let what sticks creep.
  next.step = run->model->scene->is_static ? run->next_step : 0;
  next.next_frame = run->next_frame;
  next.history = run->recorder.history.file.end;
  next.audit = run->audit;
  next.force_scale = force_scale;
  next.driven_work = driven_work;
  next.origin = run->checkpoint.origin;
  run->checkpoint.origin = NULL;
  fem_checkpoint_destroy(&run->checkpoint);
  run->checkpoint = next;
  run->is_written = false;
  return fem_run_checkpoint_offer(run);
}

// The last accepted state. What a part between two checkpoints needs besides is left out.
static Status write_end(FemRunState *run) {
  FemCheckpoint end;
  if (run->model->scene->checkpoint_frames == 0 || !run->system.is_whole || run->next_frame == 0)
    return STATUS_OK;
  fem_system_scatter(&run->system, run->time, run->u, run->v, &run->trial);
  TRY(fem_restart_collect(&end, &run->system, &run->trial, run->u, run->v, run->result));
  end.origin = run->checkpoint.origin;
  Status status = write_file(run, &end, FEM_CHECKPOINT_END);
  end.origin = NULL;
  fem_checkpoint_destroy(&end);
  return status;
}

Status fem_run_checkpoint_leave(FemRunState *run, Status status) {
  bool may_go_on = status == STATUS_INTERRUPTED || status == STATUS_IO || status == STATUS_MEMORY;
  if (!run->options->directory || !run->recorder.system) return STATUS_OK;
  if (status == STATUS_OK) TRY(remove_file(run, FEM_CHECKPOINT_FILE));
  if (status == STATUS_OK || status == STATUS_SOLVER) return write_end(run);
  return may_go_on && run->model->scene->checkpoint_frames != 0 && !run->is_written ? write_checkpoint(run)
                                                                                    : STATUS_OK;
}
