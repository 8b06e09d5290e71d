// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdbool.h>

#include "app/cli/parse.h"
#include "base/log.h"
#include "datagen/files/merge.h"

enum { MAX_FILES = 65536 };

typedef struct Options {
  const char *output;
  const char *files[MAX_FILES];
  int file_count;
  bool mixes;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "FILE", "The file to write", 0, CLI_TEXT, CLI_TO(Options, output)},
    {"mix", 0, NULL, "Take files of different laws or seeds, one after another", 0, CLI_FLAG,
     CLI_TO(Options, mixes)},
    {0},
};

static Status merge(const Options *options) {
  TRY(datagen_merge(options->files, options->file_count, options->output, options->mixes));
  log_info("wrote %s from %d files", options->output, options->file_count);
  return STATUS_OK;
}

static void check(struct argp_state *state, void *options) {
  if (!((const Options *)options)->output) argp_error(state, "name the file to write, as in -o pairs.h5");
}

static int run_command(int argument_count, char **arguments) {
  static Options options;
  app_cli_parse(&app_command_dataset_merge, argument_count, arguments, &options);
  return app_cli_command_end(merge(&options));
}

const AppCommand app_command_dataset_merge = {
    .name = "merge",
    .help = "join shards, or data sets",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE…", offsetof(Options, files), MAX_FILES, offsetof(Options, file_count),
                              .missing = "which files? as in: tetlap dataset merge part-*.h5 -o all.h5",
                              .excess = "'%s' is one file too many: at most %d are joined"},
    .doc = "Join the shards of a data set, or data sets, into one file.",
    .check = check,
    .run = run_command};
