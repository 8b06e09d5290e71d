// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/learning/dataset_merge.h"

#include <stdbool.h>

#include "base/log.h"
#include "datagen/files/merge.h"

enum { MAX_FILES = 65536, KEY_MIX = 256 };

typedef struct Options {
  const char *output;
  char **files; // borrowed from the command line
  int file_count;
  bool mixes;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0, "The file to write", 0},
    {"mix", KEY_MIX, NULL, 0, "Take files of different laws or seeds, one after another", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->output = text;
    return 0;
  case KEY_MIX:
    options->mixes = true;
    return 0;
  case ARGP_KEY_ARGS:
    options->files = state->argv + state->next;
    options->file_count = state->argc - state->next;
    if (options->file_count > MAX_FILES) argp_error(state, "at most %d files", MAX_FILES);
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "which files? as in: tetlap dataset merge part-*.h5 -o all.h5");
    return 0;
  case ARGP_KEY_END:
    if (!options->output) argp_error(state, "name the file to write, as in -o pairs.h5");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status merge(const Options *options) {
  TRY(datagen_merge((const char *const *)options->files, options->file_count, options->output,
                    options->mixes));
  log_info("wrote %s from %d files", options->output, options->file_count);
  return STATUS_OK;
}

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .args_doc = "FILE…",
                                 .doc = "Join the shards of a data set, or data sets, into one file."};

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  return app_cli_command_end(merge(&options));
}

const AppCommand app_command_dataset_merge = {
    .name = "merge", .help = "join shards, or data sets", .argp = &argp, .run = run_command};
