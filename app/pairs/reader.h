// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of tetrahedra from a file, a block at a time: text (csv.h), NumPy's .npy (npy.h), or a data set
// (.h5). Which it is, its first bytes say, not its name.
#ifndef TETLAP_APP_PAIRS_READER_H
#define TETLAP_APP_PAIRS_READER_H

#include <stdint.h>

#include "app/pairs/columns.h"
#include "app/pairs/csv.h"
#include "app/pairs/npy.h"
#include "datagen/files/array.h"
#include "datagen/files/dataset.h"

typedef enum AppPairsFormat {
  APP_PAIRS_CSV,
  APP_PAIRS_NPY,
  APP_PAIRS_DATASET,
  APP_PAIRS_ARRAY
} AppPairsFormat;

enum { APP_PAIRS_BLOCK = 16384 };

// A block of pairs; what a file has no label for is not read.
typedef struct AppPairsBlock {
  int count;
  double *coordinates; // (APP_PAIRS_BLOCK, 2, 4, 3)
  uint8_t *status;     // 0, 1                                              (APP_PAIRS_BLOCK)
  double *volume;      //                                                   (APP_PAIRS_BLOCK)
  double *gradient;    //                                                   (APP_PAIRS_BLOCK, 2, 4, 3)
  long long *places;   // where in the file: a line, from 1; a row, from 0  (APP_PAIRS_BLOCK)
} AppPairsBlock;

typedef struct AppPairsReader {
  const char *name; // of the file, borrowed; "standard input"
  AppPairsFormat format;
  FILE *stream; // NULL: HDF5
  bool is_owned;
  AppPairsCsv csv;
  AppPairsNpy npy;
  DatagenDataset *dataset;
  DatagenArray *array;
  AppPairsColumns columns;
  int column_count;
  long long done; // pairs read so far
  bool has_status, has_volume, has_gradient;
  AppPairsBlock block; // the last one read, owned
} AppPairsReader;

// Opens the file, "-": standard input. `takes_labels`: columns without names may hold labels. Close it,
// whatever happens. STATUS_IO, STATUS_INPUT: the message names the file and the line.
Status app_pairs_reader_open(AppPairsReader *reader, const char *path, bool takes_labels);

// Reads the next block into `reader->block`; its count is 0 at the end. STATUS_INPUT: file, line and column;
// a file without pairs.
Status app_pairs_reader_next(AppPairsReader *reader);

// What a place of this file is called: "line", "row", "pair".
const char *app_pairs_reader_place_word(const AppPairsReader *reader);

void app_pairs_reader_close(AppPairsReader *reader); // a zeroed one is accepted

#endif
