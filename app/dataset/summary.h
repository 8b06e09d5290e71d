// SPDX-License-Identifier: GPL-3.0-or-later
// What a data set holds, counted: pairs and volumes by kind.
#ifndef TETLAP_APP_DATASET_SUMMARY_H
#define TETLAP_APP_DATASET_SUMMARY_H

#include "datagen/files/dataset.h"

// Histogram of log10 V: bins of a fiftieth of a decade from 1e-20 to 1; beyond goes to the outermost.
enum { APP_DATASET_DECADES = 20, APP_DATASET_BINS_A_DECADE = 50 };
enum { APP_DATASET_BINS = APP_DATASET_DECADES * APP_DATASET_BINS_A_DECADE };

typedef struct AppDatasetKind {
  long long count;       // pairs
  long long with_volume; // those with V > 0; the rest is about them, 0 if there are none
  double volume_min, volume_median, volume_max; // the median to a bin's width, 5 %
  long long histogram[APP_DATASET_BINS];
} AppDatasetKind;

typedef struct AppDatasetSummary {
  AppDatasetKind kinds[DATAGEN_KIND_COUNT];
} AppDatasetSummary;

// Reads the whole file, and so finds damage anywhere in it.
Status app_dataset_summarise(DatagenDataset *dataset, AppDatasetSummary *summary);

#endif
