// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/dataset/summary.h"

#include <math.h>
#include <string.h>

enum { BLOCK = 16384 };

static int bin_of(double volume) {
  double place = (log10(volume) + APP_DATASET_DECADES) * APP_DATASET_BINS_A_DECADE;
  return place < 0 ? 0 : place < APP_DATASET_BINS ? (int)place : APP_DATASET_BINS - 1;
}

static void count_pair(AppDatasetKind *kind, double volume) {
  kind->count++;
  if (!(volume > 0)) return;
  if (!kind->with_volume || volume < kind->volume_min) kind->volume_min = volume;
  if (volume > kind->volume_max) kind->volume_max = volume;
  kind->with_volume++;
  kind->histogram[bin_of(volume)]++;
}

// The middle, in the logarithm, of the bin in which the median is.
static double median_of(const AppDatasetKind *kind) {
  long long below = 0;
  int bin = 0;
  if (!kind->with_volume) return 0;
  while (2 * (below + kind->histogram[bin]) < kind->with_volume) below += kind->histogram[bin++];
  double middle = pow(10, (bin + 0.5) / APP_DATASET_BINS_A_DECADE - APP_DATASET_DECADES);
  return fmin(fmax(middle, kind->volume_min), kind->volume_max);
}

static Status count_all(DatagenDataset *dataset, const DatagenPairs *pairs, AppDatasetSummary *summary) {
  const long long total = datagen_dataset_info(dataset)->count;
  for (long long done = 0; done < total;) {
    size_t count = total - done < BLOCK ? (size_t)(total - done) : BLOCK;
    TRY(datagen_dataset_read(dataset, done, count, pairs));
    for (size_t i = 0; i < count; i++) count_pair(&summary->kinds[pairs->kind[i]], pairs->volume[i]);
    done += (long long)count;
  }
  return STATUS_OK;
}

Status app_dataset_summarise(DatagenDataset *dataset, AppDatasetSummary *summary) {
  DatagenPairs pairs;
  memset(summary, 0, sizeof *summary);
  TRY(datagen_pairs_create(&pairs, BLOCK, datagen_dataset_info(dataset)->has_gradient));
  Status status = count_all(dataset, &pairs, summary);
  datagen_pairs_destroy(&pairs);
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    summary->kinds[k].volume_median = median_of(&summary->kinds[k]);
  return status;
}
