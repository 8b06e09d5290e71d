/* SPDX-License-Identifier: Apache-2.0 */
/* A model of tetlap's own as a library of yours: a frame for what is to answer some pairs otherwise.
 *   cc -O2 -shared -fPIC -I include examples/models/clip.c -o clip.so -ltetlap-overlap
 *   tetlap run examples/02_two_blocks.yaml --overlap ./clip.so */
#include <stdio.h>
#include <tetlap/model.h>
#include <tetlap/overlap.h>

static int open_clip(void **self, char *message, size_t size) {
  if (tetlap_overlap_open((TetlapOverlap **)self, "clip") == TETLAP_OVERLAP_OK) return 0;
  snprintf(message, size, "%s", tetlap_overlap_message());
  return 1;
}

static int evaluate(void *self, const TetlapModelBatch *batch, char *message, size_t size) {
  TetlapOverlapBatch pairs = TETLAP_OVERLAP_BATCH_INIT;
  pairs.count = batch->count, pairs.pairs = batch->pairs;
  pairs.volume = batch->volume, pairs.gradient = batch->gradient, pairs.centroid = batch->centroid;
  if (tetlap_overlap_eval(self, &pairs) == TETLAP_OVERLAP_OK) return 0;
  snprintf(message, size, "%s", tetlap_overlap_message());
  return 1;
}

static void close_clip(void *self) {
  tetlap_overlap_close(self);
}

const TetlapModel *tetlap_model(void) {
  static const TetlapModel model = {.size = sizeof model, .abi = TETLAP_MODEL_ABI, .name = "clip",
                                    .gives = TETLAP_MODEL_GRADIENT | TETLAP_MODEL_CENTROID | TETLAP_MODEL_DISJOINT,
                                    .open = open_clip, .evaluate = evaluate, .close = close_clip};
  return &model;
}
