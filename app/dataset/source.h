// SPDX-License-Identifier: GPL-3.0-or-later
// Where labelled pairs come from, for training and evaluation: a data set's file, or a law that makes them on
// the fly.
#ifndef TETLAP_APP_DATASET_SOURCE_H
#define TETLAP_APP_DATASET_SOURCE_H

#include <stdint.h>

#include "datagen/files/dataset.h"
#include "datagen/law/plan.h"

// Texts are borrowed; NULL where they are not given.
typedef struct AppSourceDef {
  const char *name;   // in tables and plots; may be NULL
  const char *file;   // a data set, or
  const char *law;    // the law's name,
  const char *mix;    // its shares of kinds and
  const char *volume; // its law of volumes, if they are to be others
  long long count;    // pairs; 0: all of the file, the law's default
  uint64_t seed;      // of the law
  double swap;        // share of the law's pairs whose tetrahedra are exchanged; 0: the law's own
} AppSourceDef;

typedef struct AppSource {
  DatagenDataset *dataset; // owned; NULL: made by the plan
  DatagenPlan plan;
  long long count;   // pairs that there are
  bool has_gradient; // each pair comes with ∇V
  bool has_centroid; // and with x̄
} AppSource;

// A law's pairs are labelled by clipping, checked, with ∇V if `wants_gradient`. A file without ∇V is opened
// all the same: look at `has_gradient`. Close it; a zeroed one is accepted.
Status app_dataset_source_open(AppSource *source, const AppSourceDef *def, bool wants_gradient);
void app_dataset_source_close(AppSource *source);

// Pairs `first` … `first` + `count` − 1 into arrays of the caller's; gradient and centroid may be NULL, and
// are made by clipping where the file has none.
Status app_dataset_source_read(AppSource *source, long long first, size_t count, const DatagenPairs *pairs);

// All pairs at once, into arrays that the caller destroys (datagen_pairs_destroy); with ∇V in any case.
Status app_dataset_source_load(const AppSourceDef *def, DatagenPairs *pairs, size_t *count);

// The law, or the file, in words: "law scene, mix scene=1, seed 7, 1000 pairs".
void app_dataset_source_describe(const AppSourceDef *def, const AppSource *source, char *text, size_t size);

// Whether the pairs are of the paper's test law, unchanged.
bool app_dataset_source_is_paper(const AppSourceDef *def, const AppSource *source);

#endif
