// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/view/folder.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/job/beacon.h"
#include "app/report/page.h"
#include "app/report/report.h"
#include "base/files/confine.h"
#include "base/files/file.h"
#include "base/memory.h"

static const char *const names[] = {"summary.json", "manifest.json", "history.csv", "frames.pvd",
                                    APP_BEACON_FILE};
enum { NAME_COUNT = sizeof names / sizeof *names };

// A file that the page is made of is refused before it is looked at where it is no plain file; what the lists
// name, when it is read (base/files/confine.h).
static Status check_file(const char *directory, const char *name) {
  struct stat info;
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  bool is_wrong = lstat(path, &info) == 0 && !S_ISREG(info.st_mode);
  memory_free(path);
  if (!is_wrong) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: is a link or not a file, so it is not shown: it may lead out of %s",
                     name, directory);
}

Status app_view_folder_open(const AppViewFolder *folder, AppViewRefusal *refusal) {
  *refusal = APP_VIEW_MISSING;
  TRY(confine_begin(folder->directory));
  *refusal = APP_VIEW_FORBIDDEN;
  for (int k = 0; k < NAME_COUNT; k++) TRY(check_file(folder->directory, names[k]));
  *refusal = APP_VIEW_ALLOWED;
  return STATUS_OK;
}

// Sizes and times of the files that the page is made of.
static void print_stamp(const AppViewFolder *folder, char *stamp, size_t size) {
  size_t used = 0;
  stamp[0] = 0;
  for (int k = 0; k < NAME_COUNT; k++) {
    struct stat info;
    char *path = file_join(folder->directory, names[k]);
    bool is_there = path && strcmp(names[k], APP_BEACON_FILE) != 0 && lstat(path, &info) == 0;
    memory_free(path);
    if (!is_there) continue;
    int printed = snprintf(stamp + used, size - used, "%d:%lld:%lld.%09ld ", k, (long long)info.st_size,
                           (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
    if (printed > 0 && used + (size_t)printed < size) used += (size_t)printed;
  }
}

static bool is_alive(const Record *progress) {
  double pid = record_find_number(progress, "pid");
  return pid >= 1 && pid <= INT_MAX && (kill((pid_t)pid, 0) == 0 || errno == EPERM);
}

// A run that begins anew, or goes on, in the folder of an earlier one has a newer word than its summary.
static const char *outcome_of(const Record *summary, const Record *progress, const char *stamp) {
  if (progress) return is_alive(progress) ? "running" : "gone";
  const char *outcome = record_find_text(summary, "outcome");
  return outcome ? outcome : stamp[0] ? "running" : "waiting";
}

Status app_view_folder_state(const AppViewFolder *folder, Record **state) {
  Record *summary = NULL, *progress = NULL;
  char stamp[512];
  *state = record_new();
  Status status = *state ? record_read_in(&summary, folder->directory, "summary.json")
                         : status_no_memory("the run's state");
  if (!status) status = record_read_in(&progress, folder->directory, APP_BEACON_FILE);
  if (!status) {
    print_stamp(folder, stamp, sizeof stamp);
    record_merge(*state, progress);
    record_text(*state, "outcome", outcome_of(summary, progress, stamp));
    if (!progress) record_text(*state, "message", record_find_text(summary, "message"));
    record_text(*state, "stamp", stamp);
  }
  record_destroy(summary);
  record_destroy(progress);
  if (!status) return STATUS_OK;
  record_destroy(*state);
  *state = NULL;
  return status;
}

static bool is_running(const Record *state) {
  const char *outcome = record_find_text(state, "outcome");
  return outcome && strcmp(outcome, "running") == 0;
}

// What is written while it is read may not fit together: an older frame beside a newer list.
static Status read_run(const AppViewFolder *folder, AppReport *report) {
  const char *outcome = record_find_text(report->live, "outcome");
  if (outcome && strcmp(outcome, "waiting") == 0) return STATUS_OK;
  TRY(app_report_run_read(&report->runs[0], folder->directory,
                          is_running(report->live) ? folder->max_frames : 0));
  report->run_count = 1;
  return STATUS_OK;
}

Status app_view_folder_page(const AppViewFolder *folder, char **page, size_t *size) {
  AppReport report = {0};
  *page = NULL;
  FILE *stream = NULL;
  Status status = app_view_folder_state(folder, &report.live);
  if (!status) status = read_run(folder, &report);
  if (!status && !(stream = open_memstream(page, size))) status = status_no_memory("the page");
  if (!status) status = app_report_print(&report, stream);
  if (stream && fclose(stream) != 0 && !status) status = status_no_memory("the page");
  if (status) {
    free(*page);
    *page = NULL;
  }
  app_report_destroy(&report);
  return status;
}
