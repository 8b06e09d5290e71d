// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/overlap/errors.h"

#include <math.h>

#include "base/memory.h"
#include "base/sorted.h"
#include "overlap/models.h"

enum { SIZE = OVERLAP_PAIR_SIZE };

static Status evaluate(const OverlapModel *model, int count, const double *pairs, double *volume,
                       double *gradient, unsigned *flags) {
  OverlapBatch batch = {
      .pair_count = count, .pairs = pairs, .volume = volume, .gradient = gradient, .flags = flags};
  return overlap_model_eval(model, &batch);
}

Status app_bench_truth_create(AppBenchTruth *truth, int count, const double *pairs) {
  OverlapModel exact;
  *truth = (AppBenchTruth){.count = count,
                           .pairs = pairs,
                           .volume = memory_zeroed((size_t)count, sizeof(double)),
                           .gradient = memory_zeroed((size_t)count * SIZE, sizeof(double))};
  if (!truth->volume || !truth->gradient) return status_no_memory("what is true of the pairs");
  TRY(overlap_models_create(&exact, "exact"));
  Status status = evaluate(&exact, count, pairs, truth->volume, truth->gradient, NULL);
  overlap_model_destroy(&exact);
  return status;
}

void app_bench_truth_destroy(AppBenchTruth *truth) {
  memory_free(truth->volume), memory_free(truth->gradient);
  *truth = (AppBenchTruth){0};
}

static double distance(const double *a, const double *b, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

// What the model said.
typedef struct Answers {
  double *volume, *gradient, *relative; // (count), (count, 24), (count): errors, scratch
  unsigned *flags;                      // (count)
} Answers;

static void sum_up(const AppBenchTruth *truth, const Answers *told, int count, bool of_gradient,
                   AppBenchErrors *errors) {
  static const double zero[SIZE] = {0};
  double sum = 0, total = 0, fallbacks = 0;
  int inside = 0;
  for (int i = 0; i < count; i++) {
    const double *gradient = truth->gradient + (size_t)i * SIZE;
    double size = of_gradient ? distance(gradient, zero, SIZE) : truth->volume[i];
    double error = of_gradient ? distance(told->gradient + (size_t)i * SIZE, gradient, SIZE)
                               : fabs(told->volume[i] - truth->volume[i]);
    sum += error, total += size;
    fallbacks += (told->flags[i] & OVERLAP_FALLBACK) != 0;
    if (size > 0) told->relative[inside++] = error / size;
  }
  *errors = (AppBenchErrors){NAN, NAN, NAN, fallbacks / count, count};
  if (!(total > 0)) return;
  sorted_values(told->relative, (size_t)inside);
  errors->error = sum / total;
  errors->median = told->relative[inside / 2];
  errors->p90 = told->relative[(int)(0.9 * (inside - 1))];
}

Status app_bench_errors_measure(const AppBenchTruth *truth, const OverlapModel *model, int count,
                                bool of_gradient, AppBenchErrors *errors) {
  Answers told = {.volume = memory_zeroed((size_t)count, sizeof(double)),
                  .gradient = of_gradient ? memory_zeroed((size_t)count * SIZE, sizeof(double)) : NULL,
                  .relative = memory_zeroed((size_t)count, sizeof(double)),
                  .flags = memory_zeroed((size_t)count, sizeof *told.flags)};
  bool fits = told.volume && (told.gradient || !of_gradient) && told.relative && told.flags;
  Status status = fits ? evaluate(model, count, truth->pairs, told.volume, told.gradient, told.flags)
                       : status_no_memory("the errors");
  if (!status) sum_up(truth, &told, count, of_gradient, errors);
  memory_free(told.volume), memory_free(told.gradient), memory_free(told.relative), memory_free(told.flags);
  return status;
}
