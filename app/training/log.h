// SPDX-License-Identifier: GPL-3.0-or-later
// The log of a training, log.csv: a row for each validation; and its picture, learning.png, by gnuplot, whose
// script learning.gp is kept.
#ifndef TETLAP_APP_TRAINING_LOG_H
#define TETLAP_APP_TRAINING_LOG_H

#include "app/training/task.h"

typedef struct AppTrainingRow {
  long long step;
  double samples, seconds, rate; // seen; spent; of learning
  double loss, gradient_norm;    // means since the row before
  const AppTrainingScores *scores;
} AppTrainingRow;

typedef struct AppTrainingLog {
  char *text; // the file's content, owned
  size_t size, capacity;
  char *path; // owned
} AppTrainingLog;

// A new log in that directory; with `step` ≥ 0, the file that is there, up to the row of that step.
Status app_training_log_open(AppTrainingLog *log, const char *directory, long long step);
// Adds a row and writes the file, whole.
Status app_training_log_add(AppTrainingLog *log, const AppTrainingRow *row);
void app_training_log_close(AppTrainingLog *log); // a zeroed one is accepted

// Writes learning.gp beside log.csv and runs gnuplot on it. STATUS_IO: gnuplot is missing or failed.
Status app_training_log_plot(const char *directory, const char *name);

#endif
