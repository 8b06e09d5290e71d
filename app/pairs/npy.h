// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy's files of one array (NEP 1, "A Simple File Format for NumPy Arrays", versions 1 to 3): reading those
// of floating point numbers, row by row; the head of those that we write.
#ifndef TETLAP_APP_PAIRS_NPY_H
#define TETLAP_APP_PAIRS_NPY_H

#include <stdbool.h>
#include <stdio.h>

#include "base/status.h"

enum { APP_PAIRS_NPY_MAGIC = 6 };
extern const char app_pairs_npy_magic[APP_PAIRS_NPY_MAGIC];

typedef struct AppPairsNpy {
  FILE *stream;        // borrowed, behind the head
  const char *name;    // the file's, for messages; borrowed
  long long row_count; // the first of the array's lengths
  int row_size;        // the product of the others: numbers in a row
  int number_size;     // bytes: 4 or 8
  bool is_swapped;     // the other order of bytes than this machine's
  long long next;      // the row that is read next
} AppPairsNpy;

// Reads the head. STATUS_INPUT: it is none, or the array is none that can be read; the message says what
// would make it one.
Status app_pairs_npy_open(AppPairsNpy *npy, FILE *stream, const char *name);

// The next row into `row` (row_size); the caller counts them. STATUS_INPUT: the file ends, or a number is not
// finite; the message names row and place, both from 0 as NumPy counts.
Status app_pairs_npy_read(AppPairsNpy *npy, double *row);

// Writes a head for `count` records of `type`, as in "[('volume', '<f8')]", at the stream's place. Its size
// is the same for every count.
void app_pairs_npy_write_head(FILE *stream, const char *type, long long count);

// '<' or '>': how this machine orders bytes.
char app_pairs_npy_order(void);

#endif
