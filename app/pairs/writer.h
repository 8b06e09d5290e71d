// SPDX-License-Identifier: GPL-3.0-or-later
// The results of an overlap model for pairs, as text (a line a pair, a header), JSON (an object a line), or
// NumPy's .npy. That has a record a pair, with fields volume, gradient, centroid, flags.
#ifndef TETLAP_APP_PAIRS_WRITER_H
#define TETLAP_APP_PAIRS_WRITER_H

#include <stdbool.h>

#include "base/files/file.h"
#include "overlap/ops.h"

typedef enum AppPairsForm { APP_PAIRS_FORM_CSV, APP_PAIRS_FORM_JSON, APP_PAIRS_FORM_NPY } AppPairsForm;

typedef struct AppPairsWriter {
  AppPairsForm form;
  bool has_gradient;
  FILE *stream;
  FileWriter file; // zero: standard output
  long long count; // pairs written
} AppPairsWriter;

// By the file's name: .csv, .json and .jsonl, .npy. STATUS_USAGE: another one.
Status app_pairs_writer_form(const char *path, AppPairsForm *form);

// `path` NULL: standard output. STATUS_USAGE: .npy there, whose head has a number that is known only at the
// end.
Status app_pairs_writer_open(AppPairsWriter *writer, const char *path, AppPairsForm form, bool has_gradient);
// Of a batch with volumes, centroids and flags, and gradients if they are to be written.
void app_pairs_writer_append(AppPairsWriter *writer, const OverlapBatch *batch);
// Puts the file into its place. STATUS_IO.
Status app_pairs_writer_commit(AppPairsWriter *writer);
void app_pairs_writer_abandon(AppPairsWriter *writer); // allowed after a commit

#endif
