// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/pareto/pareto.h"

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
    {"model", APP_BENCH_TEXT, offsetof(LabParetoPoint, model), "model",
     "overlap model, or name of the weights"},
    {"family", APP_BENCH_TEXT, offsetof(LabParetoPoint, family), NULL, "geo, tpn, or the model's own name"},
    {"quantity", APP_BENCH_TEXT, offsetof(LabParetoPoint, quantity), "quantity",
     "what the error is of, and what was timed: V, V+grad (∇V), force (of a whole scene)"},
    {"set", APP_BENCH_TEXT, offsetof(LabParetoPoint, set), "set", "set of pairs, or scene file"},
    {"features", APP_BENCH_INTEGER, offsetof(LabParetoPoint, features), NULL,
     "inputs of the network, 0: none"},
    {"width", APP_BENCH_INTEGER, offsetof(LabParetoPoint, width), NULL, "of a hidden layer"},
    {"depth", APP_BENCH_INTEGER, offsetof(LabParetoPoint, depth), NULL, "hidden layers (tpn: a block)"},
    {"parameters", APP_BENCH_INTEGER, offsetof(LabParetoPoint, parameters), "parameters", "of the network"},
    {"seconds_per_pair", APP_BENCH_NUMBER, offsetof(LabParetoPoint, seconds), "s a pair",
     "kernel: wall time of the overlap model, median of the rounds [s]"},
    {"seconds_per_pair_min", APP_BENCH_NUMBER, offsetof(LabParetoPoint, seconds_min), NULL,
     "fastest round [s]"},
    {"seconds_per_pair_max", APP_BENCH_NUMBER, offsetof(LabParetoPoint, seconds_max), NULL,
     "slowest round [s]"},
    {"cpu_seconds_per_pair", APP_BENCH_NUMBER, offsetof(LabParetoPoint, cpu_seconds), "cpu s",
     "processor time of all threads, median of the rounds [s]; not of scenes"},
    {"error", APP_BENCH_NUMBER, offsetof(LabParetoPoint, error), "error",
     "V: Σ|ΔV|/ΣV; V+grad: Σ‖Δ∇V‖/Σ‖∇V‖; force: ‖Δf‖/‖f‖ of the vertices' contact forces, mean over "
     "configurations; all against the exact model"},
    {"error_median", APP_BENCH_NUMBER, offsetof(LabParetoPoint, error_median), NULL,
     "of the single pairs' or configurations' relative errors"},
    {"error_p90", APP_BENCH_NUMBER, offsetof(LabParetoPoint, error_p90), NULL, "90th percentile of the same"},
    {"samples", APP_BENCH_INTEGER, offsetof(LabParetoPoint, samples), NULL,
     "pairs or configurations measured"},
    {"fallback_share", APP_BENCH_NUMBER, offsetof(LabParetoPoint, fallbacks), NULL,
     "of pairs that a more careful model answered"},
    {"frontier", APP_BENCH_INTEGER, offsetof(LabParetoPoint, frontier), "frontier",
     "1: no other is as fast and as accurate; by processor time with one thread, by wall time else"},
    {"device", APP_BENCH_TEXT, offsetof(LabParetoPoint, device), "device",
     "host, opencl or cuda; none: this processor's own way"},
    {"outcome", APP_BENCH_TEXT, offsetof(LabParetoPoint, outcome), "run", "finished, failed or cut short"},
    {"seconds_per_step", APP_BENCH_NUMBER, offsetof(LabParetoPoint, step_s), "s a step",
     "end to end: wall time of the model's own run over its steps [s]"},
    {"overlap_share", APP_BENCH_NUMBER, offsetof(LabParetoPoint, share), "overlap share",
     "of the overlap model in that run's wall time"},
    {"amdahl_limit", APP_BENCH_NUMBER, offsetof(LabParetoPoint, limit), "limit",
     "how many times faster the run would be if the overlap took no time"},
    {"trajectory_error", APP_BENCH_NUMBER, offsetof(LabParetoPoint, trajectory_error), NULL,
     "RMS distance from the reference's run over the smallest body's diagonal"},
    {"run_force_error", APP_BENCH_NUMBER, offsetof(LabParetoPoint, run_force_error), NULL,
     "‖Δf‖₂/‖f‖₂ of the forces between bodies against the reference's run, each on its own trajectory"},
    {"steps", APP_BENCH_INTEGER, offsetof(LabParetoPoint, steps), NULL, "accepted steps of that run"},
    {"rejected", APP_BENCH_INTEGER, offsetof(LabParetoPoint, rejected), NULL, "steps tried again in it"},
};
const AppBenchReport lab_pareto_report = {"pareto", columns, sizeof columns / sizeof *columns,
                                          sizeof(LabParetoPoint), false};

