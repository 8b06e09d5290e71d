// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/learning/dataset_import.h"

#include <omp.h>

#include "app/cli/argument.h"
#include "app/cli/versions.h"
#include "app/dataset/import.h"
#include "app/job/job.h"
#include "base/log.h"

enum { KEY_TOLERANCE = 256, KEY_GRADIENT, KEY_STRICT, MOST_TEXT = 1024 };

typedef struct Options {
  AppImportDef import;
  const char *file;
  int threads; // 0: all
  bool is_json, is_quiet, is_verbose;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0, "The data set to write (.h5)", 0},
    {"tolerance", KEY_TOLERANCE, "SHARE", 0,
     "By how much of the exact V, and of the length of its derivatives, a label may be off (default: 1e-6)",
     0},
    {"gradient", KEY_GRADIENT, NULL, 0, "Put the derivatives of V into the set, if the file has none, too",
     0},
    {"strict", KEY_STRICT, NULL, 0, "A wrong label is an error, and nothing is written", 0},
    {"threads", 't', "N", 0, "Threads (default: all); the result does not depend on it", 0},
    {"json", 'j', NULL, 0, "Print what was found as JSON", 0},
    {"quiet", 'q', NULL, 0, "Say errors only", 0},
    {"verbose", 'v', NULL, 0, "Name every wrong label, not only the first ten of a sort", 0},
    {0},
};

static error_t parse_argument(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_ARG:
    if (options->file) argp_error(state, "'%s' is one argument too many: give one file of pairs", text);
    options->file = text;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name a file of pairs, as in pairs.csv, or - for standard input");
    return 0;
  case ARGP_KEY_END:
    if (!options->import.output) argp_error(state, "name the file to write, as in -o pairs.h5");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->import.output = text;
    return 0;
  case KEY_TOLERANCE:
    options->import.tolerance = app_argument_number(state, "tolerance", text, 0, 1);
    return 0;
  case KEY_GRADIENT:
    options->import.has_gradient = true;
    return 0;
  case KEY_STRICT:
    options->import.is_strict = true;
    return 0;
  case 't':
    options->threads = app_argument_threads(state, text);
    return 0;
  case 'j':
    options->is_json = true;
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case 'v':
    options->is_verbose = true;
    return 0;
  default:
    return parse_argument(key, text, state);
  }
}

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

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .args_doc = "FILE",
                                 .doc = "Make a data set of labelled pairs of tetrahedra of one's own. "
                                        "Status and volume of every pair are found in exact "
                                        "arithmetic; labels of the file that disagree are counted, named and "
                                        "replaced.\vFILE is text (.csv) or .npy, - "
                                        "standard input. A row has 24 coordinates, or 25 numbers (volume "
                                        "behind them), 26 (status, volume), 49 (volume, "
                                        "24 derivatives), 50 (status, volume, derivatives); or a header "
                                        "names the columns: a0x … b3z, status, volume, "
                                        "dV/da0x … dV/db3z. See docs/data.md."};

static int run_command(int argument_count, char **arguments) {
  char program[DATAGEN_PROGRAM_TEXT];
  snprintf(program, sizeof program, "tetlap %s", app_versions_program());
  Options options = {.import = {.tolerance = 1e-6, .program = program, .stop = app_job_stop_flag()}};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet, .is_verbose = options.is_verbose});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(run(&options));
}

const AppCommand app_command_dataset_import = {.name = "import",
                                               .help = "make a data set of your own labelled pairs",
                                               .argp = &argp,
                                               .run = run_command,
                                               .has_threads = true};
