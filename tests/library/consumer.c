/* SPDX-License-Identifier: Apache-2.0 */
/* A program of somebody else, in C and in C++: V of two tetrahedra of the same shape, by the model named. */
#include <stdio.h>
#include <tetlap/overlap.h>

int main(int count, char **arguments) {
  const double pair[24] = {0,   0, 0, 1,   0, 0, 0,   1, 0, 0,   0, 1, /* and the same, moved along x: */
                           0.5, 0, 0, 1.5, 0, 0, 0.5, 1, 0, 0.5, 0, 1};
  double volume, gradient[24];
  TetlapOverlap *overlap;
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  batch.count = 1, batch.pairs = pair, batch.volume = &volume, batch.gradient = gradient;
  if (tetlap_overlap_open(&overlap, count > 1 ? arguments[1] : "clip") ||
      tetlap_overlap_eval(overlap, &batch)) {
    fprintf(stderr, "%s\n", tetlap_overlap_message());
    return 1;
  }
  printf("%.6f\n", 48 * volume);
  tetlap_overlap_close(overlap);
  return 0;
}
