// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/learning/dataset.h"

#include <stdbool.h>
#include <stdio.h>

#include "app/command/learning/dataset_import.h"
#include "app/dataset/plot.h"
#include "app/dataset/summary.h"
#include "base/files/record.h"
#include "base/log.h"
#include "datagen/files/dataset.h"
#include "datagen/files/merge.h"

enum { MAX_FILES = 65536, KEY_MIX = 256 };

static int exit_code_of(Status status) {
  if (status) log_error("%s", status_message());
  return status_exit_code(status);
}

// info

typedef struct InfoOptions {
  const char *file;
  bool is_json;
} InfoOptions;

static const struct argp_option info_table[] = {{"json", 'j', NULL, 0, "Print JSON", 0}, {0}};

static error_t parse_info(int key, char *text, struct argp_state *state) {
  InfoOptions *options = state->input;
  switch (key) {
  case 'j':
    options->is_json = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->file) argp_error(state, "'%s' is one too many: give one data set", text);
    options->file = text;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "which data set? give a file, as in: tetlap dataset info train.h5");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static void print_text(const char *path, const DatagenInfo *info, const AppDatasetSummary *summary) {
  printf("%s\n", path);
  printf("  made by      %s, generator %lld\n", info->program, info->generator_version);
  printf("  law          %s, seed %llu\n", info->law, (unsigned long long)info->seed);
  printf("  mix          %s\n  volume law   %s\n", info->mix, info->volume_law);
  printf("  labels       %s, %s\n", info->label,
         info->has_gradient && info->has_centroid ? "V, its gradient, centroid"
         : info->has_gradient                     ? "V and its gradient"
         : info->has_centroid                     ? "V and centroid"
                                                  : "V");
  printf("  pairs        %lld", info->count);
  if (info->count < info->planned) printf(" of %lld planned: interrupted", info->planned);
  if (info->planned < info->total) printf(" (%lld … of %lld in all)", info->first, info->total);
  printf("\n\n  kind              pairs     share   accepted        V min       median          max\n");
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    const AppDatasetKind *kind = &summary->kinds[k];
    if (!kind->count) continue;
    printf("  %-13s %9lld  %6.2f %%", datagen_kind_info(k)->name, kind->count,
           100 * (double)kind->count / (double)info->count);
    if (info->attempts[k])
      printf("  %7.3g %%", 100 * (double)kind->count / (double)info->attempts[k]);
    else
      printf("  %9s", "-");
    if (kind->volume_max > 0)
      printf("  %11.4g  %11.4g  %11.4g\n", kind->volume_min, kind->volume_median, kind->volume_max);
    else
      printf("  %11s  %11s  %11s\n", "0", "0", "0");
  }
}

static Status print_json(const char *path, const DatagenInfo *info, const AppDatasetSummary *summary) {
  Record *root = record_new();
  record_text(root, "file", path);
  record_text(root, "program", info->program);
  record_integer(root, "generator_version", info->generator_version);
  record_text(root, "law", info->law);
  record_integer(root, "seed", (long long)info->seed);
  record_text(root, "mix", info->mix);
  record_text(root, "volume_law", info->volume_law);
  record_number(root, "swap_share", info->swap_share);
  record_text(root, "label", info->label);
  record_bool(root, "gradient", info->has_gradient);
  record_bool(root, "centroid", info->has_centroid);
  record_integer(root, "pairs", info->count);
  record_integer(root, "planned", info->planned);
  record_integer(root, "first", info->first);
  record_integer(root, "total", info->total);
  Record *kinds = record_child(root, "kinds");
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    const AppDatasetKind *kind = &summary->kinds[k];
    if (!kind->count) continue;
    Record *row = record_child(kinds, datagen_kind_info(k)->name);
    record_integer(row, "pairs", kind->count);
    record_integer(row, "attempts", info->attempts[k]);
    record_number(row, "volume_min", kind->volume_min);
    record_number(row, "volume_median", kind->volume_median);
    record_number(row, "volume_max", kind->volume_max);
  }
  Status status = root ? record_print(root, stdout) : status_no_memory("the report");
  record_destroy(root);
  return status;
}

