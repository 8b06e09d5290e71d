// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/pareto/pairs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench/contestant.h"
#include "app/bench/overlap/pairs.h"
#include "base/memory.h"
#include "lab/pareto/device.h"

enum { SIZE = OVERLAP_PAIR_SIZE };
static const uint64_t SEED = 7;
static const double ERRORS_S = 2; // what the evaluation for errors may take, by a model's own guess

typedef struct Bench {
  LabPareto *pareto;
  const char *set;
  int count;                           // pairs that are made
  double *pairs;                       // (count, 24)
  double *true_volume, *true_gradient; // (count), (count, 24)
  double *volume, *gradient;           // told
  unsigned *flags;                     // (count)
  double *errors;                      // (count), scratch
  AppBenchContestant *contestants[2];  // V, V+grad: (model_count)
} Bench;

static Status evaluate(const OverlapModel *model, int count, const double *pairs, double *volume,
                       double *gradient, unsigned *flags) {
  OverlapBatch batch = {
      .pair_count = count, .pairs = pairs, .volume = volume, .gradient = gradient, .flags = flags};
  return overlap_model_eval(model, &batch);
}

static Status find_truth(Bench *bench) {
  OverlapModel exact;
  TRY(overlap_model_create(&exact, "exact"));
  Status status =
      evaluate(&exact, bench->count, bench->pairs, bench->true_volume, bench->true_gradient, NULL);
  overlap_model_destroy(&exact);
  return status;
}

static Status make(Bench *bench) {
  size_t count = (size_t)bench->count, models = (size_t)bench->pareto->model_count;
  bench->pairs = memory_zeroed(count * SIZE, sizeof(double));
  bench->true_volume = memory_zeroed(count, sizeof(double));
  bench->true_gradient = memory_zeroed(count * SIZE, sizeof(double));
  bench->volume = memory_zeroed(count, sizeof(double));
  bench->gradient = memory_zeroed(count * SIZE, sizeof(double));
  bench->errors = memory_zeroed(count, sizeof(double));
  bench->flags = memory_zeroed(count, sizeof *bench->flags);
  for (int q = 0; q < 2; q++) bench->contestants[q] = memory_zeroed(models, sizeof *bench->contestants[q]);
  if (!bench->pairs || !bench->true_volume || !bench->true_gradient || !bench->volume || !bench->gradient ||
      !bench->errors || !bench->flags || !bench->contestants[0] || !bench->contestants[1])
    return status_no_memory("the pairs");
  TRY(app_bench_pairs_fill(bench->set, bench->count, SEED, bench->pairs));
  return find_truth(bench);
}

static void destroy(Bench *bench) {
  memory_free(bench->pairs), memory_free(bench->true_volume), memory_free(bench->true_gradient);
  memory_free(bench->volume), memory_free(bench->gradient), memory_free(bench->errors);
  memory_free(bench->flags);
  for (int q = 0; q < 2; q++) memory_free(bench->contestants[q]);
}

typedef struct Turn {
  AppBenchContestant contestant;
  const LabPareto *pareto;
} Turn;

static Status take_turn(void *self, int round) {
  Turn *turn = self;
  TRY(lab_pareto_go_on(turn->pareto));
  return app_bench_contestant_take_turn(&turn->contestant, round);
}

