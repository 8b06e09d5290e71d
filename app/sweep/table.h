// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep found, a row a point: sweep.json, sweep.csv, the page sweep.html and the table for a terminal.
// Runs that are repeated are one row, with medians of their times.
#ifndef TETLAP_APP_SWEEP_TABLE_H
#define TETLAP_APP_SWEEP_TABLE_H

#include <stdio.h>

#include "app/sweep/grid.h"
#include "app/table/table.h"

// Whether this program reads a sweep.json that is in the folder already (NULL: none is). STATUS_INPUT: its
// format is another one.
Status app_sweep_table_check(const Record *table, const char *directory);

// sweep.json as a record, owned by the caller; NULL: no memory.
Record *app_sweep_table_record(const AppSweepGrid *grid);

// Writes all three into the sweep's folder, each whole or not at all.
Status app_sweep_table_write(const AppSweepGrid *grid);

// STATUS_MEMORY.
Status app_sweep_table_print(const AppSweepGrid *grid, AppTableFormat format, FILE *stream);

#endif
