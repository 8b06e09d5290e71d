// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of pairs as `tetlap overlap` and `tetlap dataset import` read them: text, .npy, HDF5.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/pairs/reader.h"
#include "target.h"

static const char file_name[] = "fuzz.csv";

static void check_refusal(Status status, const char *path) {
  FUZZ_CLAIM(status == STATUS_INPUT || status == STATUS_IO, "status %d: %s", (int)status, status_message());
  FUZZ_CLAIM(strstr(status_message(), path), "no path in '%s'", status_message());
}

static void check_numbers(const double *numbers, size_t count) {
  for (size_t k = 0; k < count; k++) FUZZ_CLAIM(isfinite(numbers[k]), "number %zu is %g", k, numbers[k]);
}

// What is given out is whole: finite numbers, statuses 0 and 1, places that rise.
static void check_block(const AppPairsReader *reader) {
  const AppPairsBlock *block = &reader->block;
  check_numbers(block->coordinates, APP_PAIRS_SIZE * (size_t)block->count);
  if (reader->has_volume) check_numbers(block->volume, (size_t)block->count);
  if (reader->has_gradient) check_numbers(block->gradient, APP_PAIRS_SIZE * (size_t)block->count);
  for (int i = 0; i < block->count; i++) {
    FUZZ_CLAIM(!reader->has_status || block->status[i] <= 1, "pair %d has the status %d", i,
               block->status[i]);
    FUZZ_CLAIM(i == 0 || block->places[i] > block->places[i - 1], "pair %d stands before the one before", i);
  }
}

static void read_table(const char *path, bool takes_labels) {
  AppPairsReader reader;
  Status status = app_pairs_reader_open(&reader, path, takes_labels);
  while (!status) {
    status = app_pairs_reader_next(&reader);
    if (status || reader.block.count == 0) break;
    check_block(&reader);
  }
  if (status) check_refusal(status, path);
  app_pairs_reader_close(&reader);
}

static void run(const uint8_t *data, size_t size) {
  const char *path = fuzz_target_file(file_name, data, size);
  read_table(path, false);
  read_table(path, true);
}

#define ROW "0,0,0, 1,0,0, 0,1,0, 0,0,1, .1,.1,.1, 1.1,.1,.1, .1,1.1,.1, .1,.1,1.1"
#define NAMES                                                                                                \
  "a0x,a0y,a0z,a1x,a1y,a1z,a2x,a2y,a2z,a3x,a3y,a3z,b0x,b0y,b0z,b1x,b1y,b1z,b2x,b2y,b2z,b3x,b3y,b3z"

// A .npy file: head and numbers 1, 2, 3, ….
static size_t npy_seed(const char *type, const char *shape, size_t number_size, int count, uint8_t *data) {
  memcpy(data, "\x93NUMPY\x01\x00\x76\x00", 10);
  int length =
      snprintf((char *)data + 10, 119, "{'descr': '%s', 'fortran_order': False, 'shape': %s, }", type, shape);
  memset(data + 10 + length, ' ', (size_t)(117 - length));
  data[127] = '\n';
  for (int k = 0; k < count; k++) {
    double value = k + 1;
    float narrow = (float)value;
    memcpy(data + 128 + (size_t)k * number_size, number_size == 8 ? (void *)&value : (void *)&narrow,
           number_size);
  }
  return 128 + (size_t)count * number_size;
}

static size_t seed(int k, uint8_t *data) {
  static const char *const texts[] = {
      ROW "\n" ROW "\n",
      "# two\n" ROW ",0.5\n\n" ROW ",1e-3\r\n",
      ROW ",1,0.5\n",
      "id," NAMES ",volume,status\n1," ROW ",.5,1\n",
      "0 0 0\t1 0 0  0 1 0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 1\n",
      "\xef\xbb\xbf" NAMES "\n" ROW "\n",
  };
  enum { TEXT_COUNT = sizeof texts / sizeof *texts };
  if (k < TEXT_COUNT) {
    memcpy(data, texts[k], strlen(texts[k]));
    return strlen(texts[k]);
  }
  switch (k - TEXT_COUNT) {
  case 0:
    return npy_seed("<f8", "(2, 24)", 8, 48, data);
  case 1:
    return npy_seed("<f8", "(1, 2, 4, 3)", 8, 24, data);
  case 2:
    return npy_seed(">f4", "(2, 25)", 4, 50, data);
  case 3:
    return npy_seed("<f8", "(24,)", 8, 24, data);
  default:
    return 0;
  }
}

const FuzzTarget fuzz_table = {.name = "table", .run = run, .seed = seed};
