// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets of pairs. The input is a list of edits (hdf5_edit.h) of a good file; what is read of the outcome
// keeps what datagen/files/dataset.h promises. With TETLAP_FUZZ_DAMAGE in the environment edits may also
// change bytes behind HDF5's back: what breaks then is HDF5's as a rule.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "datagen/files/dataset.h"
#include "datagen/hard.h"
#include "datagen/law/kind.h"
#include "hdf5_edit.h"
#include "target.h"

enum { PAIR_COUNT = 5, ROOM = 1 << 18 };

static const char file_name[] = "fuzz.h5";

static void fill_pairs(const DatagenPairs *pairs) {
  for (int k = 0; k < PAIR_COUNT; k++) {
    DatagenHardPair pair = datagen_hard_make(k, 0);
    memcpy(pairs->coordinates + 24 * k, pair.x, sizeof pair.x);
    pairs->status[k] = (uint8_t)(k & 1);
    pairs->kind[k] = (uint8_t)(k % DATAGEN_KIND_COUNT);
    pairs->volume[k] = k & 1 ? 0.25 : 0;
  }
}

// A good file with five pairs, made once.
static const FuzzImage *template_image(void) {
  static FuzzImage image;
  if (image.bytes) return &image;
  const char *path = fuzz_target_file(file_name, "", 0);
  DatagenInfo info = {.generator_version = DATAGEN_GENERATOR_VERSION,
                      .program = "fuzz",
                      .seed = 1,
                      .law = "mixed",
                      .label = "exact",
                      .total = PAIR_COUNT,
                      .planned = PAIR_COUNT, // small chunks: a small file
                      .has_gradient = true};
  DatagenWriter *writer;
  DatagenPairs pairs;
  FUZZ_CLAIM(datagen_pairs_create(&pairs, PAIR_COUNT, true) == STATUS_OK, "%s", status_message());
  fill_pairs(&pairs);
  Status status = datagen_dataset_writer_begin(&writer, path, &info);
  if (!status) status = datagen_dataset_writer_append(writer, &pairs, PAIR_COUNT, NULL);
  if (!status) status = datagen_dataset_writer_commit(writer);
  FUZZ_CLAIM(status == STATUS_OK, "%s", status_message());
  datagen_pairs_destroy(&pairs);
  image.bytes = malloc(ROOM);
  FUZZ_CLAIM(image.bytes, "no memory");
  image.size = fuzz_target_read(path, image.bytes, ROOM);
  FUZZ_CLAIM(image.size, "the good file is too large");
  return &image;
}

static void check_refusal(Status status, const char *path) {
  FUZZ_CLAIM(status == STATUS_INPUT, "status %d: %s", (int)status, status_message());
  FUZZ_CLAIM(strstr(status_message(), path), "no path in '%s'", status_message());
}

static void check_pair(const DatagenPairs *pairs, size_t i) {
  for (int c = 0; c < 24; c++)
    FUZZ_CLAIM(isfinite(pairs->coordinates[24 * i + (size_t)c]), "coordinate %d", c);
  FUZZ_CLAIM(pairs->status[i] <= 1 && pairs->kind[i] < DATAGEN_KIND_COUNT, "status %d, kind %d",
             pairs->status[i], pairs->kind[i]);
  FUZZ_CLAIM(pairs->volume[i] >= 0 && isfinite(pairs->volume[i]), "V = %g", pairs->volume[i]);
}

static void read_all(DatagenDataset *dataset, const char *path) {
  enum { MOST = 64 };
  const DatagenInfo *info = datagen_dataset_info(dataset);
  FUZZ_CLAIM(info->count >= 0 && info->first >= 0, "%lld pairs from %lld", info->count, info->first);
  FUZZ_CLAIM(memchr(info->program, 0, sizeof info->program) && memchr(info->law, 0, sizeof info->law) &&
                 memchr(info->mix, 0, sizeof info->mix) && memchr(info->label, 0, sizeof info->label) &&
                 memchr(info->volume_law, 0, sizeof info->volume_law),
             "a text without an end");
  size_t count = info->count < MOST ? (size_t)info->count : MOST;
  DatagenPairs pairs;
  FUZZ_CLAIM(datagen_pairs_create(&pairs, count, info->has_gradient) == STATUS_OK, "%s", status_message());
  Status status = datagen_dataset_read(dataset, 0, count, &pairs);
  if (status) check_refusal(status, path);
  for (size_t i = 0; i < count && !status; i++) check_pair(&pairs, i);
  status = datagen_dataset_read(dataset, info->count, 1, &pairs);
  FUZZ_CLAIM(status == STATUS_INPUT, "a pair beyond the end: status %d", (int)status);
  datagen_pairs_destroy(&pairs);
}

static void run(const uint8_t *data, size_t size) {
  const FuzzImage *good = template_image();
  if (fuzz_hdf5_has_damage(data, size) && !getenv("TETLAP_FUZZ_DAMAGE")) return;
  FuzzImage image = fuzz_hdf5_edit(good->bytes, good->size, data, size);
  const char *path = fuzz_target_file(file_name, image.bytes, image.size);
  DatagenDataset *dataset;
  Status status = datagen_dataset_open(&dataset, path);
  if (status)
    check_refusal(status, path);
  else
    read_all(dataset, path);
  datagen_dataset_close(dataset);
  free(image.bytes);
}

const FuzzTarget fuzz_dataset = {
    .name = "dataset", .run = run, .seed = fuzz_hdf5_seed, .mutate = fuzz_hdf5_mutate};
