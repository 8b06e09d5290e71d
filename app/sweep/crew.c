// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/crew.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "app/sweep/child.h"
#include "app/sweep/table.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/machine/cpu.h"
#include "base/memory.h"

// How long a run may take to leave its checkpoint when the sweep is stopped.
static const double PATIENCE_S = 1.2;
static const struct timespec PAUSE = {.tv_nsec = 20 * 1000 * 1000};

enum { MAX_WORDS = 160 };

AppSweepShare app_sweep_crew_share(int jobs, int threads, int count) {
  const int cores = cpu_thread_count();
  if (!jobs) jobs = threads ? cores / threads : cores;
  if (jobs > count) jobs = count;
  if (jobs > APP_SWEEP_MAX_JOBS) jobs = APP_SWEEP_MAX_JOBS;
  if (jobs < 1) jobs = 1;
  if (!threads) threads = cores / jobs;
  return (AppSweepShare){.jobs = jobs, .threads = threads > 0 ? threads : 1};
}

// Where a key is wrong it is wrong everywhere: reported at once instead of in every line of the table.
static Status examine(AppSweepGrid *grid, const Record *before, bool again) {
  Status first = STATUS_OK;
  char message[512] = "";
  int unreadable = 0;
  for (int p = 0; p < grid->point_count; p++) {
    Status status = app_sweep_point_examine(&grid->points[p], &grid->base, before, again);
    if (status == STATUS_MEMORY) return status;
    if (status && unreadable++ == 0)
      first = status, snprintf(message, sizeof message, "%s", status_message());
  }
  return unreadable == grid->point_count ? status_fail(first, "%s", message) : STATUS_OK;
}

// The command line of a point's process: `tetlap run …` or `tetlap resume DIR`.
static void fill_words(const AppSweepGrid *grid, const AppSweepPoint *point, const char *threads,
                       const char **words) {
  const AppSweepBase *base = &grid->base;
  int n = 0;
  words[n++] = "tetlap";
  words[n++] = point->state == APP_SWEEP_RESUMABLE ? "resume" : "run";
  words[n++] = point->state == APP_SWEEP_RESUMABLE ? point->directory : base->scene_path;
  words[n++] = "--threads", words[n++] = threads;
  if (point->state == APP_SWEEP_RESUMABLE) {
    words[n] = NULL;
    return;
  }
  words[n++] = "--output", words[n++] = point->directory;
  if (base->overlap) words[n++] = "--overlap", words[n++] = base->overlap;
  for (int i = 0; i < base->override_count; i++) words[n++] = "--set", words[n++] = base->overrides[i];
  for (int a = 0; a < base->axis_count; a++) words[n++] = "--set", words[n++] = point->settings[a];
  words[n] = NULL;
}

// What an earlier run left that would be taken for this one's.
static void remove_summary(const AppSweepPoint *point) {
  char *path = file_join(point->directory, "summary.json");
  if (path) remove(path);
  memory_free(path);
}

typedef struct Slot {
  AppSweepPoint *point; // NULL: free
  bool resumes;
} Slot;

typedef struct Crew {
  AppSweepGrid *grid;
  const AppSweepOptions *options;
  Slot slots[APP_SWEEP_MAX_JOBS];
  pid_t children[APP_SWEEP_MAX_JOBS]; // 0: none
  int next;                           // the point that is looked at next
  int ended, to_do;                   // of those that were not finished at the start
  double began_s;
} Crew;

static Status start(Crew *crew, int slot, AppSweepPoint *point) {
  char threads[16];
  const char *words[MAX_WORDS];
  snprintf(threads, sizeof threads, "%d", crew->options->threads);
  fill_words(crew->grid, point, threads, words);
  TRY(file_make_directories(point->directory));
  remove_summary(point);
  char *log = file_join(point->directory, APP_SWEEP_LOG);
  if (!log) return status_no_memory("a file name");
  struct stat info;
  point->log_begin = stat(log, &info) == 0 ? (size_t)info.st_size : 0;
  Status status = app_sweep_child_start((char *const *)words, log, &crew->children[slot]);
  memory_free(log);
  if (status) return status;
  crew->slots[slot] = (Slot){point, point->state == APP_SWEEP_RESUMABLE};
  point->state = APP_SWEEP_RUNNING;
  return STATUS_OK;
}

static AppSweepPoint *next_point(Crew *crew) {
  while (crew->next < crew->grid->point_count) {
    AppSweepPoint *point = &crew->grid->points[crew->next++];
    if (point->state == APP_SWEEP_WAITING || point->state == APP_SWEEP_RESUMABLE) return point;
  }
  return NULL;
}

static Status fill_slots(Crew *crew) {
  for (int s = 0; s < crew->options->jobs; s++) {
    AppSweepPoint *point = crew->slots[s].point ? NULL : next_point(crew);
    if (point) TRY(start(crew, s, point));
  }
  return STATUS_OK;
}

