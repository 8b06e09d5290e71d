// SPDX-License-Identifier: GPL-3.0-or-later
// history.csv: one line a frame under one line of column names (RFC 4180, decimal points, numbers that read
// back to the same double). The columns are the run's to name; docs/output.md lists them.
//
// The file is whole at every moment: lines are kept in memory and the file is replaced by a longer one, at
// the first row, at most once a second after that, and when fem_history_write is called. A run that is
// killed leaves whole lines and lacks the rows of the last second at most.
#ifndef TETLAP_FEM_HISTORY_H
#define TETLAP_FEM_HISTORY_H

#include <stddef.h>

#include "base/status.h"

typedef struct FemHistory {
  char *path;    // owned
  char **titles; // of the columns, owned                         (column_count)
  int column_count;
  int row_count;
  char *text;          // what the file holds or soon will hold          (text_size)
  size_t text_size;    //
  double written_at_s; // wall clock of the last replacement
  int written_rows;    // rows that the file has
  size_t title_capacity, text_capacity;
} FemHistory;

// Nothing is written before the first row.
Status fem_history_create(FemHistory *history, const char *path);

// Adds a column with its unit, as in ("force_%s_%s_x_N", a, b); only before the first row. Returns
// STATUS_INPUT if there is one of that name already: `force_a_b_c_x_N` may come from the bodies a_b and c or
// from a and b_c.
Status fem_history_add_column(FemHistory *history, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// Appends a row; `values` (column_count), in the order in which the columns were added. A number that is not
// finite is written as nan, inf or -inf.
Status fem_history_add_row(FemHistory *history, const double *values);

// Goes on after `row_count` rows that were written by a history of these columns; only before the first row.
Status fem_history_continue(FemHistory *history, const char *text, int row_count);

// Replaces the file now: at the end, and before anything that may take long.
Status fem_history_write(FemHistory *history);

void fem_history_destroy(FemHistory *history); // writes nothing

#endif
