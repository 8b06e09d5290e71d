// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinates of pairs in an HDF5 file of any origin: an array of floating point numbers, 24 for each pair,
// in the root group. Which array: `coordinates`, else `pairs`, else the only one there is. Not safe to call
// from two threads at once.
#ifndef TETLAP_DATAGEN_FILES_ARRAY_H
#define TETLAP_DATAGEN_FILES_ARRAY_H

#include <stddef.h>

#include "base/status.h"

typedef struct DatagenArray DatagenArray; // opaque: HDF5 hides behind it

// STATUS_IO: the file cannot be opened. STATUS_INPUT: there is no such array; the message names the file and
// what is expected.
Status datagen_array_open(DatagenArray **array, const char *path);
long long datagen_array_count(const DatagenArray *array); // pairs
// Pairs `first` … `first` + `count` − 1 into `coordinates` (count, 24). STATUS_INPUT: they cannot be read, or
// a number is not finite.
Status datagen_array_read(DatagenArray *array, long long first, size_t count, double *coordinates);
void datagen_array_close(DatagenArray *array); // NULL is accepted

#endif
