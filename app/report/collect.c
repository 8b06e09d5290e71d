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

// The verdicts of `tetlap verdict`, without their runs.
static Status add_verdict(AppReport *report, const char *directory, const char *path, bool is_alone) {
  if (!is_alone)
    return status_fail(STATUS_USAGE, "%s: holds a verdict, which has a page of its own; give it alone",
                       directory);
  TRY(record_read(&report->verdict, path));
  TRY(app_format_check(report->verdict, directory, "verdict.json", NULL));
  if (record_count(record_find(report->verdict, "models")) > 0) return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s: judges no model yet; give its `tetlap verdict` again, which goes on",
                     path);
}

Status app_report_collect(AppReport *report, const char *directory, bool is_alone, int max_frames) {
  struct stat info;
  if (stat(directory, &info) != 0)
    return status_fail(STATUS_IO, "%s: cannot be opened: %s; give the DIR of `tetlap run SCENE -o DIR`",
                       directory, strerror(errno));
  if (!S_ISDIR(info.st_mode))
    return status_fail(STATUS_INPUT, "%s: is not a directory; give the DIR of `tetlap run SCENE -o DIR`",
                       directory);
  char *comparison = file_join(directory, "compare.json"), *summary = file_join(directory, "summary.json"),
       *verdict = file_join(directory, "verdict.json");
  Status status = comparison && summary && verdict ? STATUS_OK : status_no_memory("a file name");
  bool is_comparison = !status && file_exists(comparison) && !file_exists(summary);
  if (is_comparison && !is_alone)
    status = status_fail(STATUS_USAGE, "%s: holds several runs; give their directories, or this one alone",
                         directory);
  if (is_comparison && !status) status = record_read(&report->comparison, comparison);
  if (!status)
    status = is_comparison          ? add_comparison(report, directory, max_frames)
             : file_exists(summary) ? add_run(report, directory, max_frames)
             : file_exists(verdict) ? add_verdict(report, directory, verdict, is_alone)
                                    : add_run(report, directory, max_frames);
  memory_free(comparison);
  memory_free(summary);
  memory_free(verdict);
  return status;
}