static const AppBenchColumn comparison_columns[] = {
    {"name", APP_BENCH_TEXT, offsetof(LabParetoComparison, name), "comparison", "what is compared"},
    {"quantity", APP_BENCH_TEXT, offsetof(LabParetoComparison, quantity), "quantity", "V or V+grad"},
    {"set", APP_BENCH_TEXT, offsetof(LabParetoComparison, set), "set", "set of pairs"},
    {"slow", APP_BENCH_TEXT, offsetof(LabParetoComparison, slow), "of", "the peer"},
    {"slow_pairs_per_second", APP_BENCH_NUMBER, offsetof(LabParetoComparison, slow_rate), "pairs/s",
     "its speed"},
    {"slow_error", APP_BENCH_NUMBER, offsetof(LabParetoComparison, slow_error), "error", "its error"},
    {"fast", APP_BENCH_TEXT, offsetof(LabParetoComparison, fast), "is", "the learned model"},
    {"fast_pairs_per_second", APP_BENCH_NUMBER, offsetof(LabParetoComparison, fast_rate), "pairs/s",
     "its speed"},
    {"fast_error", APP_BENCH_NUMBER, offsetof(LabParetoComparison, fast_error), "error", "its error"},
    {"ratio", APP_BENCH_NUMBER, offsetof(LabParetoComparison, ratio), "times faster",
     "the learned model's speed over its peer's, median of the rounds"},
    {"ratio_min", APP_BENCH_NUMBER, offsetof(LabParetoComparison, ratio_min), NULL, "smallest of the rounds"},
    {"ratio_max", APP_BENCH_NUMBER, offsetof(LabParetoComparison, ratio_max), NULL, "largest of the rounds"},
    {"paper_ratio", APP_BENCH_NUMBER, offsetof(LabParetoComparison, paper_ratio), "paper says",
     "the ratio of the paper's own figures"},
};
const AppBenchReport lab_pareto_comparison_report = {"pareto_comparison", comparison_columns,
                                                     sizeof comparison_columns / sizeof *comparison_columns,
                                                     sizeof(LabParetoComparison), false};

Status lab_pareto_create(LabPareto *pareto) {
  pareto->models = memory_zeroed(LAB_PARETO_MAX_MODELS, sizeof *pareto->models);
  return pareto->models ? STATUS_OK : status_no_memory("the models");
}

Status lab_pareto_go_on(const LabPareto *pareto) {
  if (!pareto->stop || !*pareto->stop) return STATUS_OK;
  return status_fail(STATUS_INTERRUPTED, "interrupted; nothing was written");
}

void lab_pareto_destroy(LabPareto *pareto) {
  for (int m = 0; m < pareto->model_count; m++) overlap_model_destroy(&pareto->models[m].overlap);
  memory_free(pareto->models), memory_free(pareto->points);
  *pareto = (LabPareto){0};
}

// All anew, since the last one may have made another's name longer.
static Status name_models(LabPareto *pareto, int count) {
  const char *sources[LAB_PARETO_MAX_MODELS];
  AppModelName *names = memory_zeroed((size_t)count, sizeof *names);
  if (!names) return status_no_memory("the models");
  for (int m = 0; m < count; m++) sources[m] = pareto->models[m].source;
  Status status = app_model_names_find(count, sources, names);
  for (int m = 0; m < count && !status; m++) memcpy(pareto->models[m].name, names[m], sizeof *names);
  memory_free(names);
  return status;
}

