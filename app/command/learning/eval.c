// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "app/cli/model_names.h"
#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "app/dataset/source.h"
#include "app/evaluation/model.h"
#include "app/evaluation/paths.h"
#include "app/evaluation/report.h"
#include "app/job/job.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "overlap/weights.h"

enum { BLOCK = 16384 };

typedef struct Options {
  const char *words[2]; // the model, and a file of pairs
  int word_count;
  AppSourceDef source;
  int threads; // 0: all
  int paths;   // to look for jumps along; 0: none
  bool has_seed, is_json, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"law", 'l', "NAME", "Make the pairs by this law, as `tetlap datagen` does, instead of a FILE", 0,
     CLI_TEXT, CLI_TO(Options, source.law)},
    {"count", 'n', "N", "Pairs (default: all of the file; the law's)", 0, CLI_INTEGER,
     CLI_TO(Options, source.count), 1, INFINITY},
    {"seed", 's', "S", "The law's seed (default: 1)", 0, CLI_SEED, CLI_TO(Options, source.seed),
     .mark_offset = offsetof(Options, has_seed)},
    {"mix", 0, "KIND=SHARE,...", "Shares of the kinds, instead of the law's", 0, CLI_WORDS,
     CLI_TO(Options, source.mix), .example = "none=50,volumetric=50"},
    {"volume", 0, "LAW", "Law of the volumetric pairs' V, instead of the law's", 0, CLI_TEXT,
     CLI_TO(Options, source.volume)},
    {"paths", 0, "N", "Look for jumps of V and of its gradient along N paths; needs no data", 0, CLI_INTEGER,
     CLI_TO(Options, paths), 1, INT_MAX},
    {"threads", 't', "N", "Threads (default: all); the result does not depend on it", 0, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"json", 'j', NULL, "Print the result as JSON", 0, CLI_FLAG, CLI_TO(Options, is_json)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static void check(struct argp_state *state, void *given) {
  Options *options = given;
  options->source.file = options->words[1];
  if (!options->source.file && !options->source.law && !options->paths)
    argp_error(state, "name a data set's file, a --law, or a number of --paths");
  if (options->source.file && options->source.law)
    argp_error(state, "a file and --law contradict each other; give one of them");
  const AppSourceDef *source = &options->source;
  const char *lawless = source->mix ? "mix" : source->volume ? "volume" : NULL;
  if (lawless && !source->law)
    argp_error(state, "--%s changes a law, and there is none; add --law%s", lawless,
               source->file ? " in place of the file" : "");
  if (options->has_seed && !source->law && !options->paths)
    argp_error(state,
               "--seed is of the pairs of a --law or of --paths, and a file has its own; leave it out");
  if (source->count && !source->law && !source->file)
    argp_error(state, "--count is of the pairs of a file or a --law, and there is neither; leave it out");
}

static Status add_blocks(AppSource *source, const DatagenPairs *buffer, AppEvaluationRun *run) {
  double began = clock_wall_s();
  for (long long first = 0; first < source->count; first += BLOCK) {
    if (*app_job_stop_flag()) return status_fail(STATUS_INTERRUPTED, "interrupted");
    long long left = source->count - first;
    size_t count = (size_t)(left < BLOCK ? left : BLOCK);
    DatagenPairs pairs = *buffer;
    if (!source->has_gradient) pairs.gradient = NULL;
    TRY(app_dataset_source_read(source, first, count, &pairs));
    TRY(app_evaluation_add(run, &pairs, count));
    long long done = first + (long long)count;
    log_progress("%lld of %lld pairs  %.0f s left", done, source->count,
                 (clock_wall_s() - began) / (double)done * (double)(source->count - done));
  }
  return STATUS_OK;
}

// What was found; either part may be absent.
typedef struct Findings {
  bool has_evaluation, has_paths, is_paper;
  char data[768];
  AppEvaluation evaluation;
  AppEvaluationPaths paths;
} Findings;

static Status print(const Options *options, const Findings *findings) {
  AppModelName name;
  app_model_names_find_one(options->words[0], name);
  if (findings->has_evaluation)
    TRY(app_evaluation_print(&findings->evaluation, name, findings->data, findings->is_paper, stdout));
  if (findings->has_paths) app_evaluation_print_paths(&findings->paths, name, stdout);
  return STATUS_OK;
}

static Status record(const Options *options, const Findings *findings) {
  Record *record = record_new();
  if (!record) return status_no_memory("the result");
  AppModelName name;
  char path[PATH_MAX];
  app_model_names_find_one(options->words[0], name);
  record_text(record, "model", name);
  record_text(record, "weights", app_model_names_locate(options->words[0], path) ? path : NULL);
  record_text(record, "program", app_versions_program());
  if (findings->has_evaluation) {
    record_text(record, "data", findings->data);
    app_evaluation_record(&findings->evaluation, record);
  }
  if (findings->has_paths) app_evaluation_record_paths(&findings->paths, record_child(record, "paths"));
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static Status evaluate(AppSource *source, const OverlapModel *model, AppEvaluation *evaluation) {
  DatagenPairs buffer;
  AppEvaluationRun run;
  TRY(datagen_pairs_create(&buffer, BLOCK, true));
  app_evaluation_begin(&run, model, app_evaluation_model_logits(model));
  Status status = add_blocks(source, &buffer, &run);
  log_progress_end();
  if (!status) app_evaluation_finish(&run, evaluation);
  app_evaluation_end(&run);
  datagen_pairs_destroy(&buffer);
  return status;
}

static Status evaluate_data(const Options *options, const OverlapModel *model, Findings *findings) {
  AppSource source;
  Status status = app_dataset_source_open(&source, &options->source, true);
  if (!status) status = evaluate(&source, model, &findings->evaluation);
  findings->is_paper = !status && app_dataset_source_is_paper(&options->source, &source);
  if (!status) app_dataset_source_describe(&options->source, &source, findings->data, sizeof findings->data);
  app_dataset_source_close(&source);
  return status;
}

static Status evaluate_all(const Options *options, const OverlapModel *model) {
  Findings findings = {.has_evaluation = options->source.file || options->source.law,
                       .has_paths = options->paths > 0};
  if (findings.has_evaluation) TRY(evaluate_data(options, model, &findings));
  if (findings.has_paths)
    TRY(app_evaluation_paths(model, options->paths, options->source.seed, &findings.paths));
  if (options->is_json) return record(options, &findings);
  return print(options, &findings);
}

static Status open_and_evaluate(const Options *options) {
  OverlapModel model;
  Status opened = app_evaluation_model_open(&model, options->words[0]);
  if (opened == STATUS_INPUT && !overlap_weights_is_path(options->words[0]))
    return STATUS_USAGE; // no such name
  TRY(opened);
  Status status = evaluate_all(options, &model);
  overlap_model_destroy(&model);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.source.seed = 1};
  app_cli_parse(&app_command_eval, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(open_and_evaluate(&options));
}

const AppCommand app_command_eval = {
    .name = "eval",
    .help = "measure an overlap model against labelled pairs",
    .options = option_table,
    .arguments =
        &(const AppArguments){
            "MODEL [FILE]", offsetof(Options, words), 2, offsetof(Options, word_count),
            .missing = "name a model (clip, exact, geo, …) or a weights file, then a data set or --law",
            .excess = "'%s' is one argument too many: give MODEL and FILE"},
    .doc = "Evaluate an overlap model, by name or weights file, on labelled pairs: status, volume, "
           "derivatives, ghosts and symmetries, in addition to the paper's Table 4.",
    .check = check,
    .run = run_command,
    .has_threads = true};
