// SPDX-License-Identifier: Apache-2.0
// How a model that is not ours is reached: in a library (library.h) or in another process (process.h). Both
// take the batch of include/tetlap/model.h.
#ifndef TETLAP_OVERLAP_FOREIGN_PORT_H
#define TETLAP_OVERLAP_FOREIGN_PORT_H

#include "base/status.h"
#include <tetlap/model.h>

typedef struct OverlapForeignPort {
  void *self;        // owned
  uint32_t gives;    // TETLAP_MODEL_…
  const char *range; // as TetlapModel has it, or NULL; as long as the port is open
  // Fills what the batch wants. STATUS_SOLVER: the model failed; the message has its own words.
  // STATUS_DEVICE: it is no longer there. STATUS_INTERRUPTED. One call at a time.
  Status (*ask)(void *self, const TetlapModelBatch *batch);
  Status (*pull)(void *self, const TetlapModelPull *pull); // likewise; NULL: it cannot
  void (*close)(void *self);
} OverlapForeignPort;

#endif
