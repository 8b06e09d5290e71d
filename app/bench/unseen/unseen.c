// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/bench.h"

#include <math.h>
#include <omp.h>

#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/bench/unseen/path.h"
#include "app/cli/argument.h"
#include "app/cli/parse.h"
#include "base/log.h"
#include "base/memory.h"
#include "overlap/models.h"

enum { MAX_MODELS = 16, MAX_CASES = 16 };

typedef struct Options {
  AppBenchOptions common;
  bool wants_case[MAX_CASES];
  const char *models[MAX_MODELS]; // borrowed
  int model_count;
  int seeds, places;
} Options;

static void read_cases(struct argp_state *state, void *wanted, char *text) {
  const char *names[MAX_CASES];
  for (int c = 0; c < app_unseen_case_count; c++) names[c] = app_unseen_cases[c].name;
  app_argument_choose(state, "case", text, names, app_unseen_case_count, wanted);
}

static const AppOption option_table[] = {
    {"model", 'm', "NAME,...", "Overlap models, or files of yours, to measure (default: geo,geo-small)", 1,
     CLI_LIST, CLI_TO(Options, models), .most = MAX_MODELS, .example = "geo,clip32",
     .count_offset = offsetof(Options, model_count)},
    {"case", 'k', "NAME,...",
     "Cases: jittered, aligned, five, graded, slivers, strained, fine, thin, edge, made, adapted "
     "(default: all)",
     1, CLI_OWN, CLI_TO(Options, wants_case), .read = read_cases},
    {"seeds", 's', "N", "Meshes of each case (default: 3)", 1, CLI_INTEGER, CLI_TO(Options, seeds), 1, 1000},
    {"places", 'p', "N", "Places of each path (default: 96)", 1, CLI_INTEGER, CLI_TO(Options, places), 8,
     100000},
    {.table = app_bench_options, .offset = offsetof(Options, common)},
    {0},
};

typedef struct Row {
  const char *model, *what;
  long long seeds, pairs;
  AppUnseenErrors worst; // over the seeds
  double time_ratio;
} Row;

#define ERROR(field) offsetof(Row, worst) + offsetof(AppUnseenErrors, field)
static const AppTableColumn columns[] = {
    {"case", APP_TABLE_TEXT, offsetof(Row, what), "case", "the bodies: `tetlap bench unseen --help`"},
    {"model", APP_TABLE_TEXT, offsetof(Row, model), "model", "overlap model"},
    {"seeds", APP_TABLE_INTEGER, offsetof(Row, seeds), NULL, "meshes; each error is the largest over them"},
    {"pairs", APP_TABLE_INTEGER, offsetof(Row, pairs), "pairs",
     "that share volume, over all places and meshes"},
    {"volume_error", APP_TABLE_NUMBER, ERROR(volume), "V", "sum of errors of V over the sum of V"},
    {"moment_error", APP_TABLE_NUMBER, ERROR(moment), "moments",
     "sum of errors of V λ(centroid) at the eight vertices over the sum of those"},
    {"nodal_force_error", APP_TABLE_NUMBER, ERROR(nodal_force), "nodal forces",
     "of all vertices along the path, root of squares, relative"},
    {"total_force_error", APP_TABLE_NUMBER, ERROR(total_force), "total force", "of the upper body, likewise"},
    {"tangential_error", APP_TABLE_NUMBER, ERROR(tangential), "tangential",
     "largest error of the total force along the surface over the largest force across it: false friction"},
    {"normal_sum_error", APP_TABLE_NUMBER, ERROR(normal_sum), "sum of N",
     "of the pairs' forces, which bounds friction, likewise"},
    {"path_work", APP_TABLE_NUMBER, ERROR(path_work), "closed path",
     "work of the total force round the closed path over the work turned over"},
    {"path_work_clip", APP_TABLE_NUMBER, ERROR(path_work_clip), "by clip",
     "the same of clipping: what the steps of the path leave"},
    {"time_ratio", APP_TABLE_NUMBER, offsetof(Row, time_ratio), "× time",
     "processor time of volumes and centroids over that of clipping, median of the rounds"},
};
static const AppBenchReport report = {"unseen", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      false};

