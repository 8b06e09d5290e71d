// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/dataset.h"

#include <argp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app/dataset/plot.h"
#include "app/dataset/summary.h"
#include "base/log.h"
#include "base/record.h"
#include "datagen/dataset.h"
#include "datagen/merge.h"

enum { MAX_FILES = 65536, KEY_MIX = 256 };

typedef struct Options {
  const char *verb, *output;
  char **files; // borrowed from the command line
  int file_count;
  bool is_json, mixes;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0, "merge: the file to write; plot: the picture (default: FILE.png)", 0},
    {"mix", KEY_MIX, NULL, 0, "merge: take files of different laws or seeds, one after another", 0},
    {"json", 'j', NULL, 0, "info: print JSON", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->output = text;
    return 0;
  case 'j':
    options->is_json = true;
    return 0;
  case KEY_MIX:
    options->mixes = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->verb) return ARGP_ERR_UNKNOWN; // the rest are files
    options->verb = text;
    return 0;
  case ARGP_KEY_ARGS:
    options->files = state->argv + state->next;
    options->file_count = state->argc - state->next;
    state->next = state->argc;
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
  printf("  labels       %s, %s\n", info->label, info->has_gradient ? "V and its gradient" : "V");
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

static Status run_info(const Options *options) {
  if (options->file_count != 1)
    return status_fail(STATUS_USAGE, "give one file, as in: tetlap dataset info train.h5");
  DatagenDataset *dataset;
  AppDatasetSummary summary;
  TRY(datagen_dataset_open(&dataset, options->files[0]));
  const DatagenInfo *info = datagen_dataset_info(dataset);
  Status status = app_dataset_summarise(dataset, &summary);
  if (!status && options->is_json)
    status = print_json(options->files[0], info, &summary);
  else if (!status)
    print_text(options->files[0], info, &summary);
  if (!status && fflush(stdout) != 0) status = status_fail(STATUS_IO, "standard output cannot be written");
  datagen_dataset_close(dataset);
  return status;
}

static Status run_merge(const Options *options) {
  if (!options->output) return status_fail(STATUS_USAGE, "write where? Give -o FILE");
  if (options->file_count < 1 || options->file_count > MAX_FILES)
    return status_fail(STATUS_USAGE,
                       "give the files to merge, as in: tetlap dataset merge part-*.h5 -o all.h5");
  TRY(datagen_merge((const char *const *)options->files, options->file_count, options->output,
                    options->mixes));
  log_info("wrote %s from %d files", options->output, options->file_count);
  return STATUS_OK;
}

static Status run_plot(const Options *options) {
  if (options->file_count != 1)
    return status_fail(STATUS_USAGE, "give one file, as in: tetlap dataset plot train.h5");
  char picture[4096];
  int length = options->output ? snprintf(picture, sizeof picture, "%s", options->output)
                               : snprintf(picture, sizeof picture, "%s.png", options->files[0]);
  if (length >= (int)sizeof picture) return status_fail(STATUS_USAGE, "the picture's name is too long");
  DatagenDataset *dataset;
  TRY(datagen_dataset_open(&dataset, options->files[0]));
  Status status = app_dataset_plot(dataset, options->files[0], picture);
  datagen_dataset_close(dataset);
  if (!status) log_info("wrote %s and its script %s.gp", picture, picture);
  return status;
}

static Status run_verb(const Options *options) {
  static const struct {
    const char *name;
    Status (*run)(const Options *options);
  } verbs[] = {{"info", run_info}, {"merge", run_merge}, {"plot", run_plot}};
  for (size_t k = 0; options->verb && k < sizeof verbs / sizeof *verbs; k++)
    if (strcmp(verbs[k].name, options->verb) == 0) return verbs[k].run(options);
  if (!options->verb) return status_fail(STATUS_USAGE, "do what? There are: info, merge, plot");
  return status_fail(STATUS_USAGE, "cannot '%s' a data set; there are: info, merge, plot", options->verb);
}

int app_dataset_run(int argument_count, char **arguments) {
  static const struct argp argp = {
      .options = option_table,
      .parser = parse,
      .args_doc = "info FILE\nmerge FILE… -o FILE\nplot FILE",
      .doc =
          "Say what a data set of pairs holds, join shards, or draw how kinds and volumes are distributed."};
  Options options = {0};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  Status status = run_verb(&options);
  if (status) log_error("%s", status_message());
  return status_exit_code(status);
}
