// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/pairs/columns.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char *const names[APP_PAIRS_SIZE] = {"a0x", "a0y", "a0z", "a1x", "a1y", "a1z", "a2x", "a2y",
                                                  "a2z", "a3x", "a3y", "a3z", "b0x", "b0y", "b0z", "b1x",
                                                  "b1y", "b1z", "b2x", "b2y", "b2z", "b3x", "b3y", "b3z"};

const char *app_pairs_columns_name(int k) {
  return names[k];
}

static AppPairsColumns none(void) {
  AppPairsColumns columns = {.status = -1, .volume = -1};
  for (int k = 0; k < APP_PAIRS_SIZE; k++) columns.coordinates[k] = columns.gradient[k] = -1;
  return columns;
}

Status app_pairs_columns_by_place(AppPairsColumns *columns, int count, bool has_labels) {
  static const struct {
    int count;
    bool has_volume, has_status, has_gradient;
  } forms[] = {{24, false, false, false},
               {25, true, false, false},
               {26, true, true, false},
               {49, true, false, true},
               {50, true, true, true}};
  *columns = none();
  int place = 0, f = 0;
  while (f < (has_labels ? 5 : 1) && forms[f].count != count) f++;
  if (f == (has_labels ? 5 : 1))
    return status_fail(
        STATUS_INPUT,
        "%d numbers in a row; expected 24: tetrahedron 1's four vertices x y z, then tetrahedron "
        "2's%s, or a header that names the columns (a0x … b3z%s)",
        count,
        has_labels ? "; then, if they are there, status, volume and 24 derivatives (25, 26, 49 or 50 in all)"
                   : "",
        has_labels ? ", status, volume, dV/da0x … dV/db3z" : "");
  for (int k = 0; k < APP_PAIRS_SIZE; k++) columns->coordinates[k] = place++;
  if (forms[f].has_status) columns->status = place++;
  if (forms[f].has_volume) columns->volume = place++;
  for (int k = 0; forms[f].has_gradient && k < APP_PAIRS_SIZE; k++) columns->gradient[k] = place++;
  return STATUS_OK;
}

static int find_coordinate(const char *name) {
  int k = 0;
  while (k < APP_PAIRS_SIZE && strcasecmp(names[k], name) != 0) k++;
  return k < APP_PAIRS_SIZE ? k : -1;
}

// Where the place of a column of that name is kept; NULL: the name is not known.
static int *find_place(AppPairsColumns *columns, const char *name) {
  if (strcasecmp(name, "status") == 0) return &columns->status;
  if (strcasecmp(name, "volume") == 0) return &columns->volume;
  bool is_derivative = strncasecmp(name, "dV/d", 4) == 0;
  int k = find_coordinate(is_derivative ? name + 4 : name);
  if (k < 0) return NULL;
  return is_derivative ? &columns->gradient[k] : &columns->coordinates[k];
}

static Status check_whole(const AppPairsColumns *columns) {
  int derivatives = 0;
  for (int k = 0; k < APP_PAIRS_SIZE; k++) {
    derivatives += columns->gradient[k] >= 0;
    if (columns->coordinates[k] < 0)
      return status_fail(
          STATUS_INPUT, "the header has no column '%s'; the 24 of a pair are a0x … a3z, b0x … b3z", names[k]);
  }
  for (int k = 0; derivatives > 0 && k < APP_PAIRS_SIZE; k++)
    if (columns->gradient[k] < 0)
      return status_fail(STATUS_INPUT, "the header has %d of 24 derivatives; 'dV/d%s' is missing",
                         derivatives, names[k]);
  return STATUS_OK;
}

Status app_pairs_columns_by_name(AppPairsColumns *columns, const char *const *given, int count,
                                 bool has_labels) {
  bool is_any_known = false;
  *columns = none();
  for (int c = 0; c < count; c++) {
    int *place = find_place(columns, given[c]);
    if (!place) continue;
    if (*place >= 0) return status_fail(STATUS_INPUT, "the header has the column '%s' twice", given[c]);
    *place = c;
    is_any_known = true;
  }
  return is_any_known ? check_whole(columns) : app_pairs_columns_by_place(columns, count, has_labels);
}