static void log_outcome(const Crew *crew, const AppSweepPoint *point) {
  double left = (clock_wall_s() - crew->began_s) * (crew->to_do - crew->ended) / crew->ended;
  char what[600];
  if (point->state == APP_SWEEP_FINISHED)
    snprintf(what, sizeof what, "finished in %.3g s", record_find_number(point->summary, "wall_s"));
  else
    snprintf(what, sizeof what, "failed: %s", point->message);
  log_progress_end();
  if (crew->ended < crew->to_do)
    log_info("%d of %d: %s %s; about %.3g %s left", crew->ended, crew->to_do, point->folder, what,
             left < 120 ? left : left / 60, left < 120 ? "s" : "minutes");
  else
    log_info("%d of %d: %s %s", crew->ended, crew->to_do, point->folder, what);
}

// A checkpoint that is not of this scene is no error: the run begins anew.
static Status conclude(Crew *crew, int slot, int exit_code) {
  AppSweepPoint *point = crew->slots[slot].point;
  bool resumed = crew->slots[slot].resumes;
  crew->slots[slot] = (Slot){0};
  crew->children[slot] = 0;
  if (resumed && exit_code == status_exit_code(STATUS_INPUT)) {
    point->state = APP_SWEEP_WAITING;
    return start(crew, slot, point);
  }
  app_sweep_point_conclude(point, exit_code);
  crew->ended++;
  log_outcome(crew, point);
  return app_sweep_table_write(crew->grid);
}

static Status collect(Crew *crew) {
  int exit_code;
  for (int s = 0; s < crew->options->jobs; s++)
    if (crew->slots[s].point && app_sweep_child_has_ended(crew->children[s], &exit_code))
      TRY(conclude(crew, s, exit_code));
  return STATUS_OK;
}

static bool is_busy(const Crew *crew) {
  for (int s = 0; s < crew->options->jobs; s++)
    if (crew->slots[s].point) return true;
  return false;
}

static Status work(Crew *crew) {
  while (!*crew->options->stop) {
    TRY(fill_slots(crew));
    if (!is_busy(crew)) return STATUS_OK;
    log_progress("%d of %d runs ended, %d running", crew->ended, crew->to_do,
                 app_sweep_grid_count(crew->grid, APP_SWEEP_RUNNING));
    nanosleep(&PAUSE, NULL);
    TRY(collect(crew));
  }
  return status_fail(STATUS_INTERRUPTED,
                     "interrupted after %d of %d runs; the same command continues with the others",
                     crew->ended, crew->to_do);
}

// Those that were at work when the sweep was stopped: to be gone on with next time.
static void leave(Crew *crew) {
  app_sweep_child_stop(crew->children, crew->options->jobs, PATIENCE_S);
  for (int s = 0; s < crew->options->jobs; s++)
    if (crew->slots[s].point) crew->slots[s].point->state = APP_SWEEP_RESUMABLE;
}

// Points whose scene cannot be read: failed, though no run has left a summary.
static int count_unreadable(const AppSweepGrid *grid) {
  int count = 0;
  for (int p = 0; p < grid->point_count; p++)
    count += grid->points[p].state == APP_SWEEP_FAILED && !grid->points[p].summary;
  return count;
}

static Status run_all(AppSweepGrid *grid, const AppSweepOptions *options) {
  Crew crew = {.grid = grid, .options = options, .began_s = clock_wall_s()};
  int resumed = app_sweep_grid_count(grid, APP_SWEEP_RESUMABLE),
      new = app_sweep_grid_count(grid, APP_SWEEP_WAITING), unreadable = count_unreadable(grid);
  crew.to_do = resumed + new;
  log_info("%d runs in %s: %d finished, %d to continue, %d new; %d at once with %d %s each",
           grid->point_count, grid->base.directory, grid->point_count - crew.to_do - unreadable, resumed, new,
           options->jobs, options->threads, options->threads == 1 ? "thread" : "threads");
  if (unreadable) log_warning("%d of them cannot be run: the table says what is wrong", unreadable);
  Status status = work(&crew);
  log_progress_end();
  if (!status) return STATUS_OK;
  char message[512];
  snprintf(message, sizeof message, "%s", status_message());
  leave(&crew);
  return status_fail(status, "%s", message);
}

Status app_sweep_crew_run(AppSweepGrid *grid, const AppSweepOptions *options) {
  Record *before = NULL;
  char *path = file_join(grid->base.directory, "sweep.json");
  if (!path) return status_no_memory("a file name");
  if (file_exists(path) && record_read(&before, path))
    log_warning("%s; it is written anew", status_message());
  memory_free(path);
  Status status = app_sweep_table_check(before, grid->base.directory);
  if (!status) status = examine(grid, before, options->again);
  record_destroy(before);
  if (status) return status;
  TRY(file_make_directories(grid->base.directory));
  TRY(app_sweep_table_write(grid));
  status = run_all(grid, options);
  char message[512];
  snprintf(message, sizeof message, "%s", status_message());
  Status written = app_sweep_table_write(grid);
  return status ? status_fail(status, "%s", message) : written;
}