Status lab_pareto_add_model(LabPareto *pareto, const char *source) {
  if (pareto->model_count == LAB_PARETO_MAX_MODELS)
    return status_fail(STATUS_USAGE, "at most %d models", LAB_PARETO_MAX_MODELS);
  LabParetoModel *model = &pareto->models[pareto->model_count];
  if (snprintf(model->source, sizeof model->source, "%s", source) >= (int)sizeof model->source)
    return status_fail(STATUS_USAGE, "the path of the weights %s is too long", source);
  TRY(name_models(pareto, pareto->model_count + 1));
  TRY(app_evaluation_model_open(&model->overlap, source));
  pareto->model_count++;
  return app_evaluation_card_read(&model->overlap, source, &model->card);
}

LabParetoPoint *lab_pareto_add_point(LabPareto *pareto, int model, const char *quantity, const char *set) {
  if (!memory_reserve((void **)&pareto->points, &pareto->point_capacity, pareto->point_count + 1,
                      sizeof *pareto->points))
    return NULL;
  const AppModelCard *card = &pareto->models[model].card;
  LabParetoPoint *point = &pareto->points[pareto->point_count++];
  *point = (LabParetoPoint){.model = pareto->models[model].name,
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

static bool is_peer(const LabParetoPoint *a, const LabParetoPoint *b) {
  return strcmp(a->quantity, b->quantity) == 0 && strcmp(a->set, b->set) == 0 && !a->device == !b->device;
}

bool lab_pareto_beats(const LabParetoPoint *a, const LabParetoPoint *b) {
  return a->cost <= b->cost && a->error <= b->error && (a->cost < b->cost || a->error < b->error);
}

void lab_pareto_finish(LabPareto *pareto) {
  for (size_t p = 0; p < pareto->point_count; p++) {
    LabParetoPoint *point = &pareto->points[p];
    bool has_cpu = pareto->common.threads == 1 && isfinite(point->cpu_seconds) && !point->device;
    point->cost = has_cpu ? point->cpu_seconds : point->seconds;
  }
  for (size_t p = 0; p < pareto->point_count; p++) {
    LabParetoPoint *point = &pareto->points[p];
    point->is_frontier = isfinite(point->cost) && isfinite(point->error);
    for (size_t q = 0; q < pareto->point_count && point->is_frontier; q++)
      if (is_peer(&pareto->points[q], point) && lab_pareto_beats(&pareto->points[q], point))
        point->is_frontier = false;
    point->frontier = point->is_frontier;
  }
}

static void record_machine(const LabPareto *pareto, Record *record) {
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

static void record_models(const LabPareto *pareto, RecordList *list) {
  for (int m = 0; m < pareto->model_count; m++) {
    char path[PATH_MAX];
    Record *record = record_append(list);
    record_text(record, "model", pareto->models[m].name);
    record_text(record, "weights", app_model_names_locate(pareto->models[m].source, path) ? path : NULL);
  }
}

static Status write_json(const LabPareto *pareto, const char *path) {
  Record *record = record_new();
  if (!record) return status_no_memory("the frontier");
  record_machine(pareto, record);
  record_models(pareto, record_list(record, "models"));
  RecordList *points = record_list(record, "points");
  for (size_t p = 0; p < pareto->point_count; p++)
    app_bench_report_record(&lab_pareto_report, &pareto->points[p], record_append(points));
  RecordList *comparisons = record_list(record, "comparisons");
  for (int c = 0; c < pareto->comparison_count; c++)
    app_bench_report_record(&lab_pareto_comparison_report, &pareto->comparisons[c],
                            record_append(comparisons));
  Status status = record_write(record, path);
  record_destroy(record);
  return status;
}

static Status write_csv(const LabPareto *pareto, const char *path) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  app_bench_report_write_csv(&lab_pareto_report, &pareto->common, pareto->points, (int)pareto->point_count,
                             writer.stream);
  return file_commit(&writer);
}

Status lab_pareto_write(const LabPareto *pareto, const char *directory) {
  TRY(file_make_directories(directory));
  char *json = file_join(directory, "pareto.json"), *csv = file_join(directory, "pareto.csv");
  Status status = json && csv ? write_json(pareto, json) : status_no_memory("the frontier");
  if (!status) status = write_csv(pareto, csv);
  memory_free(json), memory_free(csv);
  return status;
}
