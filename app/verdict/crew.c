// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/verdict/crew.h"

#include <stdio.h>
#include <time.h>

#include "app/sweep/child.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"

static const double PATIENCE_S = 1;
static const struct timespec PAUSE = {.tv_nsec = 20 * 1000 * 1000};

typedef struct Crew {
  const AppVerdictPlan *plans;
  int plan_count, jobs, next, ended, total;
  const volatile sig_atomic_t *stop;
  AppVerdictTask *tasks; // (jobs)
  const char *models[APP_SWEEP_MAX_JOBS];
  pid_t children[APP_SWEEP_MAX_JOBS]; // 0: none
} Crew;

// The next task that is wanted and not done; false: there is none.
static Status find_next(Crew *crew, AppVerdictTask *task, const char **model, bool *is_found) {
  bool is_wanted;
  for (*is_found = false; !*is_found && crew->next < crew->plan_count * APP_VERDICT_TASKS; crew->next++) {
    const AppVerdictPlan *plan = &crew->plans[crew->next / APP_VERDICT_TASKS];
    TRY(app_verdict_task(plan, crew->next % APP_VERDICT_TASKS, task, &is_wanted));
    *is_found = is_wanted && !file_exists(task->output);
    *model = plan->name;
  }
  return STATUS_OK;
}

static Status count_tasks(Crew *crew) {
  const char *model;
  bool is_found = true;
  while (is_found) {
    TRY(find_next(crew, &crew->tasks[0], &model, &is_found));
    crew->total += is_found;
  }
  crew->next = 0;
  return STATUS_OK;
}

// What it has printed, or written meanwhile, is its result. With exit code 70 a case was not met, which is
// one.
static void conclude(Crew *crew, int slot, int exit_code) {
  const AppVerdictTask *task = &crew->tasks[slot];
  const bool has_ended = exit_code == 0 || exit_code == status_exit_code(STATUS_SOLVER);
  if (task->is_printed && exit_code == 0) rename(task->log, task->output);
  if (task->part[0] && has_ended) rename(task->part, task->output);
  crew->children[slot] = 0;
  crew->ended++;
  const bool is_there = file_exists(task->output);
  if (is_there) remove(task->log);
  log_info("%s: %s %s, %d of %d", crew->models[slot], task->name, is_there ? "done" : "failed", crew->ended,
           crew->total);
  if (!is_there)
    log_warning("%s: %s ended with exit code %d; %s says why", crew->models[slot], task->name, exit_code,
                task->log);
}

static Status fill(Crew *crew) {
  for (int slot = 0; slot < crew->jobs; slot++) {
    bool is_found;
    if (crew->children[slot]) continue;
    TRY(find_next(crew, &crew->tasks[slot], &crew->models[slot], &is_found));
    if (!is_found) return STATUS_OK;
    remove(crew->tasks[slot].log);
    TRY(app_sweep_child_start((char *const *)crew->tasks[slot].words, crew->tasks[slot].log,
                              &crew->children[slot]));
  }
  return STATUS_OK;
}

static bool collect(Crew *crew) {
  bool is_busy = false;
  int exit_code;
  for (int slot = 0; slot < crew->jobs; slot++) {
    if (!crew->children[slot]) continue;
    if (app_sweep_child_has_ended(crew->children[slot], &exit_code))
      conclude(crew, slot, exit_code);
    else
      is_busy = true;
  }
  return is_busy;
}

static Status run(Crew *crew) {
  TRY(count_tasks(crew));
  for (int p = 0; p < crew->plan_count; p++) {
    char folder[PATH_MAX];
    snprintf(folder, sizeof folder, "%s/%s", crew->plans[p].directory, crew->plans[p].name);
    TRY(file_make_directories(folder));
  }
  for (bool is_busy = true; is_busy || crew->ended < crew->total;) {
    if (*crew->stop) return status_fail(STATUS_INTERRUPTED, "interrupted; the same command goes on");
    TRY(fill(crew));
    nanosleep(&PAUSE, NULL);
    is_busy = collect(crew);
  }
  return STATUS_OK;
}

Status app_verdict_crew_run(const AppVerdictPlan *plans, int plan_count, int jobs,
                            const volatile sig_atomic_t *stop) {
  Crew crew = {.plans = plans, .plan_count = plan_count, .jobs = jobs, .stop = stop};
  crew.tasks = memory_zeroed((size_t)jobs, sizeof *crew.tasks);
  if (!crew.tasks) return status_no_memory("the tasks of a verdict");
  Status status = run(&crew);
  app_sweep_child_stop(crew.children, jobs, PATIENCE_S);
  memory_free(crew.tasks);
  return status;
}
