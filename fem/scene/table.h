// SPDX-License-Identifier: GPL-3.0-or-later
// A function of time given by rows (time, values …): linear between them, constant outside.
#ifndef TETLAP_FEM_SCENE_TABLE_H
#define TETLAP_FEM_SCENE_TABLE_H

typedef struct FemTable {
  const double *rows; // times increasing; borrowed    (count, width)
  int width, count;   // width − 1 values; count 0: no table
} FemTable;

// Values and their rates (width − 1 each); at a row the rate from there on.
void fem_table_eval(FemTable table, double time, double *values, double *rates);

// The first row's time after `time`; INFINITY: none.
double fem_table_next_row(FemTable table, double time);

// From a time on, when the values begin to change: that time itself if they are changing, INFINITY if never
// again.
double fem_table_next_change(FemTable table, double time);

#endif
