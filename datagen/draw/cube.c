// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/draw/cube.h"

#include <math.h>

void datagen_cube_box(const double *points, int count, double low[3], double high[3]) {
  for (int c = 0; c < 3; c++) {
    low[c] = high[c] = points[c];
    for (int i = 1; i < count; i++) {
      low[c] = fmin(low[c], points[3 * i + c]);
      high[c] = fmax(high[c], points[3 * i + c]);
    }
  }
}

double datagen_cube_fit(double pair[24], const double place[3]) {
  double low[3], high[3], size = 0;
  datagen_cube_box(pair, 8, low, high);
  for (int c = 0; c < 3; c++) size = fmax(size, high[c] - low[c]);
  if (!(size > 0)) return 0;
  for (int c = 0; c < 3; c++) {
    double room = 1 - (high[c] - low[c]) / size;
    for (int i = c; i < 24; i += 3) pair[i] = fmin(fmax((pair[i] - low[c]) / size + room * place[c], 0), 1);
  }
  return 1 / size;
}
