// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pareto/pareto.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/bench/peak.h"
#include "app/cli/versions.h"
#include "app/evaluation/model.h"
#include "base/cpu.h"
#include "base/files/file.h"
#include "base/memory.h"

static const AppBenchColumn columns[] = {
    {"model", APP_BENCH_TEXT, offsetof(AppParetoPoint, model), "model",
     "overlap model, or name of the weights"},
    {"family", APP_BENCH_TEXT, offsetof(AppParetoPoint, family), NULL, "geo, tpn, or the model's own name"},
    {"quantity", APP_BENCH_TEXT, offsetof(AppParetoPoint, quantity), "quantity",
     "what the error is of, and what was timed: V, V+grad (∇V), force (of a whole scene)"},
    {"set", APP_BENCH_TEXT, offsetof(AppParetoPoint, set), "set", "set of pairs, or scene file"},
    {"features", APP_BENCH_INTEGER, offsetof(AppParetoPoint, features), NULL,
     "inputs of the network, 0: none"},
    {"width", APP_BENCH_INTEGER, offsetof(AppParetoPoint, width), NULL, "of a hidden layer"},
    {"depth", APP_BENCH_INTEGER, offsetof(AppParetoPoint, depth), NULL, "hidden layers (tpn: a block)"},
    {"parameters", APP_BENCH_INTEGER, offsetof(AppParetoPoint, parameters), "parameters", "of the network"},
    {"seconds_per_pair", APP_BENCH_NUMBER, offsetof(AppParetoPoint, seconds), "s a pair",
     "kernel: wall time of the overlap model, median of the rounds [s]"},
    {"seconds_per_pair_min", APP_BENCH_NUMBER, offsetof(AppParetoPoint, seconds_min), NULL,
     "fastest round [s]"},
    {"seconds_per_pair_max", APP_BENCH_NUMBER, offsetof(AppParetoPoint, seconds_max), NULL,
     "slowest round [s]"},
    {"cpu_seconds_per_pair", APP_BENCH_NUMBER, offsetof(AppParetoPoint, cpu_seconds), "cpu s",
     "processor time of all threads, median of the rounds [s]; not of scenes"},
    {"error", APP_BENCH_NUMBER, offsetof(AppParetoPoint, error), "error",
     "V: Σ|ΔV|/ΣV; V+grad: Σ‖Δ∇V‖/Σ‖∇V‖; force: ‖Δf‖/‖f‖ of the vertices' contact forces, mean over "
     "configurations; all against the exact model"},
    {"error_median", APP_BENCH_NUMBER, offsetof(AppParetoPoint, error_median), NULL,
     "of the single pairs' or configurations' relative errors"},
    {"error_p90", APP_BENCH_NUMBER, offsetof(AppParetoPoint, error_p90), NULL, "90th percentile of the same"},
    {"samples", APP_BENCH_INTEGER, offsetof(AppParetoPoint, samples), NULL,
     "pairs or configurations measured"},
    {"fallback_share", APP_BENCH_NUMBER, offsetof(AppParetoPoint, fallbacks), NULL,
     "of pairs that a more careful model answered"},
    {"frontier", APP_BENCH_INTEGER, offsetof(AppParetoPoint, frontier), "frontier",
     "1: no other is as fast and as accurate; by processor time with one thread, by wall time else"},
    {"device", APP_BENCH_TEXT, offsetof(AppParetoPoint, device), "device",
     "host, opencl or cuda; none: this processor's own way"},
    {"outcome", APP_BENCH_TEXT, offsetof(AppParetoPoint, outcome), "run", "finished, failed or cut short"},
    {"seconds_per_step", APP_BENCH_NUMBER, offsetof(AppParetoPoint, step_s), "s a step",
     "end to end: wall time of the model's own run over its steps [s]"},
    {"overlap_share", APP_BENCH_NUMBER, offsetof(AppParetoPoint, share), "overlap share",
     "of the overlap model in that run's wall time"},
    {"amdahl_limit", APP_BENCH_NUMBER, offsetof(AppParetoPoint, limit), "limit",
     "how many times faster the run would be if the overlap took no time"},
    {"trajectory_error", APP_BENCH_NUMBER, offsetof(AppParetoPoint, trajectory_error), NULL,
     "RMS distance from the reference's run over the smallest body's diagonal"},
    {"run_force_error", APP_BENCH_NUMBER, offsetof(AppParetoPoint, run_force_error), NULL,
     "‖Δf‖₂/‖f‖₂ of the forces between bodies against the reference's run, each on its own trajectory"},
    {"steps", APP_BENCH_INTEGER, offsetof(AppParetoPoint, steps), NULL, "accepted steps of that run"},
    {"rejected", APP_BENCH_INTEGER, offsetof(AppParetoPoint, rejected), NULL, "steps tried again in it"},
};
const AppBenchReport app_pareto_report = {"pareto", columns, sizeof columns / sizeof *columns,
                                          sizeof(AppParetoPoint), false};

