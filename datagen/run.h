// SPDX-License-Identifier: GPL-3.0-or-later
// Making a data set file: block by block, with progress, until done or told to stop.
#ifndef TETLAP_DATAGEN_RUN_H
#define TETLAP_DATAGEN_RUN_H

#include <signal.h>

#include "datagen/law/plan.h"

enum { DATAGEN_RUN_BLOCK = 16384 }; // a multiple of the file's chunks

typedef struct DatagenProgress {
  long long done, planned; // pairs
} DatagenProgress;

typedef struct DatagenRunOptions {
  const char *path;                  // where the file appears
  const char *program;               // name and version of the program, for the file
  long long first, count;            // the range of the plan's pairs; a shard, or all
  int block;                         // pairs made between two looks at `stop`; 0: DATAGEN_RUN_BLOCK
  const volatile sig_atomic_t *stop; // may be NULL; not 0: stop after the block in progress
  void (*observe)(void *observer, const DatagenProgress *progress); // after each block; may be NULL
  void *observer;
} DatagenRunOptions;

// STATUS_INTERRUPTED: told to stop; the blocks that were whole are in the file, which says how many pairs
// were planned; without any block there is no file. Other failures leave no file.
Status datagen_run(const DatagenPlan *plan, const DatagenRunOptions *options);

#endif
