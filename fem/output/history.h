// SPDX-License-Identifier: GPL-3.0-or-later
// history.csv: one line a frame under one line of column names (RFC 4180, decimal points, numbers that read
// back to the same double). The columns are the run's to name; docs/output.md lists them.
//
// Every line reaches the file at once, whole (base/files/journal.h): others may read it while it grows, and
// nothing of it is held in memory.
#ifndef TETLAP_FEM_OUTPUT_HISTORY_H
#define TETLAP_FEM_OUTPUT_HISTORY_H

#include <stddef.h>

#include "base/files/journal.h"
#include "base/status.h"

typedef struct FemHistory {
  Journal file;
  char **titles; // of the columns, owned                         (column_count)
  int column_count;
  int *places; // of the titles: numbers of columns from 1 on, open addressing (place_count)
  size_t place_count;
  char *line; // the one being printed                              (line_size)
  size_t line_size;
  size_t title_capacity, line_capacity;
} FemHistory;

// Nothing is written before the first row.
Status fem_history_create(FemHistory *history, const char *path);

// Adds a column with its unit, as in ("force_%s_%s_x_N", a, b); only before the first row. Returns
// STATUS_INPUT if there is one of that name already: `force_a_b_c_x_N` may come from the bodies a_b and c or
// from a and b_c.
Status fem_history_add_column(FemHistory *history, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Appends a row; `values` (column_count), in the order in which the columns were added. A number that is not
// finite is written as nan, inf or -inf. STATUS_IO: the file is as it was.
Status fem_history_add_row(FemHistory *history, const double *values);

// Goes on after what the file held at that mark, which a history of these columns wrote; only before the
// first row. Fails as journal_continue does.
Status fem_history_continue(FemHistory *history, JournalMark mark);

void fem_history_destroy(FemHistory *history);

#endif
