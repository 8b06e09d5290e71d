// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/plot/gnuplot.h"
#include "base/files/file.h"
#include "base/memory.h"

static Status append(AppTrainingLog *log, const char *format, ...) __attribute__((format(printf, 2, 3)));

static Status append(AppTrainingLog *log, const char *format, ...) {
  char piece[256];
  va_list arguments;
  va_start(arguments, format);
  int length = vsnprintf(piece, sizeof piece, format, arguments);
  va_end(arguments);
  size_t wanted = log->size + (size_t)length + 1;
  if (!memory_reserve((void **)&log->text, &log->capacity, wanted, 1)) return status_no_memory("the log");
  memcpy(log->text + log->size, piece, (size_t)length + 1);
  log->size += (size_t)length;
  return STATUS_OK;
}

// Keeps the head and the rows up to a step.
static void cut(AppTrainingLog *log, long long step) {
  char *line = strchr(log->text, '\n');
  while (line && line[1] && strtoll(line + 1, NULL, 10) <= step) line = strchr(line + 1, '\n');
  if (line) line[1] = 0;
  log->size = strlen(log->text);
}

Status app_training_log_open(AppTrainingLog *log, const char *directory, long long step) {
  *log = (AppTrainingLog){.path = file_join(directory, "log.csv")};
  if (!log->path) return status_no_memory("the log");
  if (step < 0 || !file_exists(log->path)) return STATUS_OK;
  TRY(file_read(log->path, &log->text, &log->size));
  log->capacity = log->size + 1;
  cut(log, step);
  return STATUS_OK;
}

void app_training_log_close(AppTrainingLog *log) {
  memory_free(log->text), memory_free(log->path);
  *log = (AppTrainingLog){0};
}

static Status append_head(AppTrainingLog *log, const AppTrainingScores *scores) {
  TRY(append(log, "step,samples,seconds,rate,loss,gradient_norm,score"));
  for (int s = 0; s < scores->count; s++) TRY(append(log, ",%s", scores->names[s]));
  return append(log, "\n");
}

Status app_training_log_add(AppTrainingLog *log, const AppTrainingRow *row) {
  const AppTrainingScores *scores = row->scores;
  if (log->size == 0) TRY(append_head(log, scores));
  TRY(append(log, "%lld,%.0f,%.1f,%.6g,%.6g,%.4g,%.6g", row->step, row->samples, row->seconds, row->rate,
             row->loss, row->gradient_norm, scores->score));
  for (int s = 0; s < scores->count; s++) TRY(append(log, ",%.6g", scores->values[s]));
  TRY(append(log, "\n"));
  FileWriter writer;
  TRY(file_begin(&writer, log->path));
  fwrite(log->text, 1, log->size, writer.stream);
  return file_commit(&writer);
}

static Status write_script(const char *path, const char *directory, const char *name) {
  FileWriter writer;
  TRY(file_begin(&writer, path));
  fprintf(writer.stream,
          "# gnuplot script; run it again with: gnuplot THIS_FILE\n"
          "directory = \"%s\"\n"
          "set terminal pngcairo size 900,540\n"
          "if (!exists('picture')) picture = directory.\"/learning.png\"\nset output picture\n"
          "set datafile separator ','\nset title \"%s\" noenhanced\nset key above noenhanced\nset grid\n"
          "set linetype 5 linecolor rgb '#7f6000'\n" // the default is a yellow that white swallows
          "set logscale y\nset format y '10^{%%T}'\nset xlabel 'samples seen'\n"
          "log = directory.\"/log.csv\"\nstats log using 1 skip 1 nooutput\n"
          "plot log using 'samples':'loss' with lines lw 2 title 'loss', log using 'samples':'score' with "
          "lines lw 2 title 'score', \\\n"
          "  for [c=8:STATS_columns] log using 'samples':c with lines dashtype 2 title columnheader(c)\n",
          directory, name);
  return file_commit(&writer);
}

Status app_training_log_plot(const char *directory, const char *name) {
  char *script = file_join(directory, "learning.gp"), *picture = file_join(directory, "learning.png");
  Status status = script && picture ? write_script(script, directory, name) : status_no_memory("the plot");
  if (!status) status = app_gnuplot_run(script, picture);
  memory_free(script), memory_free(picture);
  return status;
}
