// SPDX-License-Identifier: Apache-2.0
// What crosses the border of the C API (tetlap/overlap.h): structs that carry their size, statuses.
#ifndef TETLAP_OVERLAP_API_ARGUMENT_H
#define TETLAP_OVERLAP_API_ARGUMENT_H

#include <stddef.h>
#include <tetlap/overlap.h>

#include "base/status.h"

// Copies a caller's struct, whose first member is its size, to ours of `size` bytes, zeros where the caller's
// ends. STATUS_INPUT: it is NULL, smaller than the first version of it was, or has something set that this
// library does not know.
Status overlap_api_argument_copy(void *ours, size_t size, size_t first_size, const void *theirs,
                                 const char *name);

// Copies a caller's mesh, whose number in messages is `number`. STATUS_INPUT, too, where it names a point
// that is not there, or has a coordinate that is not finite.
Status overlap_api_argument_mesh(TetlapOverlapMesh *mesh, const TetlapOverlapMesh *theirs, int number);

// The API's status for ours.
int overlap_api_argument_status(Status status);

#endif
