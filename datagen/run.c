// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/run.h"

#include <stdbool.h>

#include "datagen/files/dataset.h"
#include "datagen/generate.h"

static bool is_told_to_stop(const DatagenRunOptions *options) {
  return options->stop && *options->stop;
}

// Pairs first + done …, at most a block of them; moves `*done`.
static Status add_block(const DatagenPlan *plan, const DatagenRunOptions *options, DatagenWriter *writer,
                        const DatagenPairs *pairs, int block, long long *done) {
  long long left = options->count - *done, attempts[DATAGEN_KIND_COUNT] = {0};
  int count = left < block ? (int)left : block;
  TRY(datagen_generate(plan, options->first + *done, count, pairs, attempts));
  TRY(datagen_dataset_writer_append(writer, pairs, (size_t)count, attempts));
  *done += count;
  if (options->observe) options->observe(options->observer, &(DatagenProgress){*done, options->count});
  return STATUS_OK;
}

static Status add_blocks(const DatagenPlan *plan, const DatagenRunOptions *options, DatagenWriter *writer,
                         const DatagenPairs *pairs, int block) {
  long long done = 0;
  while (done < options->count && !is_told_to_stop(options))
    TRY(add_block(plan, options, writer, pairs, block, &done));
  if (done == options->count) return STATUS_OK;
  if (done == 0) return status_fail(STATUS_INTERRUPTED, "stopped before the first pairs; nothing is kept");
  return status_fail(STATUS_INTERRUPTED, "stopped: %s holds %lld of %lld pairs", options->path, done,
                     options->count);
}

// Ends the file according to how the blocks ended. Stopped with something in it counts as an end, too.
static Status end_file(DatagenWriter *writer, Status status, bool has_pairs) {
  if (status == STATUS_OK) return datagen_dataset_writer_commit(writer);
  if (status != STATUS_INTERRUPTED || !has_pairs) {
    datagen_dataset_writer_abandon(writer);
    return status;
  }
  Status committed = datagen_dataset_writer_commit(writer);
  return committed ? committed : status;
}

Status datagen_run(const DatagenPlan *plan, const DatagenRunOptions *options) {
  const int block = options->block > 0 ? options->block : DATAGEN_RUN_BLOCK;
  DatagenPairs pairs;
  DatagenWriter *writer;
  TRY(datagen_pairs_create(&pairs, (size_t)block, plan->wants_gradient));
  DatagenInfo info = datagen_dataset_info_of_plan(plan, options->program, options->first, options->count);
  Status status = datagen_dataset_writer_begin(&writer, options->path, &info);
  if (!status) {
    status = add_blocks(plan, options, writer, &pairs, block);
    status = end_file(writer, status, datagen_dataset_writer_count(writer) > 0);
  }
  datagen_pairs_destroy(&pairs);
  return status;
}