static Status print_info(const InfoOptions *options) {
  DatagenDataset *dataset;
  AppDatasetSummary summary;
  TRY(datagen_dataset_open(&dataset, options->file));
  const DatagenInfo *info = datagen_dataset_info(dataset);
  Status status = app_dataset_summarise(dataset, &summary);
  if (!status && options->is_json)
    status = print_json(options->file, info, &summary);
  else if (!status)
    print_text(options->file, info, &summary);
  if (!status && fflush(stdout) != 0) status = status_fail(STATUS_IO, "standard output cannot be written");
  datagen_dataset_close(dataset);
  return status;
}

static const struct argp info_argp = {
    .options = info_table,
    .parser = parse_info,
    .args_doc = "FILE",
    .doc = "Say what a data set of pairs holds: who made it and how, its kinds of pairs and their volumes."};

static int run_info(int argument_count, char **arguments) {
  InfoOptions options = {0};
  argp_parse(&info_argp, argument_count, arguments, 0, NULL, &options);
  return exit_code_of(print_info(&options));
}

static const AppCommand info_command = {
    .name = "info", .help = "say what a data set holds", .argp = &info_argp, .run = run_info};

// merge

typedef struct MergeOptions {
  const char *output;
  char **files; // borrowed from the command line
  int file_count;
  bool mixes;
} MergeOptions;

static const struct argp_option merge_table[] = {
    {"output", 'o', "FILE", 0, "The file to write", 0},
    {"mix", KEY_MIX, NULL, 0, "Take files of different laws or seeds, one after another", 0},
    {0},
};

static error_t parse_merge(int key, char *text, struct argp_state *state) {
  MergeOptions *options = state->input;
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
    if (!options->output) argp_error(state, "write where? give -o FILE");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status merge(const MergeOptions *options) {
  TRY(datagen_merge((const char *const *)options->files, options->file_count, options->output,
                    options->mixes));
  log_info("wrote %s from %d files", options->output, options->file_count);
  return STATUS_OK;
}

static const struct argp merge_argp = {.options = merge_table,
                                       .parser = parse_merge,
                                       .args_doc = "FILE…",
                                       .doc = "Join the shards of a data set, or data sets, into one file."};

static int run_merge(int argument_count, char **arguments) {
  MergeOptions options = {0};
  argp_parse(&merge_argp, argument_count, arguments, 0, NULL, &options);
  return exit_code_of(merge(&options));
}

static const AppCommand merge_command = {
    .name = "merge", .help = "join shards, or data sets", .argp = &merge_argp, .run = run_merge};

// plot

typedef struct PlotOptions {
  const char *file, *output; // output NULL: beside the file
} PlotOptions;

static const struct argp_option plot_table[] = {
    {"output", 'o', "FILE", 0, "The picture (default: FILE.png)", 0},
    {0},
};

static error_t parse_plot(int key, char *text, struct argp_state *state) {
  PlotOptions *options = state->input;
  switch (key) {
  case 'o':
    options->output = text;
    return 0;
  case ARGP_KEY_ARG:
    if (options->file) argp_error(state, "'%s' is one too many: give one data set", text);
    options->file = text;
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "which data set? give a file, as in: tetlap dataset plot train.h5");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status plot(const PlotOptions *options) {
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

static const struct argp plot_argp = {
    .options = plot_table,
    .parser = parse_plot,
    .args_doc = "FILE",
    .doc = "Draw how the kinds of a data set and their volumes are distributed."};

static int run_plot(int argument_count, char **arguments) {
  PlotOptions options = {0};
  argp_parse(&plot_argp, argument_count, arguments, 0, NULL, &options);
  return exit_code_of(plot(&options));
}

static const AppCommand plot_command = {
    .name = "plot", .help = "draw its kinds and volumes", .argp = &plot_argp, .run = run_plot};

static const AppCommand *const verbs[] = {&app_command_dataset_import, &info_command, &merge_command,
                                          &plot_command, NULL};

const AppCommand app_command_dataset = {
    .name = "dataset",
    .help = "import, tell, join or draw data sets of such pairs",
    .children = verbs,
    .child_word = "verb",
    .child_of_files = "info",
    .doc = "Works on data sets of labelled pairs of tetrahedra.",
    .ending = "`tetlap dataset VERB --help` tells more; docs/data.md what the files hold.",
};
