// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/precision/summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/report.h"
#include "base/memory.h"

static const AppBenchColumn columns[] = {
    {"overlap", APP_BENCH_TEXT, offsetof(LabPrecisionSummary, overlap), "overlap", "overlap model"},
    {"base", APP_BENCH_TEXT, offsetof(LabPrecisionSummary, base), "over", "what it is held against"},
    {"pairs", APP_BENCH_INTEGER, offsetof(LabPrecisionSummary, pairs), "runs",
     "scenes × levels × tolerances where both finished"},
    {"unfinished", APP_BENCH_INTEGER, offsetof(LabPrecisionSummary, unfinished), "unfinished",
     "runs of the model that failed or were cut short"},
    {"steps_ratio", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, steps), "steps",
     "accepted steps over those of the base, geometric mean"},
    {"steps_ratio_min", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, steps_min), "least", "smallest"},
    {"steps_ratio_max", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, steps_max), "most", "largest"},
    {"steps_ratio_deviation", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, steps_deviation), "± ln",
     "standard deviation of its logarithm"},
    {"newton_ratio", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, newton), "Newton",
     "Newton iterations over those of the base, geometric mean"},
    {"newton_ratio_min", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, newton_min), NULL, "smallest"},
    {"newton_ratio_max", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, newton_max), NULL, "largest"},
    {"setups_ratio", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, setups), NULL,
     "matrices over those of the base, geometric mean"},
    {"rejected", APP_BENCH_COUNT, offsetof(LabPrecisionSummary, rejected), "rejected", "steps, sum"},
    {"rejected_base", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, rejected_base), "of base",
     "steps of the base, sum"},
    {"rejected_share", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, rejected_share), NULL,
     "rejected over accepted steps"},
    {"rejected_share_base", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, rejected_share_base), NULL,
     "of the base"},
    {"cpu_ratio", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, cpu), "cpu", "time over the base's"},
    {"wall_ratio_without_overlap", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, wall_rest), "wall, rest",
     "wall time over the base's, both without the overlap models' own"},
    {"force_error_ratio", APP_BENCH_NUMBER, offsetof(LabPrecisionSummary, force_error), "force error",
     "error of the forces over the base's, geometric mean"},
};
static const AppBenchReport report = {"precision_summary", columns, sizeof columns / sizeof *columns,
                                      sizeof(LabPrecisionSummary), false};

static const LabPrecisionRun *find(const char *base, const LabPrecisionRun *like, const LabPrecisionRun *runs,
                                   int count) {
  for (int r = 0; r < count; r++)
    if (strcmp(runs[r].overlap, base) == 0 && strcmp(runs[r].scene, like->scene) == 0 &&
        runs[r].level == like->level && runs[r].tolerance == like->tolerance)
      return &runs[r];
  return NULL;
}

// Sums of logarithms until `finish` makes means of them.
static void add(LabPrecisionSummary *sums, const LabPrecisionRun *run, const LabPrecisionRun *base,
                double *accepted, double *accepted_base) {
  double steps = run->steps / base->steps, newton = run->newton_iterations / base->newton_iterations;
  sums->pairs++;
  sums->steps += log(steps), sums->steps_deviation += log(steps) * log(steps);
  sums->steps_min = fmin(sums->steps_min, steps), sums->steps_max = fmax(sums->steps_max, steps);
  sums->newton += log(newton);
  sums->newton_min = fmin(sums->newton_min, newton), sums->newton_max = fmax(sums->newton_max, newton);
  sums->setups += log(run->setups / base->setups);
  sums->rejected += run->rejected, sums->rejected_base += base->rejected;
  *accepted += run->steps, *accepted_base += base->steps;
  sums->cpu += log(run->cpu_s / base->cpu_s);
  sums->wall_rest += log((run->wall_s - run->overlap_s) / (base->wall_s - base->overlap_s));
  sums->force_error += log(run->force_error / base->force_error);
}

LabPrecisionSummary lab_precision_summary_make(const char *overlap, const char *base,
                                               const LabPrecisionRun *runs, int count) {
  LabPrecisionSummary sums = {.overlap = overlap,
                              .base = base,
                              .steps_min = INFINITY,
                              .steps_max = -INFINITY,
                              .newton_min = INFINITY,
                              .newton_max = -INFINITY};
  double accepted = 0, accepted_base = 0;
  for (int r = 0; r < count; r++) {
    if (strcmp(runs[r].overlap, overlap) != 0) continue;
    const LabPrecisionRun *other = find(base, &runs[r], runs, count);
    sums.unfinished += !runs[r].is_finished;
    if (other && other->is_finished && runs[r].is_finished)
      add(&sums, &runs[r], other, &accepted, &accepted_base);
  }
  double n = (double)sums.pairs, mean = sums.steps / n;
  sums.steps = exp(mean);
  sums.steps_deviation = sqrt(fmax(0, sums.steps_deviation / n - mean * mean));
  sums.newton = exp(sums.newton / n), sums.setups = exp(sums.setups / n);
  sums.cpu = exp(sums.cpu / n), sums.wall_rest = exp(sums.wall_rest / n);
  sums.force_error = exp(sums.force_error / n);
  sums.rejected_share = sums.rejected / accepted,
  sums.rejected_share_base = sums.rejected_base / accepted_base;
  return sums;
}

Status lab_precision_summary_print(const AppBenchOptions *options, const char *const *overlaps,
                                   int overlap_count, const LabPrecisionRun *runs, int count) {
  LabPrecisionSummary *rows = memory_zeroed((size_t)overlap_count, sizeof *rows);
  if (!rows) return status_no_memory("the summary");
  for (int m = 0; m < overlap_count; m++)
    rows[m] = lab_precision_summary_make(overlaps[m], overlaps[0], runs, count);
  if (options->format == APP_BENCH_FORMAT_MARKDOWN || options->format == APP_BENCH_FORMAT_TABLE)
    putchar('\n');
  Status status = app_bench_report_print(&report, options, rows, overlap_count);
  memory_free(rows);
  return status;
}
