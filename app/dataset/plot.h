// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of a data set by gnuplot: pairs by kind, and how V is distributed, in log V and in V. The script,
// with its numbers, is kept beside the picture.
#ifndef TETLAP_APP_DATASET_PLOT_H
#define TETLAP_APP_DATASET_PLOT_H

#include "datagen/files/dataset.h"

// Writes `picture`.gp and runs gnuplot on it, which writes `picture` (PNG, or SVG or PDF by its ending).
// `title` names the data set. STATUS_IO: gnuplot is missing or failed; the script is there all the same.
Status app_dataset_plot(DatagenDataset *dataset, const char *title, const char *picture);

#endif
