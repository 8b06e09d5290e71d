/* SPDX-License-Identifier: Apache-2.0 */
/* A model as a shared library: one tetrahedron is split at the other's four face planes, into tetrahedra.
 *   cc -O2 -shared -fPIC -I include examples/models/split.c -o split.so
 *   tetlap run examples/02_two_blocks.yaml --overlap ./split.so */
#include <math.h>
#include <string.h>
#include <tetlap/model.h>

typedef double Point[3];

static double volume_of(Point t[4]) {
  double e[3][3];
  for (int i = 0; i < 9; i++) e[i / 3][i % 3] = t[i / 3 + 1][i % 3] - t[0][i % 3];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) / 6;
}

/* The vertices of `t` with vertex v at w instead: its volume over that of `t` is w's barycentric coordinate. */
static double with(Point t[4], int v, Point w) {
  Point s[4];
  memcpy(s, t, sizeof s), memcpy(s[v], w, sizeof s[v]);
  return volume_of(s);
}

/* Adds V and V x of the part of `t` on the inner side of the faces f, f + 1, ... of `b`. A plane cuts at most
 * four edges; what rounding would cut again stays whole. */
static void add(Point t[4], Point b[4], int f, int cuts, double sums[4]) {
  double v = volume_of(t), h[4];
  if (f == 4) {
    sums[0] += fabs(v);
    for (int c = 0; c < 3; c++) sums[1 + c] += fabs(v) * (t[0][c] + t[1][c] + t[2][c] + t[3][c]) / 4;
    return;
  }
  for (int i = 0; i < 4; i++) h[i] = with(b, f, t[i]) / volume_of(b);
  for (int i = 0; i < 4 && cuts > 0; i++)
    for (int j = 0; j < 4; j++) {
      if (!(h[i] > 1e-13 && h[j] < -1e-13)) continue; /* the edge is cut: two halves, each looked at again */
      Point cut, half[2][4];
      for (int c = 0; c < 3; c++) cut[c] = (h[i] * t[j][c] - h[j] * t[i][c]) / (h[i] - h[j]);
      memcpy(half[0], t, sizeof half[0]), memcpy(half[1], t, sizeof half[1]);
      memcpy(half[0][i], cut, sizeof cut), memcpy(half[1][j], cut, sizeof cut);
      add(half[0], b, f, cuts - 1, sums), add(half[1], b, f, cuts - 1, sums);
      return;
    }
  if (h[0] + h[1] + h[2] + h[3] > 0) add(t, b, f + 1, 4, sums);
}

static int evaluate(void *self, const TetlapModelBatch *batch, char *message, size_t size) {
  (void)self, (void)message, (void)size;
  for (size_t i = 0; i < batch->count; i++) {
    Point pair[8];
    double sums[4] = {0};
    memcpy(pair, batch->pairs + 24 * i, sizeof pair);
    add(pair, pair + 4, 0, 4, sums);
    batch->volume[i] = sums[0];
    for (int c = 0; batch->centroid && c < 3; c++) batch->centroid[3 * i + c] = sums[0] > 0 ? sums[1 + c] / sums[0] : 0;
  }
  return 0;
}

const TetlapModel *tetlap_model(void) {
  static const TetlapModel model = {.size = sizeof model, .abi = TETLAP_MODEL_ABI, .name = "split",
                                    .gives = TETLAP_MODEL_CENTROID | TETLAP_MODEL_DISJOINT, .evaluate = evaluate};
  return &model;
}
