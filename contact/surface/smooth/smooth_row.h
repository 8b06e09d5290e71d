// SPDX-License-Identifier: GPL-3.0-or-later
// The vertices that carry a vertex or a point of a smooth surface, once the mean way off the chords has been
// taken out (contact/surface/smooth/smooth.h).
#ifndef TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_ROW_H
#define TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_ROW_H

#include "contact/surface/smooth/smooth_points.h"

enum { CONTACT_SMOOTH_ROW_COUNT = 512 };

typedef struct ContactSmoothRow {
  int count;
  bool is_full; // there was no room for a vertex: the row is of no use
  int nodes[CONTACT_SMOOTH_ROW_COUNT];
  double weights[CONTACT_SMOOTH_ROW_COUNT];
} ContactSmoothRow;

// Adds a weight of a vertex.
void contact_smooth_row_add(ContactSmoothRow *row, int vertex, double weight);

// Takes `share` of the mean way off the chords round a vertex out of the row: weights whose sum is 0, and
// that move nothing at rest or under an affine motion.
void contact_smooth_row_settle(const ContactSmooth *smooth, int vertex, double share, ContactSmoothRow *row);

#endif
