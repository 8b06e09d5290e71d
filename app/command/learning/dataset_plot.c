// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdio.h>

#include "app/cli/parse.h"
#include "app/dataset/plot.h"
#include "base/log.h"
#include "datagen/files/dataset.h"

typedef struct Options {
  const char *file, *output; // output NULL: beside the file
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "FILE", "The picture (default: FILE.png)", 0, CLI_TEXT, CLI_TO(Options, output)},
    {0},
};

static Status plot(const Options *options) {
  char picture[4096];
  int length = options->output ? snprintf(picture, sizeof picture, "%s", options->output)
                               : snprintf(picture, sizeof picture, "%s.png", options->file);
  if (length >= (int)sizeof picture) return status_fail(STATUS_USAGE, "the picture's name is too long");
  DatagenDataset *dataset;
  TRY(datagen_dataset_open(&dataset, options->file));
  Status status = app_dataset_plot(dataset, options->file, picture);
  datagen_dataset_close(dataset);
  if (!status) log_info("wrote %s and its script %s.gp", picture, picture);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_dataset_plot, argument_count, arguments, &options);
  return app_cli_command_end(plot(&options));
}

const AppCommand app_command_dataset_plot = {
    .name = "plot",
    .help = "draw its kinds and volumes",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE", offsetof(Options, file), 1,
                              .missing = "which data set? give a file, as in: tetlap dataset plot train.h5",
                              .excess = "'%s' is one argument too many: give one data set"},
    .doc = "Draw how the kinds of a data set and their volumes are distributed.",
    .run = run_command};