static const AppBenchColumn comparison_columns[] = {
    {"name", APP_BENCH_TEXT, offsetof(AppParetoComparison, name), "comparison", "what is compared"},
    {"quantity", APP_BENCH_TEXT, offsetof(AppParetoComparison, quantity), "quantity", "V or V+grad"},
    {"set", APP_BENCH_TEXT, offsetof(AppParetoComparison, set), "set", "set of pairs"},
    {"slow", APP_BENCH_TEXT, offsetof(AppParetoComparison, slow), "of", "the peer"},
    {"slow_pairs_per_second", APP_BENCH_NUMBER, offsetof(AppParetoComparison, slow_rate), "pairs/s",
     "its speed"},
    {"slow_error", APP_BENCH_NUMBER, offsetof(AppParetoComparison, slow_error), "error", "its error"},
    {"fast", APP_BENCH_TEXT, offsetof(AppParetoComparison, fast), "is", "the learned model"},
    {"fast_pairs_per_second", APP_BENCH_NUMBER, offsetof(AppParetoComparison, fast_rate), "pairs/s",
     "its speed"},
    {"fast_error", APP_BENCH_NUMBER, offsetof(AppParetoComparison, fast_error), "error", "its error"},
    {"ratio", APP_BENCH_NUMBER, offsetof(AppParetoComparison, ratio), "times faster",
     "the learned model's speed over its peer's, median of the rounds"},
    {"ratio_min", APP_BENCH_NUMBER, offsetof(AppParetoComparison, ratio_min), NULL, "smallest of the rounds"},
    {"ratio_max", APP_BENCH_NUMBER, offsetof(AppParetoComparison, ratio_max), NULL, "largest of the rounds"},
    {"paper_ratio", APP_BENCH_NUMBER, offsetof(AppParetoComparison, paper_ratio), "paper says",
     "the ratio of the paper's own figures"},
};
const AppBenchReport app_pareto_comparison_report = {"pareto_comparison", comparison_columns,
                                                     sizeof comparison_columns / sizeof *comparison_columns,
                                                     sizeof(AppParetoComparison), false};

Status app_pareto_create(AppPareto *pareto) {
  pareto->models = memory_zeroed(APP_PARETO_MAX_MODELS, sizeof *pareto->models);
  return pareto->models ? STATUS_OK : status_no_memory("the models");
}

Status app_pareto_go_on(const AppPareto *pareto) {
  if (!pareto->stop || !*pareto->stop) return STATUS_OK;
  return status_fail(STATUS_INTERRUPTED, "interrupted; nothing was written");
}

void app_pareto_destroy(AppPareto *pareto) {
  for (int m = 0; m < pareto->model_count; m++) overlap_model_destroy(&pareto->models[m].overlap);
  memory_free(pareto->models), memory_free(pareto->points);
  *pareto = (AppPareto){0};
}

// All anew, since the last one may have made another's name longer.
static Status name_models(AppPareto *pareto, int count) {
  const char *sources[APP_PARETO_MAX_MODELS];
  AppModelName *names = memory_zeroed((size_t)count, sizeof *names);
  if (!names) return status_no_memory("the models");
  for (int m = 0; m < count; m++) sources[m] = pareto->models[m].source;
  Status status = app_model_names_find(count, sources, names);
  for (int m = 0; m < count && !status; m++) memcpy(pareto->models[m].name, names[m], sizeof *names);
  memory_free(names);
  return status;
}

Status app_pareto_add_model(AppPareto *pareto, const char *source) {
  if (pareto->model_count == APP_PARETO_MAX_MODELS)
    return status_fail(STATUS_USAGE, "at most %d models", APP_PARETO_MAX_MODELS);
  AppParetoModel *model = &pareto->models[pareto->model_count];
  if (snprintf(model->source, sizeof model->source, "%s", source) >= (int)sizeof model->source)
    return status_fail(STATUS_USAGE, "the path of the weights %s is too long", source);
  TRY(name_models(pareto, pareto->model_count + 1));
  TRY(app_evaluation_model_open(&model->overlap, source));
  pareto->model_count++;
  return app_evaluation_card_read(&model->overlap, source, &model->card);
}

