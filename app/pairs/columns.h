// SPDX-License-Identifier: GPL-3.0-or-later
// The columns of tables of pairs, and which of a table's columns holds what.
//
//   a0x a0y a0z a1x … a3z   tetrahedron 1's vertices       volume           V
//   b0x b0y b0z b1x … b3z   tetrahedron 2's                dV/da0x … dV/db3z   the derivatives of V
//   status                  1: the closed tetrahedra have a point in common, else 0
#ifndef TETLAP_APP_PAIRS_COLUMNS_H
#define TETLAP_APP_PAIRS_COLUMNS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

enum { APP_PAIRS_SIZE = 24, APP_PAIRS_MAX_COLUMNS = 256 };

// Places in a row of a table; −1: there is no such column.
typedef struct AppPairsColumns {
  int coordinates[APP_PAIRS_SIZE];
  int status, volume;
  int gradient[APP_PAIRS_SIZE]; // all or none
} AppPairsColumns;

// The name of coordinate k of a pair, "a0x" … "b3z".
const char *app_pairs_columns_name(int k);

// Columns by their place: 24 coordinates; where `has_labels` is allowed also 25 (volume), 26 (status,
// volume), 49 (volume, derivatives), 50 (status, volume, derivatives). STATUS_INPUT: another number of them;
// the message does not name the file.
Status app_pairs_columns_by_place(AppPairsColumns *columns, int count, bool has_labels);

// Columns by their names, in any order; others are left unread. Where no name is known, by their place.
// STATUS_INPUT: a column lacks, or is there twice; the message names it and not the file.
Status app_pairs_columns_by_name(AppPairsColumns *columns, const char *const *names, int count,
                                 bool has_labels);

#endif
