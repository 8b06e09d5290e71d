// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdbool.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "app/dataset/summary.h"
#include "base/files/record.h"
#include "datagen/files/dataset.h"

typedef struct Options {
  const char *file;
  bool is_json;
} Options;

static const AppOption option_table[] = {
    {"json", 'j', NULL, "Print JSON", 0, CLI_FLAG, CLI_TO(Options, is_json)},
    {0},
};

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

static Status print_info(const Options *options) {
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

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_dataset_info, argument_count, arguments, &options);
  return app_cli_command_end(print_info(&options));
}

const AppCommand app_command_dataset_info = {
    .name = "info",
    .help = "say what a data set holds",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE", offsetof(Options, file), 1,
                              .missing = "which data set? give a file, as in: tetlap dataset info train.h5",
                              .excess = "'%s' is one argument too many: give one data set"},
    .doc = "Say what a data set of pairs holds: its origin, its kinds of pairs and their volumes.",
    .run = run_command};
