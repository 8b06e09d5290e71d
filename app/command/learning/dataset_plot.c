// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/learning/dataset_plot.h"

#include <stdio.h>

#include "app/dataset/plot.h"
#include "base/log.h"
#include "datagen/files/dataset.h"

typedef struct Options {
  const char *file, *output; // output NULL: beside the file
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0, "The picture (default: FILE.png)", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->output = text;
    return 0;
  case ARGP_KEY_ARG:
    if (options->file) argp_error(state, "'%s' is one argument too many: give one data set", text);
    options->file = text;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "which data set? give a file, as in: tetlap dataset plot train.h5");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

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

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .args_doc = "FILE",
                                 .doc =
                                     "Draw how the kinds of a data set and their volumes are distributed."};

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  return app_cli_command_end(plot(&options));
}

const AppCommand app_command_dataset_plot = {
    .name = "plot", .help = "draw its kinds and volumes", .argp = &argp, .run = run_command};
