// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries that are wrong in one way each (test_foreign_library.c), chosen by WRONG.
#if WRONG == 22
#define tetlap_model function_of_it // the name is that of a variable
#endif
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <tetlap/model.h>
#include <unistd.h>

enum {
  NOTHING,
  NO_NAME,
  OTHER_ABI,
  NO_SIZE,
  NO_EVALUATE,
  OPEN_FAILS,
  EVALUATE_FAILS,
  NOT_FINITE,
  NEGATIVE,
  TOO_LARGE,
  SILENT,
  TOO_MANY,
  SPOILS,
  PULLS,
  PULLS_WRONG,
  KNOWS,
  DOUBTS,
  PULLS_NAN,
  DOUBTS_SMOOTHLY,
  RANGED,
  RANGED_WRONG,
  EXITS,
  VARIABLE,
  LEAVES
};

enum { PULLS_BACK = WRONG == PULLS || WRONG == PULLS_WRONG || WRONG == PULLS_NAN };

static size_t told_count; // of pairs whose origins were as they should be

static void close_it(void *self) {
  (void)self;
  if (WRONG == KNOWS) fprintf(stderr, "told of %zu pairs\n", told_count);
}

static int open_it(void **self, char *message, size_t size) {
  (void)self;
  if (WRONG != OPEN_FAILS) return 0;
  snprintf(message, size, "weights of 1 GB are not there");
  return 3;
}

static int evaluate(void *self, const TetlapModelBatch *batch, char *message, size_t size) {
  (void)self;
  for (size_t i = 0; WRONG != SILENT && i < batch->count; i++) {
    batch->volume[i] = WRONG == NOT_FINITE ? NAN : WRONG == NEGATIVE ? -1 : WRONG == TOO_LARGE ? 100 : 1e-3;
    for (int v = 0; batch->gradient && v < 24; v++) batch->gradient[24 * i + v] = 1;
  }
  if (WRONG == TOO_MANY) {
    batch->volume[batch->count] = 1e-3; // a row that is not there
    if (batch->gradient) batch->gradient[24 * batch->count] = 1;
  }
  // V = 1e-3 Σ x², x̄ the mean of the vertices: their derivatives come by pull_back alone.
  for (size_t i = 0; PULLS_BACK && i < batch->count; i++) {
    batch->volume[i] = 0;
    for (int c = 0; batch->centroid && c < 3; c++) batch->centroid[3 * i + c] = 0;
    for (int v = 0; v < 24; v++) {
      const double x = batch->pairs[24 * i + v];
      batch->volume[i] += 1e-3 * x * x;
      if (batch->centroid) batch->centroid[3 * i + v % 3] += x / 8;
    }
  }
  // Its volumes are those of the smaller tetrahedron at rest; it fails where it is told something else.
  for (size_t i = 0; WRONG == KNOWS && i < batch->count; i++) {
    const int32_t *elements = batch->elements + 2 * i, *bodies = batch->bodies + 2 * i;
    const double *rest = batch->rest + 2 * i;
    if (bodies[0] != 0 || bodies[1] != 1 || elements[0] < 0 || elements[1] <= elements[0] ||
        !(rest[0] > 0 && rest[1] > 0))
      return 9;
    told_count++;
    batch->volume[i] = 1e-9 * (rest[0] < rest[1] ? rest[0] : rest[1]);
    for (int c = 0; batch->centroid && c < 3; c++) batch->centroid[3 * i + c] = batch->pairs[24 * i + c];
  }
  // As tests/overlap/wrap/test_wrap.c has it.
  for (size_t i = 0; WRONG == DOUBTS && batch->doubt && i < batch->count; i++) {
    const double x = batch->pairs[24 * i];
    batch->doubt[i] = x < 0.3 ? 0 : x > 0.6 ? INFINITY : 7e-6;
    if (x > 0.8) batch->volume[i] = 0;
  }
  // V = 1e-4 Σ x², and a doubt of .005 (1 + x_0) V: both follow the pair, so that a hybrid of it is blended.
  for (size_t i = 0; (WRONG == DOUBTS_SMOOTHLY || WRONG == RANGED) && i < batch->count; i++) {
    const double *x = batch->pairs + 24 * i;
    double sum = 0;
    for (int v = 0; v < 24; v++) sum += x[v] * x[v];
    batch->volume[i] = 1e-4 * sum;
    if (batch->doubt) batch->doubt[i] = 5e-7 * sum * (1 + x[0]);
    for (int v = 0; v < 24; v++) {
      if (batch->gradient) batch->gradient[24 * i + v] = 2e-4 * x[v];
      if (batch->doubt_gradient)
        batch->doubt_gradient[24 * i + v] = 5e-7 * (2 * x[v] * (1 + x[0]) + (v == 0) * sum);
    }
  }
  if (WRONG == EXITS) exit(0);
  if (WRONG == LEAVES) {
    const pid_t child = fork(); // ends as it likes
    if (child == 0) _exit(0);
    waitpid(child, NULL, 0);
    _exit(0);
  }
  if (WRONG == SPOILS) memset((double *)batch->pairs, 0xFF, 24 * batch->count * sizeof(double));
  if (WRONG != EVALUATE_FAILS) return 0;
  snprintf(message, size, "the card fell out");
  return 4;
}

