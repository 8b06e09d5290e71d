// SPDX-License-Identifier: Apache-2.0
// What a port is asked: the pairs and room for the answers. Behind each array stand numbers that no
// model may touch.
#ifndef TETLAP_OVERLAP_FOREIGN_REQUEST_H
#define TETLAP_OVERLAP_FOREIGN_REQUEST_H

#include "overlap/foreign/port.h"

// The arrays; what is wanted of them are bits 1 << array.
typedef enum OverlapForeignArray {
  OVERLAP_FOREIGN_PAIRS,
  OVERLAP_FOREIGN_VOLUME,
  OVERLAP_FOREIGN_GRADIENT,
  OVERLAP_FOREIGN_CENTROID,
  OVERLAP_FOREIGN_LOGIT,
  OVERLAP_FOREIGN_DOUBT,
  OVERLAP_FOREIGN_DOUBT_GRADIENT,
  OVERLAP_FOREIGN_REST, // with `elements` and `bodies`
  OVERLAP_FOREIGN_BY_VOLUME,
  OVERLAP_FOREIGN_BY_CENTROID,
  OVERLAP_FOREIGN_BY_GRADIENT,
  OVERLAP_FOREIGN_SLOPE,
  OVERLAP_FOREIGN_ARRAYS
} OverlapForeignArray;

typedef struct OverlapForeignRequest {
  size_t count;                           // pairs that are asked for
  const double *pairs;                    // those; often arrays[OVERLAP_FOREIGN_PAIRS]
  double *arrays[OVERLAP_FOREIGN_ARRAYS]; // as in TetlapModelBatch and TetlapModelPull
  int32_t *elements, *bodies;             // likewise
  size_t capacities[OVERLAP_FOREIGN_ARRAYS], element_capacity, body_capacity;
} OverlapForeignRequest;

void overlap_foreign_request_destroy(OverlapForeignRequest *request);

// Room for so many pairs in the arrays that are wanted.
Status overlap_foreign_request_reserve(OverlapForeignRequest *request, size_t count, unsigned wanted);

// Asks for what is wanted of the pairs; ∇V of a port that gives none comes from its pull-back. What the model
// leaves unwritten is NaN. STATUS_SOLVER: it wrote beyond the end of an array; `name` is the model's, for
// messages.
Status overlap_foreign_request_ask(OverlapForeignRequest *request, const OverlapForeignPort *port,
                                   const char *name, unsigned wanted);

// The slope, by BY_VOLUME and those others that are wanted, which are filled.
Status overlap_foreign_request_pull(OverlapForeignRequest *request, const OverlapForeignPort *port,
                                    const char *name, unsigned wanted);

#endif
