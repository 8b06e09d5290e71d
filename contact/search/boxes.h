// SPDX-License-Identifier: GPL-3.0-or-later
// Which boxes of one sequence meet which of another, on all threads. The second is put in the order of a
// curve through space (Morton 1966), and bounded by groups of eight, of eight groups, and so on. Each box of
// the first goes down from the top. Memory O(n + pairs), time of boxes that are not much longer than their
// distances O(n log n + pairs).
#ifndef TETLAP_CONTACT_SEARCH_BOXES_H
#define TETLAP_CONTACT_SEARCH_BOXES_H

#include <stddef.h>

#include "base/status.h"

// A growing array of index pairs. A zeroed one is empty; set count to 0 to use its memory again.
typedef struct ContactBoxPairs {
  size_t count;
  size_t capacity;
  int (*pairs)[2]; // index into boxes_a, index into boxes_b; owned       (count)
} ContactBoxPairs;

// Appends every pair of a box of `a` and a box of `b` that have a point in common; the boxes are closed, so
// touching counts. A box is { min x, min y, min z, max x, max y, max z }, finite, min ≤ max. Each pair comes
// once, by boxes of `a`; of one of those, in no promised order. The arrays are read only during the call;
// safe to call from several threads with different outputs. STATUS_MEMORY: `out` holds no part of this call's
// pairs.
Status contact_boxes_intersect(const double (*boxes_a)[6], int count_a, const double (*boxes_b)[6],
                               int count_b, ContactBoxPairs *out);

void contact_boxes_destroy(ContactBoxPairs *pairs);

#endif
