// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/eval_command.h"

#include <argp.h>
#include <errno.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>

#include "app/evaluation_model.h"
#include "app/evaluation_report.h"
#include "app/job.h"
#include "app/training_source.h"
#include "app/versions.h"
#include "base/clock.h"
#include "base/log.h"

enum { KEY_MIX = 256, KEY_VOLUME, BLOCK = 16384 };

typedef struct Options {
  const char *model;
  AppSourceDef source;
  int threads; // 0: all
  bool is_json, is_quiet;
} Options;

static const struct argp_option option_table[] = {
    {"law", 'l', "NAME", 0, "Make the pairs by this law, as `tetlap datagen` does, instead of a FILE", 0},
    {"count", 'n', "N", 0, "Pairs (default: all of the file; the law's)", 0},
    {"seed", 's', "S", 0, "The law's seed (default: 1)", 0},
    {"mix", KEY_MIX, "KIND=SHARE,…", 0, "Shares of the kinds, instead of the law's", 0},
    {"volume", KEY_VOLUME, "LAW", 0, "Law of the volumetric pairs' V, instead of the law's", 0},
    {"threads", 't', "N", 0, "Threads (default: all); the result does not depend on it", 0},
    {"json", 'j', NULL, 0, "Print the result as JSON", 0},
    {"quiet", 'q', NULL, 0, "Say errors only", 0},
    {0},
};

static long long integer_of(struct argp_state *state, const char *option, const char *text, long long least) {
  char *end;
  errno = 0;
  long long value = strtoll(text, &end, 10);
  if (end == text || *end || errno || value < least)
    argp_error(state, "--%s is '%s'; give a whole number from %lld up", option, text, least);
  return value;
}

static void check(struct argp_state *state, const Options *options) {
  if (!options->model)
    argp_error(state, "name a model (clip, exact, geo, …) or a weights file, then a data set or --law");
  if (!options->source.file && !options->source.law) argp_error(state, "name a data set's file or a --law");
  if (options->source.file && options->source.law)
    argp_error(state, "a file and --law contradict each other; give one of them");
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'l':
    options->source.law = text;
    return 0;
  case 'n':
    options->source.count = integer_of(state, "count", text, 1);
    return 0;
  case 's':
    options->source.seed = (uint64_t)integer_of(state, "seed", text, 0);
    return 0;
  case KEY_MIX:
    options->source.mix = text;
    return 0;
  case KEY_VOLUME:
    options->source.volume = text;
    return 0;
  case 't':
    options->threads = (int)integer_of(state, "threads", text, 1);
    return 0;
  case 'j':
    options->is_json = true;
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case ARGP_KEY_ARG:
    if (!options->model)
      options->model = text;
    else if (!options->source.file)
      options->source.file = text;
    else
      argp_error(state, "'%s' is one too many: give MODEL and FILE", text);
    return 0;
  case ARGP_KEY_END:
    check(state, options);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status add_blocks(AppSource *source, const DatagenPairs *buffer, AppEvaluationRun *run) {
  double began = clock_wall_s();
  for (long long first = 0; first < source->count; first += BLOCK) {
    if (*app_job_stop_flag()) return status_fail(STATUS_INTERRUPTED, "interrupted");
    long long left = source->count - first;
    size_t count = (size_t)(left < BLOCK ? left : BLOCK);
    DatagenPairs pairs = *buffer;
    if (!source->has_gradient) pairs.gradient = NULL;
    TRY(app_training_source_read(source, first, count, &pairs));
    TRY(app_evaluation_add(run, &pairs, count));
    long long done = first + (long long)count;
    log_progress("%lld of %lld pairs  %.0f s left", done, source->count,
                 (clock_wall_s() - began) / (double)done * (double)(source->count - done));
  }
  return STATUS_OK;
}

static Status report(const Options *options, const AppSource *source, const AppEvaluation *evaluation) {
  char data[768];
  app_training_source_describe(&options->source, source, data, sizeof data);
  if (!options->is_json) {
    app_evaluation_print(evaluation, options->model, data, stdout);
    return STATUS_OK;
  }
  Record *record = record_new();
  if (!record) return status_no_memory("the result");
  record_text(record, "model", options->model);
  record_text(record, "data", data);
  record_text(record, "program", app_versions_program());
  app_evaluation_record(evaluation, record);
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static Status evaluate(const Options *options, AppSource *source, const ContactOverlapModel *model) {
  DatagenPairs buffer;
  AppEvaluationRun run;
  AppEvaluation evaluation;
  TRY(datagen_pairs_create(&buffer, BLOCK, true));
  app_evaluation_begin(&run, model, app_evaluation_model_logits(model));
  Status status = add_blocks(source, &buffer, &run);
  log_progress_end();
  if (!status) {
    app_evaluation_finish(&run, &evaluation);
    status = report(options, source, &evaluation);
  }
  app_evaluation_end(&run);
  datagen_pairs_destroy(&buffer);
  return status;
}

static Status open_and_evaluate(const Options *options) {
  ContactOverlapModel model;
  AppSource source;
  TRY(app_evaluation_model_open(&model, options->model));
  Status status = app_training_source_open(&source, &options->source, true);
  if (!status) status = evaluate(options, &source, &model);
  app_training_source_close(&source);
  contact_overlap_destroy(&model);
  return status;
}

int app_eval_run(int argument_count, char **arguments) {
  static const struct argp argp = {
      .options = option_table,
      .parser = parse,
      .args_doc = "MODEL [FILE]",
      .doc = "Evaluate an overlap model, by name or weights file, on labelled pairs: status, volume, "
             "derivatives, ghosts and symmetries, beside what the paper's Table 4 reports.",
  };
  Options options = {.source.seed = 1};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  Status status = open_and_evaluate(&options);
  if (status) log_error("%s", status_message());
  return status_exit_code(status);
}