static int pull_back(void *self, const TetlapModelPull *pull, char *message, size_t size) {
  (void)self, (void)message, (void)size;
  for (size_t i = 0; i < 24 * pull->count; i++) {
    pull->slope[i] = 2e-3 * pull->by_volume[i / 24] * pull->pairs[i];
    if (pull->by_centroid) pull->slope[i] += pull->by_centroid[3 * (i / 24) + i % 3] / 8;
    if (pull->by_gradient) pull->slope[i] += 2e-3 * pull->by_gradient[i];
  }
  if (WRONG == PULLS_WRONG && pull->by_centroid) pull->slope[0] += 1;
  if (WRONG == PULLS_NAN && pull->by_centroid) pull->slope[24 * pull->count - 1] = NAN;
  return 0;
}

#if WRONG == 1
const TetlapModel *another_name(void);
const TetlapModel *another_name(void) {
#else
const TetlapModel *tetlap_model(void) {
#endif
  static const TetlapModel model = {
      .size = WRONG == NO_SIZE   ? 0
              : WRONG == NOTHING ? offsetof(TetlapModel, pull_back) // an older header's
              : WRONG == PULLS   ? offsetof(TetlapModel, range)     // likewise
                                 : sizeof model,
      .abi = WRONG == OTHER_ABI ? 99 : TETLAP_MODEL_ABI,
      .name = "wrong",
      .gives = PULLS_BACK        ? TETLAP_MODEL_CENTROID | TETLAP_MODEL_CURVATURE
               : WRONG == DOUBTS ? TETLAP_MODEL_DOUBT
               : WRONG == DOUBTS_SMOOTHLY
                   ? TETLAP_MODEL_GRADIENT | TETLAP_MODEL_DOUBT | TETLAP_MODEL_DOUBT_GRADIENT
               : WRONG == KNOWS ? TETLAP_MODEL_CENTROID | TETLAP_MODEL_ORIGINS
                                : TETLAP_MODEL_GRADIENT,
      .open = open_it,
      .close = close_it,
      .evaluate = WRONG == NO_EVALUATE ? NULL : evaluate,
      .pull_back = PULLS_BACK ? pull_back : NULL,
      .range = WRONG == RANGED || WRONG == DOUBTS_SMOOTHLY
                   ? "radius 0.1 to 0.7, first volume 0.005 to 0.04, second "
                     "volume 0.005 to 0.04, overlap to 0.0008"
               : WRONG == RANGED_WRONG || WRONG == PULLS ? "radius 2 to 1"
                                                         : NULL};
  return &model;
}

#if WRONG == 22
#undef tetlap_model
extern const int tetlap_model;
const int tetlap_model = 1;
#endif
