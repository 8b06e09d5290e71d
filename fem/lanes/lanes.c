// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/lanes/lanes.h"

#include "base/machine/cpu.h"

static const FemLanes *const all[] = {
    &fem_lanes_portable,
#if defined(__x86_64__)
    &fem_lanes_avx2,
    &fem_lanes_avx512,
#endif
};

const FemLanes *const *fem_lanes_list(int *count) {
  *count = 1 + cpu_has_avx2() + (cpu_has_avx2() && cpu_has_avx512());
  return all;
}

const FemLanes *fem_lanes(void) {
  int count;
  fem_lanes_list(&count);
  return all[count - 1];
}

// Row and column of each entry, in the order of the lanes.
static void find_places(int row[FEM_LANES_ENTRIES], int column[FEM_LANES_ENTRIES]) {
  static const int first[6] = {0, 0, 0, 1, 1, 2}, second[6] = {1, 2, 3, 2, 3, 3};
  int n = 0;
  for (int a = 0; a < 4; a++)
    for (int c = 0; c < 3; c++)
      for (int r = c; r < 3; r++, n++) row[n] = 3 * a + r, column[n] = 3 * a + c;
  for (int p = 0; p < 6; p++)
    for (int c = 0; c < 3; c++)
      for (int r = 0; r < 3; r++, n++) row[n] = 3 * second[p] + r, column[n] = 3 * first[p] + c;
}

void fem_lanes_unpack(FemLanesRow matrix[FEM_LANES_ENTRIES], int lane, double dense[144]) {
  int row[FEM_LANES_ENTRIES], column[FEM_LANES_ENTRIES];
  find_places(row, column);
  for (int n = 0; n < FEM_LANES_ENTRIES; n++)
    dense[12 * row[n] + column[n]] = dense[12 * column[n] + row[n]] = matrix[n][lane];
}
