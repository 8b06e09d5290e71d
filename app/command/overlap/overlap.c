// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <omp.h>

#include "app/cli/parse.h"
#include "app/evaluation/model.h"
#include "app/job/job.h"
#include "app/pairs/reader.h"
#include "app/pairs/writer.h"
#include "base/log.h"
#include "base/memory.h"

typedef struct Options {
  const char *file, *model, *output; // output NULL: standard output
  int order;                         // of derivatives: 0, 1
  int threads;                       // 0: all
  bool is_json, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"model", 'm', "NAME", "Overlap model, or a weights file (default: clip)", 0, CLI_TEXT,
     CLI_TO(Options, model)},
    {"output", 'o', "FILE", "Write FILE.csv, FILE.npy or FILE.json (default: CSV on standard output)", 0,
     CLI_TEXT, CLI_TO(Options, output)},
    {"json", 'j', NULL, "Print a JSON object a pair and line: volume, gradient, centroid, flags", 0, CLI_FLAG,
     CLI_TO(Options, is_json)},
    {"order", 0, "N", "0: volumes only; 1: with their derivatives (default)", 0, CLI_INTEGER,
     CLI_TO(Options, order), 0, 1},
    {"threads", 't', "N", "Threads (default: all); the result does not depend on it", 0, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

// The model's answers for a block, owned.
typedef struct Answers {
  double *volume, *gradient, *centroid;
  unsigned *flags;
} Answers;

static void destroy_answers(Answers *answers) {
  memory_free(answers->volume), memory_free(answers->gradient), memory_free(answers->centroid);
  memory_free(answers->flags);
}

static Status make_answers(Answers *answers) {
  answers->volume = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double));
  answers->gradient = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double[APP_PAIRS_SIZE]));
  answers->centroid = memory_zeroed(APP_PAIRS_BLOCK, sizeof(double[3]));
  answers->flags = memory_zeroed(APP_PAIRS_BLOCK, sizeof(unsigned));
  bool is_whole = answers->volume && answers->gradient && answers->centroid && answers->flags;
  return is_whole ? STATUS_OK : status_no_memory("the results for a block of pairs");
}

static Status answer_block(const OverlapModel *model, const AppPairsBlock *block, const Answers *answers,
                           AppPairsWriter *writer, long long *overlapping) {
  OverlapBatch batch = {.pair_count = block->count,
                        .pairs = block->coordinates,
                        .volume = answers->volume,
                        .gradient = writer->has_gradient ? answers->gradient : NULL,
                        .centroid = answers->centroid,
                        .flags = answers->flags};
  TRY(overlap_model_eval(model, &batch));
  for (int i = 0; i < block->count; i++) *overlapping += answers->volume[i] > 0;
  app_pairs_writer_append(writer, &batch);
  return STATUS_OK;
}

static Status answer_all(AppPairsReader *reader, const OverlapModel *model, AppPairsWriter *writer,
                         long long *overlapping) {
  Answers answers = {0};
  Status status = make_answers(&answers);
  while (!status) {
    status = app_pairs_reader_next(reader);
    if (*app_job_stop_flag()) status = status_fail(STATUS_INTERRUPTED, "interrupted");
    if (status || reader->block.count == 0) break;
    status = answer_block(model, &reader->block, &answers, writer, overlapping);
  }
  destroy_answers(&answers);
  return status;
}

static Status choose_form(const Options *options, AppPairsForm *form) {
  *form = options->is_json ? APP_PAIRS_FORM_JSON : APP_PAIRS_FORM_CSV;
  if (!options->output) return STATUS_OK;
  AppPairsForm named;
  TRY(app_pairs_writer_form(options->output, &named));
  if (options->is_json && named != APP_PAIRS_FORM_JSON)
    return status_fail(STATUS_USAGE, "--json and -o %s name different forms; give one of them",
                       options->output);
  *form = named;
  return STATUS_OK;
}

// What will be asked of the model.
static Status check_gifts(const Options *options, const OverlapModel *model) {
  const char *name = options->model;
  if (overlap_model_has_gradient(model)) return STATUS_OK;
  if (!overlap_model_has_own_centroid(model))
    return status_fail(
        STATUS_USAGE,
        "--model: '%s' gives V alone, and a centroid is written, too; `tetlap eval` grades it on pairs",
        name);
  if (options->order > 0)
    return status_fail(STATUS_USAGE, "--model: '%s' gives no gradient; take --order 0", name);
  return STATUS_OK;
}

static Status run_opened(const Options *options, AppPairsReader *reader, const OverlapModel *model) {
  AppPairsForm form;
  AppPairsWriter writer;
  long long overlapping = 0;
  TRY(check_gifts(options, model));
  TRY(choose_form(options, &form));
  TRY(app_pairs_writer_open(&writer, options->output, form, options->order > 0));
  Status status = answer_all(reader, model, &writer, &overlapping);
  if (!status) status = app_pairs_writer_commit(&writer);
  app_pairs_writer_abandon(&writer);
  if (!status && options->output)
    log_info("wrote %s: %lld pairs, %lld of them overlap (%s)", options->output, reader->done, overlapping,
             options->model);
  return status;
}

static Status open_model(OverlapModel *model, const char *name) {
  Status status = app_evaluation_model_open(model, name);
  return status == STATUS_INPUT ? status_prefix(STATUS_USAGE, "--model") : status;
}

static Status run(const Options *options) {
  AppPairsReader reader;
  OverlapModel model = {0};
  Status status = app_pairs_reader_open(&reader, options->file, false);
  if (!status) status = open_model(&model, options->model);
  if (!status) status = run_opened(options, &reader, &model);
  if (model.ops) overlap_model_destroy(&model);
  app_pairs_reader_close(&reader);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.model = "clip", .order = 1};
  app_cli_parse(&app_command_overlap, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(run(&options));
}

const AppCommand app_command_overlap = {
    .name = "overlap",
    .help = "print overlap volumes of your own pairs of tetrahedra",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE", offsetof(Options, file), 1,
                              .missing = "name a file of pairs, as in pairs.csv, or - for standard input",
                              .excess = "'%s' is one argument too many: give one file of pairs"},
    .doc = "Print the overlap volume of pairs of tetrahedra, its derivatives with respect to the 24 "
           "coordinates, its centroid, and the model's flags.\vFILE is text (.csv) of 24 numbers a row, "
           "tetrahedron 1's four "
           "vertices x y z, "
           "then tetrahedron 2's; or .npy of shape (n, 24) or (n, 2, 4, 3); or .h5, a data set or an array; "
           "- is "
           "standard input. A "
           "header may name the columns a0x … a3z, b0x … b3z. See docs/overlap.md.",
    .run = run_command};