static void keep_worst(AppUnseenErrors *worst, const AppUnseenErrors *errors, bool is_first) {
  AppUnseenErrors sum = *worst;
  *worst = *errors;
  if (is_first) return;
  worst->pairs += sum.pairs, worst->seconds += sum.seconds, worst->seconds_clip += sum.seconds_clip;
  double *values[] = {&worst->volume,     &worst->moment,     &worst->nodal_force, &worst->total_force,
                      &worst->tangential, &worst->normal_sum, &worst->path_work,   &worst->path_work_clip};
  const double others[] = {sum.volume,     sum.moment,     sum.nodal_force, sum.total_force,
                           sum.tangential, sum.normal_sum, sum.path_work,   sum.path_work_clip};
  for (int v = 0; v < 8; v++) // NaN stays
    if (isnan(others[v]) || others[v] > *values[v]) *values[v] = others[v];
}

// All meshes of a case. Errors are the same in every round, times are not.
static Status measure_round(const Options *options, const AppUnseenCase *what, const OverlapModel *model,
                            const OverlapModel *clip, AppUnseenErrors *worst) {
  for (int s = 0; s < options->seeds; s++) {
    AppUnseenMesh mesh;
    AppUnseenErrors errors;
    Status status = app_unseen_mesh_create(&mesh, what, 7001 + (uint64_t)s);
    if (status) return status_prefix(status, "case '%s' (--case leaves it out)", what->name);
    status = app_unseen_path_measure(what, &mesh, model, clip, options->places, &errors);
    app_unseen_mesh_destroy(&mesh);
    TRY(status);
    keep_worst(worst, &errors, s == 0);
  }
  return STATUS_OK;
}

static Status measure(const Options *options, const AppUnseenCase *what, const char *name,
                      const OverlapModel *model, const OverlapModel *clip, Row *row) {
  AppBenchTimer own = {0}, of_clip = {0};
  int rounds = options->common.repeats;
  *row = (Row){.model = name, .what = what->name, .seeds = options->seeds};
  for (int r = 0; r < rounds; r++) {
    TRY(measure_round(options, what, model, clip, &row->worst));
    own.cpu[r] = row->worst.seconds, of_clip.cpu[r] = row->worst.seconds_clip;
  }
  row->pairs = row->worst.pairs;
  row->time_ratio = app_bench_timer_cpu_ratio(&of_clip, &own, rounds).median;
  return STATUS_OK;
}

static Status measure_model(const Options *options, const char *name, const OverlapModel *clip, Row *rows,
                            int *count) {
  OverlapModel model;
  TRY(app_bench_options_open(name, &model));
  Status status = STATUS_OK;
  for (int c = 0; c < app_unseen_case_count && !status; c++) {
    if (!options->wants_case[c]) continue;
    log_progress("%s, %s", name, app_unseen_cases[c].name);
    status = measure(options, &app_unseen_cases[c], name, &model, clip, &rows[(*count)++]);
  }
  log_progress_end();
  overlap_model_destroy(&model);
  return status;
}

static Status run(const Options *options) {
  static Row rows[MAX_MODELS * MAX_CASES];
  int count = 0;
  OverlapModel clip;
  omp_set_num_threads(options->common.threads);
  TRY(overlap_models_create(&clip, "clip"));
  Status status = STATUS_OK;
  for (int m = 0; m < options->model_count && !status; m++)
    status = measure_model(options, options->models[m], &clip, rows, &count);
  overlap_model_destroy(&clip);
  return status ? status : app_bench_report_print(&report, &options->common, rows, count);
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = {.threads = 1, .repeats = 1},
                     .models = {"geo", "geo-small"},
                     .model_count = 2,
                     .seeds = 3,
                     .places = 96};
  for (int c = 0; c < app_unseen_case_count; c++) options.wants_case[c] = true;
  app_cli_parse(&app_bench_unseen, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand app_bench_unseen = {
    .name = "unseen",
    .help = "overlap models: errors on bodies that no training has seen",
    .options = option_table,
    .doc = "Measure overlap models on bodies that no training has seen: meshes "
           "of other makers and gradings, slivers, "
           "large strain, thin parts, edges, aligned slabs. The upper body goes "
           "round a closed path in contact, and "
           "at each place volumes, centroids and forces are compared with those "
           "of clipping. Errors are the largest "
           "over the seeds.",
    .run = run_command,
    .has_threads = true,
    .rows = &report,
    .describe_rows = app_bench_report_describe};
