// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "app/cli/parse.h"
#include "app/pairs/npy.h"
#include "base/files/file.h"
#include "base/log.h"
#include "datagen/files/dataset.h"

enum { MOST_TYPE = 256 };

typedef struct Options {
  const char *file, *output;
  long long first, count; // count −1: to the end
} Options;

static const AppOption option_table[] = {
    {"count", 'n', "N", "Pairs (default: all that follow)", 0, CLI_INTEGER, CLI_TO(Options, count), 0,
     INFINITY},
    {"first", 0, "I", "The first of them, counted from 0 (default: 0)", 0, CLI_INTEGER,
     CLI_TO(Options, first), 0, INFINITY},
    {"output", 'o', "FILE.npy", "The file to write", 0, CLI_TEXT, CLI_TO(Options, output)},
    {0},
};

static void write_head(FILE *stream, const DatagenInfo *info, long long count) {
  const char order = app_pairs_npy_order();
  char type[MOST_TYPE], gradient[48] = "", centroid[48] = "";
  if (info->has_gradient) snprintf(gradient, sizeof gradient, ", ('gradient', '%cf8', (2, 4, 3))", order);
  if (info->has_centroid) snprintf(centroid, sizeof centroid, ", ('centroid', '%cf8', (3,))", order);
  snprintf(type, sizeof type,
           "[('coordinates', '%cf8', (2, 4, 3)), ('status', 'u1'), ('kind', 'u1'), ('volume', '%cf8')%s%s]",
           order, order, gradient, centroid);
  app_pairs_npy_write_head(stream, type, count);
}

static void write_records(FILE *stream, const DatagenInfo *info, const DatagenPairs *pairs, size_t count) {
  for (size_t i = 0; i < count; i++) {
    fwrite(pairs->coordinates + 24 * i, sizeof(double), 24, stream);
    fwrite(pairs->status + i, 1, 1, stream);
    fwrite(pairs->kind + i, 1, 1, stream);
    fwrite(pairs->volume + i, sizeof(double), 1, stream);
    if (info->has_gradient) fwrite(pairs->gradient + 24 * i, sizeof(double), 24, stream);
    if (info->has_centroid) fwrite(pairs->centroid + 3 * i, sizeof(double), 3, stream);
  }
}

static Status write_pairs(FILE *stream, DatagenDataset *dataset, long long first, long long count) {
  const DatagenInfo *info = datagen_dataset_info(dataset);
  DatagenPairs pairs;
  TRY(datagen_pairs_create(&pairs, DATAGEN_DATASET_CHUNK, info->has_gradient));
  Status status = STATUS_OK;
  write_head(stream, info, count);
  for (long long done = 0; !status && done < count;) {
    size_t size = count - done < DATAGEN_DATASET_CHUNK ? (size_t)(count - done) : DATAGEN_DATASET_CHUNK;
    status = datagen_dataset_read(dataset, first + done, size, &pairs);
    if (!status) write_records(stream, info, &pairs, size);
    done += (long long)size;
  }
  datagen_pairs_destroy(&pairs);
  return status;
}

static Status export_range(const Options *options, DatagenDataset *dataset) {
  long long there = datagen_dataset_info(dataset)->count;
  long long count = options->count >= 0 ? options->count : there - options->first;
  if (options->first > there || count > there - options->first)
    return status_fail(STATUS_USAGE, "%s: has %lld pairs; %lld from pair %lld on are not there",
                       options->file, there, options->count >= 0 ? count : 0, options->first);
  FileWriter file;
  TRY(file_begin(&file, options->output));
  Status status = write_pairs(file.stream, dataset, options->first, count);
  if (!status) status = file_commit(&file);
  file_abandon(&file);
  if (!status) log_info("wrote %lld pairs to %s", count, options->output);
  return status;
}

static Status export_pairs(const Options *options) {
  DatagenDataset *dataset;
  TRY(datagen_dataset_open(&dataset, options->file));
  Status status = export_range(options, dataset);
  datagen_dataset_close(dataset);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const char *output = ((const Options *)given)->output, *dot = output ? strrchr(output, '.') : NULL;
  if (!dot || strcasecmp(dot, ".npy") != 0) argp_error(state, "name the file to write, as in -o pairs.npy");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.count = -1};
  app_cli_parse(&app_command_dataset_export, argument_count, arguments, &options);
  return app_cli_command_end(export_pairs(&options));
}

const AppCommand app_command_dataset_export = {
    .name = "export",
    .help = "write a data set as a NumPy array",
    .options = option_table,
    .arguments =
        &(const AppArguments){"FILE", offsetof(Options, file), 1,
                              .missing = "which data set? as in: tetlap dataset export train.h5 -o train.npy",
                              .excess = "'%s' is one argument too many: give one data set"},
    .doc = "Write a data set as a NumPy array of records, with the fields coordinates, "
           "status, kind, volume, and gradient and centroid if the data set has them.",
    .check = check,
    .run = run_command};
