// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries that are wrong in one way each (tests/overlap/test_foreign.c), chosen by WRONG.
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <tetlap/model.h>

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
  SPOILS
};

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
  if (WRONG == SPOILS) memset((double *)batch->pairs, 0xFF, 24 * batch->count * sizeof(double));
  if (WRONG != EVALUATE_FAILS) return 0;
  snprintf(message, size, "the card fell out");
  return 4;
}

#if WRONG == 1
const TetlapModel *another_name(void);
const TetlapModel *another_name(void) {
#else
const TetlapModel *tetlap_model(void) {
#endif
  static const TetlapModel model = {.size = WRONG == NO_SIZE ? 0 : sizeof model,
                                    .abi = WRONG == OTHER_ABI ? 99 : TETLAP_MODEL_ABI,
                                    .name = "wrong",
                                    .gives = TETLAP_MODEL_GRADIENT,
                                    .open = open_it,
                                    .evaluate = WRONG == NO_EVALUATE ? NULL : evaluate};
  return &model;
}
