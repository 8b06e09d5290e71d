// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <omp.h>

#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "app/dataset/import.h"
#include "app/job/job.h"
#include "base/log.h"

enum { MOST_TEXT = 1024 };

typedef struct Options {
  AppImportDef import;
  const char *file;
  int threads; // 0: all
  bool is_json, is_quiet, is_verbose;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "FILE", "The data set to write (.h5)", 0, CLI_TEXT, CLI_TO(Options, import.output)},
    {"tolerance", 0, "SHARE",
     "By how much of the exact V, and of the length of its derivatives, a label may be off (default: 1e-6)",
     0, CLI_NUMBER, CLI_TO(Options, import.tolerance), 0, 1},
    {"gradient", 0, NULL, "Put the derivatives of V into the set, if the file has none, too", 0, CLI_FLAG,
     CLI_TO(Options, import.has_gradient)},
    {"strict", 0, NULL, "A wrong label is an error, and nothing is written", 0, CLI_FLAG,
     CLI_TO(Options, import.is_strict)},
    {"threads", 't', "N", "Threads (default: all); the result does not depend on it", 0, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"json", 'j', NULL, "Print what was found as JSON", 0, CLI_FLAG, CLI_TO(Options, is_json)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {"verbose", 'v', NULL, "Name every wrong label, not only the first ten of a sort", 0, CLI_FLAG,
     CLI_TO(Options, is_verbose)},
    {0},
};

static void log_counts(const AppPairsReader *reader, const AppImport *import) {
  for (int f = 0; f < APP_IMPORT_FAULT_COUNT; f++) {
    char text[MOST_TEXT];
    if (import->findings[f].count == 0) continue;
    app_dataset_import_tell(import, (AppImportFault)f, app_pairs_reader_place_word(reader), text,
                            sizeof text);
    log_warning("%s: %s", reader->name, text);
  }
}

static void conclude(const AppPairsReader *reader, const AppImportDef *def, const AppImport *import) {
  bool has_labels = reader->has_volume || reader->has_status || reader->has_gradient;
  long long wrong = app_dataset_import_fault_count(import);
  log_info("wrote %s: %lld pairs with exact labels; %s", def->output, import->written,
           !has_labels  ? "the file has none to compare"
           : wrong == 0 ? "all labels of the file agree"
                        : "where the file's are wrong they were replaced");
}

static Status print_json(const Options *options, const AppImport *import) {
  Record *record = record_new();
  if (!record) return status_no_memory("the findings");
  record_text(record, "file", options->file);
  record_text(record, "output", options->import.output);
  app_dataset_import_record(import, record);
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static Status run(const Options *options) {
  AppPairsReader reader;
  AppImport import = {0};
  Status status = app_pairs_reader_open(&reader, options->file, true);
  if (!status && reader.format == APP_PAIRS_DATASET)
    status = status_fail(STATUS_INPUT, "%s: is a data set already", options->file);
  if (!status) {
    status = app_dataset_import_run(&reader, &options->import, &import);
    log_counts(&reader, &import);
  }
  if (!status) conclude(&reader, &options->import, &import);
  app_pairs_reader_close(&reader);
  if (!options->is_json || import.read == 0 || (status && status != STATUS_INPUT)) return status;
  // also of a file that was refused: what is wrong with it
  Status printed = print_json(options, &import);
  return status ? status : printed;
}

static void check(struct argp_state *state, void *options) {
  if (!((const Options *)options)->import.output)
    argp_error(state, "name the file to write, as in -o pairs.h5");
}

static int run_command(int argument_count, char **arguments) {
  char program[DATAGEN_PROGRAM_TEXT];
  snprintf(program, sizeof program, "tetlap %s", app_versions_program());
  Options options = {.import = {.tolerance = 1e-6, .program = program, .stop = app_job_stop_flag()}};
  app_cli_parse(&app_command_dataset_import, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet, .is_verbose = options.is_verbose});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(run(&options));
}

const AppCommand app_command_dataset_import = {
    .name = "import",
    .help = "make a data set of your own labelled pairs",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE", offsetof(Options, file), 1,
                              .missing = "name a file of pairs, as in pairs.csv, or - for standard input",
                              .excess = "'%s' is one argument too many: give one file of pairs"},
    .doc = "Make a data set of labelled pairs of tetrahedra of one's own. "
           "Status and volume of every pair are found in exact "
           "arithmetic; labels of the file that disagree are counted, named and "
           "replaced.\vFILE is text (.csv) or .npy, - "
           "standard input. A row has 24 coordinates, or 25 numbers (volume "
           "behind them), 26 (status, volume), 49 (volume, "
           "24 derivatives), 50 (status, volume, derivatives); or a header "
           "names the columns: a0x … b3z, status, volume, "
           "dV/da0x … dV/db3z. See docs/data.md.",
    .check = check,
    .run = run_command,
    .has_threads = true};
