// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/collect.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "app/cli/format.h"
#include "base/files/file.h"
#include "base/memory.h"

static Status add_run(AppReport *report, const char *directory, int max_frames) {
  if (report->run_count == APP_REPORT_MAX_RUNS)
    return status_fail(STATUS_USAGE, "%s: is one too many: a page shows at most %d runs", directory,
                       APP_REPORT_MAX_RUNS);
  TRY(app_report_run_read(&report->runs[report->run_count], directory, max_frames));
  report->run_count++;
  return STATUS_OK;
}

// The run of a model: its folder below that of `tetlap compare` is called like it.
static Status add_model(AppReport *report, const char *directory, const char *model, int max_frames) {
  char *path = file_join(directory, model);
  if (!path) return status_no_memory("a file name");
  Status status = add_run(report, path, max_frames);
  memory_free(path);
  return status;
}

// All runs of a comparison; models of its audit have none.
static Status add_comparison(AppReport *report, const char *directory, int max_frames) {
  const Record *rows = report->comparison;
  TRY(app_format_check(record_at(rows, 0), directory, "compare.json", NULL));
  for (int k = 0; k < record_count(rows); k++) {
    const Record *row = record_at(rows, k);
    const char *model = record_find_text(row, "model"), *reference = record_find_text(row, "reference");
    if (!model || !record_find(row, "summary")) continue;
    if (reference && strcmp(model, reference) == 0) report->reference = report->run_count;
    TRY(add_model(report, directory, model, max_frames));
  }
  if (report->run_count == 0)
    return status_fail(STATUS_INPUT, "%s/compare.json: names no run; give the directories of runs",
                       directory);
  return STATUS_OK;
}

Status app_report_collect(AppReport *report, const char *directory, bool is_alone, int max_frames) {
  struct stat info;
  if (stat(directory, &info) != 0)
    return status_fail(STATUS_IO, "%s: cannot be opened: %s; give the DIR of `tetlap run SCENE -o DIR`",
                       directory, strerror(errno));
  if (!S_ISDIR(info.st_mode))
    return status_fail(STATUS_INPUT, "%s: is not a directory; give the DIR of `tetlap run SCENE -o DIR`",
                       directory);
  char *comparison = file_join(directory, "compare.json"), *summary = file_join(directory, "summary.json");
  Status status = comparison && summary ? STATUS_OK : status_no_memory("a file name");
  bool is_comparison = !status && file_exists(comparison) && !file_exists(summary);
  if (is_comparison && !is_alone)
    status = status_fail(STATUS_USAGE, "%s: holds several runs; give their directories, or this one alone",
                         directory);
  if (is_comparison && !status) status = record_read(&report->comparison, comparison);
  if (!status)
    status = is_comparison ? add_comparison(report, directory, max_frames)
                           : add_run(report, directory, max_frames);
  memory_free(comparison);
  memory_free(summary);
  return status;
}