AppParetoPoint *app_pareto_add_point(AppPareto *pareto, int model, const char *quantity, const char *set) {
  if (!memory_reserve((void **)&pareto->points, &pareto->point_capacity, pareto->point_count + 1,
                      sizeof *pareto->points))
    return NULL;
  const AppModelCard *card = &pareto->models[model].card;
  AppParetoPoint *point = &pareto->points[pareto->point_count++];
  *point = (AppParetoPoint){.model = pareto->models[model].name,
                            .family = card->family,
                            .quantity = quantity,
                            .set = set,
                            .features = card->features,
                            .width = card->width,
                            .depth = card->depth,
                            .parameters = card->parameters,
                            .seconds = NAN,
                            .seconds_min = NAN,
                            .seconds_max = NAN,
                            .cost = NAN,
                            .cpu_seconds = NAN,
                            .error = NAN,
                            .error_median = NAN,
                            .error_p90 = NAN,
                            .fallbacks = NAN,
                            .step_s = NAN,
                            .share = NAN,
                            .limit = NAN,
                            .trajectory_error = NAN,
                            .run_force_error = NAN};
  return point;
}

static bool is_peer(const AppParetoPoint *a, const AppParetoPoint *b) {
  return strcmp(a->quantity, b->quantity) == 0 && strcmp(a->set, b->set) == 0 && !a->device == !b->device;
}

bool app_pareto_beats(const AppParetoPoint *a, const AppParetoPoint *b) {
  return a->cost <= b->cost && a->error <= b->error && (a->cost < b->cost || a->error < b->error);
}

void app_pareto_finish(AppPareto *pareto) {
  for (size_t p = 0; p < pareto->point_count; p++) {
    AppParetoPoint *point = &pareto->points[p];
    bool has_cpu = pareto->common.threads == 1 && isfinite(point->cpu_seconds) && !point->device;
    point->cost = has_cpu ? point->cpu_seconds : point->seconds;
  }
  for (size_t p = 0; p < pareto->point_count; p++) {
    AppParetoPoint *point = &pareto->points[p];
    point->is_frontier = isfinite(point->cost) && isfinite(point->error);
    for (size_t q = 0; q < pareto->point_count && point->is_frontier; q++)
      if (is_peer(&pareto->points[q], point) && app_pareto_beats(&pareto->points[q], point))
        point->is_frontier = false;
    point->frontier = point->is_frontier;
  }
}

static void record_machine(const AppPareto *pareto, Record *record) {
  record_text(record, "format", "tetlap-pareto 1");
  record_text(record, "command", app_versions_command());
  app_versions_record(record_child(record, "versions"));
  record_text(record, "processor", cpu_name());
  record_text(record, "simd", app_versions_simd());
  record_number(record, "peak_double_flops", app_bench_peak_measure(false));
  record_number(record, "peak_float_flops", app_bench_peak_measure(true));
  record_integer(record, "threads", pareto->common.threads);
  record_integer(record, "repeats", pareto->common.repeats);
  record_integer(record, "batch", pareto->batch);
  record_text(record, "reference", "exact");
}

static void record_models(const AppPareto *pareto, RecordList *list) {
  for (int m = 0; m < pareto->model_count; m++) {
    char path[PATH_MAX];
    Record *record = record_append(list);
    record_text(record, "model", pareto->models[m].name);
    record_text(record, "weights", app_model_names_locate(pareto->models[m].source, path) ? path : NULL);
  }
}

static Status write_json(const AppPareto *pareto, const char *path) {
  Record *record = record_new();
  if (!record) return status_no_memory("the frontier");
  record_machine(pareto, record);
  record_models(pareto, record_list(record, "models"));
  RecordList *points = record_list(record, "points");
  for (size_t p = 0; p < pareto->point_count; p++)
    app_bench_report_record(&app_pareto_report, &pareto->points[p], record_append(points));
  RecordList *comparisons = record_list(record, "comparisons");
  for (int c = 0; c < pareto->comparison_count; c++)
    app_bench_report_record(&app_pareto_comparison_report, &pareto->comparisons[c],
                            record_append(comparisons));
  Status status = record_write(record, path);
  record_destroy(record);
  return status;
}

static Status write_csv(const AppPareto *pareto, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  app_bench_report_write_csv(&app_pareto_report, &pareto->common, pareto->points, (int)pareto->point_count,
                             writer.stream);
  return file_commit(&writer);
}

Status app_pareto_write(const AppPareto *pareto, const char *directory) {
  TRY(file_make_directories(directory));
  char *json = file_join(directory, "pareto.json"), *csv = file_join(directory, "pareto.csv");
  Status status = json && csv ? write_json(pareto, json) : status_no_memory("the frontier");
  if (!status) status = write_csv(pareto, csv);
  memory_free(json), memory_free(csv);
  return status;
}
