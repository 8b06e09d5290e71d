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

#include "app/cli/beacon.h"
#include "app/report/page.h"
#include "app/report/report.h"
#include "base/file.h"
#include "base/memory.h"
#include "fem/output/pvd.h"

static const char *const names[] = {"summary.json", "manifest.json", "history.csv", "frames.pvd",
                                    APP_BEACON_FILE};
enum { NAME_COUNT = sizeof names / sizeof *names };

// Where it is there at all: whether the file lies in the folder after all links have been followed.
static Status check_file(const char *root, const char *directory, const char *name) {
  char real[PATH_MAX], *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  bool is_there = realpath(path, real) != NULL;
  size_t length = strlen(root);
  bool is_inside = is_there && strncmp(real, root, length) == 0 && real[length] == '/';
  memory_free(path);
  if (!is_there || is_inside) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: leads out of %s, so it is not shown", name, directory);
}

static Status check_list(const char *root, const char *directory) {
  char *path = file_join(directory, "frames.pvd");
  FemPvdList list = {0};
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? fem_pvd_read(path, &list) : STATUS_OK;
  memory_free(path);
  TRY(status);
  for (int k = 0; !status && k < list.count * list.part_count; k++)
    status = check_file(root, directory, list.files[k]);
  fem_pvd_destroy(&list);
  return status;
}

Status app_view_folder_check(const AppViewFolder *folder) {
  char root[PATH_MAX];
  if (!realpath(folder->directory, root)) return STATUS_OK; // nothing is there to be read
  for (int k = 0; k < NAME_COUNT; k++) TRY(check_file(root, folder->directory, names[k]));
  return check_list(root, folder->directory);
}

// Sizes and times of the files that the page is made of.
static void print_stamp(const AppViewFolder *folder, char *stamp, size_t size) {
  size_t used = 0;
  stamp[0] = 0;
  for (int k = 0; k < NAME_COUNT; k++) {
    struct stat info;
    char *path = file_join(folder->directory, names[k]);
    bool is_there = path && strcmp(names[k], APP_BEACON_FILE) != 0 && stat(path, &info) == 0;
    memory_free(path);
    if (!is_there) continue;
    int printed = snprintf(stamp + used, size - used, "%d:%lld:%lld.%09ld ", k, (long long)info.st_size,
                           (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec);
    if (printed > 0 && used + (size_t)printed < size) used += (size_t)printed;
  }
}

static bool is_alive(const Record *progress) {
  double pid = record_find_number(progress, "pid");
  return pid > 0 && (kill((pid_t)pid, 0) == 0 || errno == EPERM);
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
