// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep/history.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"

static const char *next_line(const char *text) {
  const char *end = strchr(text, '\n');
  return end && end[1] ? end + 1 : NULL;
}

// Number of the column in the first line; −1: it has none of this name.
static int find_column(const char *head, const char *name) {
  size_t length = strlen(name);
  for (int k = 0;; k++) {
    size_t size = strcspn(head, ",\n");
    if (size == length && strncmp(head, name, length) == 0) return k;
    if (head[size] != ',') return -1;
    head += size + 1;
  }
}

// NaN: the line ends before.
static double value_at(const char *line, int column) {
  for (; column > 0; column--) {
    line += strcspn(line, ",\n");
    if (*line != ',') return NAN;
    line++;
  }
  char *end;
  double value = strtod(line, &end);
  return end == line ? NAN : value;
}

static int count_rows(const char *text) {
  int count = 0;
  for (const char *line = next_line(text); line; line = next_line(line)) count++;
  return count;
}

static void fill(AppSweepHistory *history, const char *text, int time, int force) {
  int rows = count_rows(text), row = 0;
  int group = (rows + APP_SWEEP_MOST_TIMES - 1) / APP_SWEEP_MOST_TIMES;
  for (const char *line = next_line(text); line; line = next_line(line), row++) {
    double at = value_at(line, time), value = value_at(line, force);
    if (!isfinite(at) || !isfinite(value)) continue; // cut short
    if (row % group == 0 || history->count == 0) history->force[history->count++] = 0;
    int k = history->count - 1;
    history->time[k] = at;
    history->force[k] = fmax(history->force[k], value);
  }
}

Status app_sweep_history_read(AppSweepHistory *history, const char *directory) {
  char *path = file_join(directory, "history.csv"), *text = NULL;
  size_t size;
  history->count = 0;
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? file_read(path, &text, &size) : STATUS_OK;
  if (!status && text) {
    int time = find_column(text, "time_s"), force = find_column(text, "contact_force_peak_N");
    if (time >= 0 && force >= 0) fill(history, text, time, force);
  }
  memory_free(text);
  memory_free(path);
  return status == STATUS_MEMORY ? status : STATUS_OK; // one that cannot be read is not shown
}
