// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/files/merge.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "datagen/files/dataset.h"

enum { BLOCK = 16384 };

typedef struct Part {
  const char *path; // borrowed
  DatagenDataset *dataset;
} Part;

static const DatagenInfo *info_of(const Part *part) {
  return datagen_dataset_info(part->dataset);
}

static int compare_parts(const void *a, const void *b) {
  long long first = info_of(a)->first, second = info_of(b)->first;
  return (first > second) - (first < second);
}

// In what two files are not of one plan; NULL: they are.
static const char *find_difference(const DatagenInfo *a, const DatagenInfo *b) {
  if (a->generator_version != b->generator_version) return "the generator's version";
  if (strcmp(a->law, b->law) != 0) return "the law";
  if (strcmp(a->mix, b->mix) != 0) return "the mix";
  if (strcmp(a->volume_law, b->volume_law) != 0) return "the volume law";
  if (a->swap_share != b->swap_share) return "the share of swapped pairs";
  if (a->seed != b->seed) return "the seed";
  if (a->total != b->total) return "the number of pairs in all";
  if (strcmp(a->label, b->label) != 0) return "the model of the labels";
  if (a->has_gradient != b->has_gradient) return "whether they have gradients";
  if (a->has_centroid != b->has_centroid) return "whether they have centroids";
  return NULL;
}

// Sorted by their first pairs, the parts must follow one another.
static Status check_sequence(Part *parts, int count) {
  qsort(parts, (size_t)count, sizeof *parts, compare_parts);
  for (int p = 1; p < count; p++) {
    const DatagenInfo *before = info_of(&parts[p - 1]), *now = info_of(&parts[p]);
    const char *difference = find_difference(before, now);
    if (difference)
      return status_fail(
          STATUS_INPUT,
          "%s and %s are not shards of one data set: they differ in %s; --mix merges them nevertheless",
          parts[p - 1].path, parts[p].path, difference);
    long long expected = before->first + before->count;
    if (now->first < expected)
      return status_fail(STATUS_INPUT, "%s and %s both hold pair %lld; give each shard once",
                         parts[p - 1].path, parts[p].path, now->first);
    if (now->first > expected)
      return status_fail(STATUS_INPUT, "pairs %lld to %lld are missing between %s and %s: %s", expected,
                         now->first - 1, parts[p - 1].path, parts[p].path,
                         before->count < before->planned ? "the former was interrupted" : "give all shards");
  }
  return STATUS_OK;
}

static DatagenInfo joined_info(const Part *parts, int count) {
  const DatagenInfo *last = info_of(&parts[count - 1]);
  DatagenInfo info = *info_of(&parts[0]);
  info.planned = last->first + last->planned - info.first;
  return info;
}

static DatagenInfo mixed_info(const Part *parts, int count) {
  DatagenInfo info = *info_of(&parts[0]);
  info.total = info.first = info.planned = 0;
  info.seed = 0;
  info.swap_share = 0;
  snprintf(info.law, sizeof info.law, "mixed");
  snprintf(info.mix, sizeof info.mix, "mixed");
  snprintf(info.volume_law, sizeof info.volume_law, "mixed");
  for (int p = 0; p < count; p++) {
    const DatagenInfo *part = info_of(&parts[p]);
    info.planned += part->count;
    info.has_gradient = info.has_gradient && part->has_gradient;
    info.has_centroid = info.has_centroid && part->has_centroid;
    if (strcmp(info.label, part->label) != 0) snprintf(info.label, sizeof info.label, "mixed");
  }
  info.total = info.planned;
  return info;
}

static Status copy_part(const Part *part, DatagenWriter *writer, const DatagenPairs *pairs) {
  const DatagenInfo *info = info_of(part);
  for (long long done = 0; done < info->count;) {
    long long left = info->count - done;
    size_t count = left < BLOCK ? (size_t)left : BLOCK;
    TRY(datagen_dataset_read(part->dataset, done, count, pairs));
    TRY(datagen_dataset_writer_append(writer, pairs, count, done == 0 ? info->attempts : NULL));
    done += (long long)count;
  }
  return STATUS_OK;
}

static Status write_parts(const Part *parts, int count, const char *output, const DatagenInfo *info) {
  DatagenPairs pairs;
  DatagenWriter *writer;
  TRY(datagen_pairs_create(&pairs, BLOCK, info->has_gradient));
  Status status = datagen_dataset_writer_begin(&writer, output, info);
  if (!status) {
    for (int p = 0; p < count && !status; p++) status = copy_part(&parts[p], writer, &pairs);
    if (status)
      datagen_dataset_writer_abandon(writer);
    else
      status = datagen_dataset_writer_commit(writer);
  }
  datagen_pairs_destroy(&pairs);
  return status;
}

Status datagen_merge(const char *const *paths, int count, const char *output, bool mixes) {
  Part *parts = memory_zeroed((size_t)count, sizeof *parts);
  if (!parts) return status_no_memory("the list of files");
  Status status = STATUS_OK;
  for (int p = 0; p < count && !status; p++) {
    parts[p].path = paths[p];
    status = datagen_dataset_open(&parts[p].dataset, paths[p]);
  }
  if (!status && !mixes) status = check_sequence(parts, count);
  if (!status) {
    DatagenInfo info = mixes ? mixed_info(parts, count) : joined_info(parts, count);
    status = write_parts(parts, count, output, &info);
  }
  for (int p = 0; p < count; p++) datagen_dataset_close(parts[p].dataset);
  memory_free(parts);
  return status;
}
