// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs from a run, as a data set to fine-tune on and to judge by: what a scene's contact may ask an overlap
// model, near misses included. Those that share nothing are of the kind SCENE_NONE, the others CAPTURED.
#ifndef TETLAP_DATAGEN_CAPTURE_H
#define TETLAP_DATAGEN_CAPTURE_H

#include "datagen/files/dataset.h"

typedef struct DatagenCapture {
  DatagenWriter *writer; // owned
  DatagenLabel label;
  DatagenPairs pairs; // a block of them, owned
  long long apart;    // pairs so far that share nothing
  long long flat;     // pairs that were left out because a tetrahedron had no volume
} DatagenCapture;

// Begins the file at `path`, with the law "captured" and gradients. `program` as in DatagenInfo.
Status datagen_capture_begin(DatagenCapture *capture, const char *path, const char *program,
                             DatagenLabel label);
// Adds pairs (count, 2, 4, 3) in metres, finite: each is scaled and moved into the unit cube (draw/cube.h),
// proven and labelled there, over OpenMP threads. Rounding in the move may part, or press together, what
// touched.
Status datagen_capture_append(DatagenCapture *capture, const double *pairs, int count);
// Puts the file into its place; without pairs there is none. The capture is destroyed, whatever the outcome.
long long datagen_capture_count(const DatagenCapture *capture); // pairs so far
Status datagen_capture_commit(DatagenCapture *capture);

#endif
