// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/beacon.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/machine/clock.h"
#include "base/memory.h"

static const double PERIOD_S = 1;

AppBeacon app_beacon_begin(const AppJob *job) {
  return (AppBeacon){.job = job, .began_s = clock_wall_s()};
}

static void record_trouble(const FemRunProgress *progress, Record *record) {
  RecordList *list = record_list(record, "trouble");
  char text[512];
  for (int k = 0; k < FEM_TROUBLE_KIND_COUNT; k++) {
    if (progress->trouble->of[k].events == 0) continue;
    fem_trouble_describe(progress->trouble, progress->system->model, (FemTroubleKind)k, text, sizeof text);
    record_append_text(list, text);
  }
}

// What is left at the pace of this process so far [s]; NaN: nothing is known.
static double left_s(const AppBeacon *beacon, const FemRunProgress *progress) {
  double done = progress->time - beacon->began_time, left = progress->end - progress->time;
  return done > 0 ? (clock_wall_s() - beacon->began_s) * left / done : NAN;
}

static Status write_progress(const AppBeacon *beacon, const FemRunProgress *progress) {
  Record *record = record_new();
  char *path = file_join(beacon->job->directory, APP_BEACON_FILE);
  Status status = record && path ? STATUS_OK : status_no_memory("the progress");
  if (!status) {
    record_integer(record, "pid", getpid());
    record_number(record, "time", progress->time);
    record_number(record, "end", progress->end);
    record_integer(record, "steps", progress->step_count);
    record_number(record, "step_s", progress->step);
    record_integer(record, "pairs", progress->measures->active_pairs);
    record_number(record, "wall_s", clock_wall_s() - beacon->began_s);
    record_number(record, "left_s", left_s(beacon, progress));
    record_trouble(progress, record);
    status = record_write(record, path);
  }
  record_destroy(record);
  memory_free(path);
  return status;
}

Status app_beacon_show(AppBeacon *beacon, const FemRunProgress *progress) {
  double now = clock_wall_s();
  if (!beacon->is_lit) {
    beacon->is_lit = true;
    beacon->began_time = progress->time;
    beacon->told_s = now;
    TRY(app_job_write_manifest(beacon->job));
    return write_progress(beacon, progress);
  }
  if (now - beacon->told_s < PERIOD_S) return STATUS_OK;
  beacon->told_s = now;
  return write_progress(beacon, progress);
}

void app_beacon_end(AppBeacon *beacon) {
  char *path = beacon->is_lit ? file_join(beacon->job->directory, APP_BEACON_FILE) : NULL;
  if (path) file_remove(path);
  memory_free(path);
  beacon->is_lit = false;
}
