// SPDX-License-Identifier: GPL-3.0-or-later
// The file that pairs are kept in: HDF5, read by h5py, MATLAB, Julia as it is.
//
//   /coordinates (n, 2, 4, 3) float64     attributes of the root: what DatagenInfo holds, and
//   /status      (n)          uint8       format       "tetlap pairs"
//   /kind        (n)          uint8       kinds        the kinds' names in the order of their codes
//   /volume      (n)          float64     units        in words
//   /gradient    (n, 2, 4, 3) float64, if wanted
//   /centroid    (n, 3)       float64; files of programs before 0.2 have none
//
// Chunks of 4096 pairs, each with a checksum (Fletcher 32): damage is found when a chunk is read. Files
// appear whole or not at all: they grow beside their place and are renamed. Not safe to call from two threads
// at once.
#ifndef TETLAP_DATAGEN_FILES_DATASET_H
#define TETLAP_DATAGEN_FILES_DATASET_H

#include <stdint.h>

#include "datagen/law/law.h"
#include "datagen/law/plan.h"
#include "datagen/pairs.h"

enum { DATAGEN_DATASET_CHUNK = 4096, DATAGEN_NAME_TEXT = 32, DATAGEN_PROGRAM_TEXT = 64 };

typedef struct DatagenInfo {
  long long generator_version;        // DATAGEN_GENERATOR_VERSION of the program that made it
  char program[DATAGEN_PROGRAM_TEXT]; // "tetlap 0.1.0"
  uint64_t seed;
  char law[DATAGEN_NAME_TEXT]; // the law's name; "mixed" after a merge of different ones
  char mix[DATAGEN_MIX_TEXT];  // as datagen_law_parse_mix reads it
  char volume_law[DATAGEN_VOLUME_TEXT];
  double swap_share;
  char label[DATAGEN_NAME_TEXT]; // "exact", "clip": what V and ∇V were computed with
  long long total;               // pairs of the data set that this file is all or a range of
  long long first;               // index of its first pair there
  long long planned;             // pairs that it should hold; more than `count` if it was interrupted
  long long count;               // pairs that it holds
  bool has_gradient, has_centroid;
  long long kind_counts[DATAGEN_KIND_COUNT]; // of the pairs that it holds
  long long attempts[DATAGEN_KIND_COUNT];    // candidates drawn for them
} DatagenInfo;

// What a file with the pairs `first` … `first` + `planned` − 1 of the plan says of itself; none held yet.
DatagenInfo datagen_dataset_info_of_plan(const DatagenPlan *plan, const char *program, long long first,
                                         long long planned);

typedef struct DatagenWriter DatagenWriter; // opaque: HDF5 hides behind it

// Begins a file beside `path`. STATUS_IO: the reason. Of `info`, count, kind_counts and attempts are counted
// anew; planned 0: as many as will be appended, which are the whole.
Status datagen_dataset_writer_begin(DatagenWriter **writer, const char *path, const DatagenInfo *info);
// Appends `count` pairs; all arrays (gradient and centroid only if the file has them) are read. `attempts` by
// kind, may be NULL. Flushed when it returns. STATUS_INPUT: a pair is impossible (see datagen_dataset_read),
// nothing of the batch is kept.
Status datagen_dataset_writer_append(DatagenWriter *writer, const DatagenPairs *pairs, size_t count,
                                     const long long *attempts);
long long datagen_dataset_writer_count(const DatagenWriter *writer); // pairs appended so far
// Puts the file into its place. The writer is gone, whatever the outcome; on failure nothing is left.
Status datagen_dataset_writer_commit(DatagenWriter *writer);
// Drops what was written; NULL is accepted.
void datagen_dataset_writer_abandon(DatagenWriter *writer);

typedef struct DatagenDataset DatagenDataset; // opaque

// Opens a file to read. STATUS_IO: it cannot be opened. STATUS_INPUT: it is not a data set of pairs, is cut
// short, is newer than this program, or contradicts itself; the message names the file and what is wrong.
Status datagen_dataset_open(DatagenDataset **dataset, const char *path);
// Valid until the data set is closed.
const DatagenInfo *datagen_dataset_info(const DatagenDataset *dataset);
// Reads pairs `first` … `first` + `count` − 1 into the arrays that are not NULL; a file without centroids
// leaves theirs as they are. STATUS_INPUT: the range goes beyond the file, a chunk is damaged, or a pair is
// impossible (NaN, an unknown kind, V > 0 without contact); the message names the pair.
Status datagen_dataset_read(DatagenDataset *dataset, long long first, size_t count,
                            const DatagenPairs *pairs);
void datagen_dataset_close(DatagenDataset *dataset); // NULL is accepted

#endif