// Every model at both quantities takes its turn in the same rounds.
static Status take_turns(Bench *bench) {
  const LabPareto *pareto = bench->pareto;
  size_t models = (size_t)pareto->model_count;
  Turn *all = memory_zeroed(2 * models, sizeof *all);
  if (!all) return status_no_memory("the contestants");
  for (size_t c = 0; c < 2 * models; c++) {
    const OverlapModel *model = &pareto->models[c % models].overlap;
    int batch = app_bench_contestant_batch(model, false, pareto->common.threads, pareto->batch);
    all[c].pareto = pareto;
    all[c].contestant =
        (AppBenchContestant){.model = model,
                             .threads = pareto->common.threads,
                             .batch = {.pair_count = batch < bench->count ? batch : bench->count,
                                       .pairs = bench->pairs,
                                       .volume = bench->volume,
                                       .gradient = c < models ? NULL : bench->gradient}};
  }
  Status status = app_bench_timer_take_turns(all, sizeof *all, 2 * pareto->model_count,
                                             pareto->common.repeats, true, take_turn);
  for (size_t c = 0; c < 2 * models; c++) bench->contestants[c / models][c % models] = all[c].contestant;
  memory_free(all);
  return status;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double distance(const double *a, const double *b, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

// Error and size of pair i: of V, or of ∇V.
static double error_of(const Bench *bench, int i, bool is_gradient, double *size) {
  static const double zero[SIZE] = {0};
  const double *truth = bench->true_gradient + (size_t)i * SIZE;
  if (is_gradient) {
    *size = distance(truth, zero, SIZE);
    return distance(bench->gradient + (size_t)i * SIZE, truth, SIZE);
  }
  *size = bench->true_volume[i];
  return fabs(bench->volume[i] - bench->true_volume[i]);
}

static void fill_errors(const Bench *bench, int count, bool is_gradient, LabParetoPoint *point) {
  double sum = 0, total = 0, fallbacks = 0;
  int inside = 0;
  for (int i = 0; i < count; i++) {
    double size, error = error_of(bench, i, is_gradient, &size);
    sum += error, total += size;
    fallbacks += (bench->flags[i] & OVERLAP_FALLBACK) != 0;
    if (size > 0) bench->errors[inside++] = error / size;
  }
  qsort(bench->errors, (size_t)inside, sizeof *bench->errors, compare);
  point->samples = count;
  point->fallbacks = fallbacks / count;
  if (!(total > 0)) return;
  point->error = sum / total;
  point->error_median = bench->errors[inside / 2];
  point->error_p90 = bench->errors[(int)(0.9 * (inside - 1))];
}

static void fill_times(const AppBenchTimer *timer, int rounds, LabParetoPoint *point) {
  AppBenchTime time = app_bench_timer_time(timer, rounds);
  point->seconds = time.wall, point->seconds_min = time.wall_min, point->seconds_max = time.wall_max;
  point->cpu_seconds = time.cpu;
}

static Status add_points(Bench *bench, int m) {
  static const char *const quantities[2] = {"V", "V+grad"};
  LabPareto *pareto = bench->pareto;
  const OverlapModel *model = &pareto->models[m].overlap;
  double affordable = ERRORS_S / model->ops->seconds_per_pair;
  int count = affordable < bench->count ? (int)fmax(10, affordable) : bench->count;
  TRY(evaluate(model, count, bench->pairs, bench->volume, bench->gradient, bench->flags));
  for (int q = 0; q < 2; q++) {
    LabParetoPoint *point = lab_pareto_add_point(pareto, m, quantities[q], bench->set);
    if (!point) return status_no_memory("a point");
    fill_errors(bench, count, q == 1, point);
    fill_times(&bench->contestants[q][m].timer, pareto->common.repeats, point);
  }
  return STATUS_OK;
}

// A model's points on the device, in the place of its own.
static Status add_device_points(Bench *bench, const Device *device, int m) {
  static const char *const quantities[2] = {"V", "V+grad"};
  LabPareto *pareto = bench->pareto;
  AppBenchTimer timers[2] = {0};
  const OverlapBatch batch = {.pair_count = bench->count,
                              .pairs = bench->pairs,
                              .volume = bench->volume,
                              .gradient = bench->gradient,
                              .flags = bench->flags};
  TRY(lab_pareto_device_measure(device, pareto->models[m].name, &batch, pareto->common.repeats, timers));
  snprintf(pareto->device_names[m], sizeof pareto->device_names[m], "%s@%.12s", pareto->models[m].name,
           device->ops->name);
  for (int q = 0; q < 2; q++) {
    LabParetoPoint *point = lab_pareto_add_point(pareto, m, quantities[q], bench->set);
    if (!point) return status_no_memory("a point");
    point->model = pareto->device_names[m];
    point->device = device->ops->name;
    fill_errors(bench, bench->count, q == 1, point);
    fill_times(&timers[q], pareto->common.repeats, point);
  }
  return STATUS_OK;
}

static Status measure_on_device(Bench *bench) {
  const LabPareto *pareto = bench->pareto;
  Device device = {0};
  if (!pareto->device) return STATUS_OK;
  TRY(device_open(&device, pareto->device));
  Status status = STATUS_OK;
  for (int m = 0; m < pareto->model_count && !status; m++)
    if (strcmp(pareto->models[m].name, pareto->models[m].source) == 0 &&
        lab_pareto_device_knows(pareto->models[m].name))
      status = add_device_points(bench, &device, m);
  device_close(&device);
  return status;
}

enum { PUBLISHED = 73370 }; // parameters of the paper's network

// The named model, else that of its family with the published size: −1 if there is none.
static int find_model(const LabPareto *pareto, const char *name) {
  for (int m = 0; m < pareto->model_count; m++)
    if (strcmp(pareto->models[m].name, name) == 0) return m;
  for (int m = 0; m < pareto->model_count; m++)
    if (strcmp(pareto->models[m].card.family, name) == 0 && pareto->models[m].card.parameters == PUBLISHED)
      return m;
  return -1;
}

static double error_at(const Bench *bench, int m, const char *quantity) {
  const LabPareto *pareto = bench->pareto;
  for (size_t p = 0; p < pareto->point_count; p++) {
    const LabParetoPoint *point = &pareto->points[p];
    if (strcmp(point->model, pareto->models[m].name) == 0 && strcmp(point->set, bench->set) == 0 &&
        strcmp(point->quantity, quantity) == 0)
      return point->error;
  }
  return NAN;
}

static void add_comparison(Bench *bench, const char *name, const char *slow, const char *fast, int quantity,
                           double paper_ratio) {
  LabPareto *pareto = bench->pareto;
  int s = find_model(pareto, slow), f = find_model(pareto, fast), rounds = pareto->common.repeats;
  if (s < 0 || f < 0 || pareto->comparison_count == LAB_PARETO_MAX_COMPARISONS) return;
  const char *what = quantity == 0 ? "V" : "V+grad";
  const AppBenchTimer *slow_timer = &bench->contestants[quantity][s].timer,
                      *fast_timer = &bench->contestants[quantity][f].timer;
  // as the frontier: processor time of one thread, wall time of several
  bool is_single = pareto->common.threads == 1;
  AppBenchTime slow_time = app_bench_timer_time(slow_timer, rounds),
               fast_time = app_bench_timer_time(fast_timer, rounds);
  AppBenchRatio ratio = is_single ? app_bench_timer_cpu_ratio(fast_timer, slow_timer, rounds)
                                  : app_bench_timer_ratio(fast_timer, slow_timer, rounds);
  pareto->comparisons[pareto->comparison_count++] =
      (LabParetoComparison){.name = name,
                            .set = bench->set,
                            .quantity = what,
                            .slow = pareto->models[s].name,
                            .fast = pareto->models[f].name,
                            .slow_rate = 1 / (is_single ? slow_time.cpu : slow_time.wall),
                            .fast_rate = 1 / (is_single ? fast_time.cpu : fast_time.wall),
                            .ratio = ratio.median,
                            .ratio_min = ratio.min,
                            .ratio_max = ratio.max,
                            .slow_error = error_at(bench, s, what),
                            .fast_error = error_at(bench, f, what),
                            .paper_ratio = paper_ratio};
}

// The paper measured 35 pairs a second for CGAL with volume and 271,313 for its network in batches of
// 2048, on one Core i5-1035G1.
static void add_comparisons(Bench *bench) {
  if (strcmp(bench->set, "uniform") == 0) {
    add_comparison(bench, "the paper's: its CGAL route against its network", "cgal", "tpn", 0, 271313.0 / 35);
    add_comparison(bench, "the honest one: a good clip against its network", "clip", "tpn", 0, NAN);
    return;
  }
  add_comparison(bench, "forces, honest: a good clip against its network", "clip", "tpn", 1, NAN);
  add_comparison(bench, "forces, honest: a good clip against geo", "clip", "geo", 1, NAN);
  add_comparison(bench, "forces, as the paper would: its CGAL route against geo", "cgal", "geo", 1, NAN);
}

static Status measure(Bench *bench) {
  TRY(make(bench));
  TRY(take_turns(bench));
  for (int m = 0; m < bench->pareto->model_count; m++) {
    TRY(lab_pareto_go_on(bench->pareto));
    TRY(add_points(bench, m));
  }
  TRY(measure_on_device(bench));
  add_comparisons(bench);
  return STATUS_OK;
}

Status lab_pareto_pairs_measure(LabPareto *pareto, const char *set) {
  Bench bench = {.pareto = pareto,
                 .set = set,
                 .count = pareto->error_pairs > pareto->batch ? pareto->error_pairs : pareto->batch};
  Status status = measure(&bench);
  destroy(&bench);
  return status;
}
