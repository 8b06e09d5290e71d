// SPDX-License-Identifier: GPL-3.0-or-later
// What each element of an evaluation meets of another body or shape, part by part. An element may meet a body
// in several places at once, on opposite sides: in a slot, between two layers of a folded body that meets
// itself. What it meets there belongs to different parts of that body: cells of the contact mesh that have a
// vertex in common, or are connected by such among those that the element meets, are one part.
#ifndef TETLAP_CONTACT_PASSAGE_MEETINGS_H
#define TETLAP_CONTACT_PASSAGE_MEETINGS_H

#include <stdbool.h>

#include "contact/evaluation.h"

typedef struct ContactMeeting {
  int interface, tet;       // the element
  int cell;                 // of the part, the one that it meets most of; −1: a shape
  int cell_begin, cell_end; // of the part, in `cells`
  double slope[3], size;    // Σ w g, Σ w |g|
  double most;              // largest V_ij, that with `cell` [m³]
  double reach;             // largest depth as a share of that of the middle there; without a depth 0
  double volume, other;     // Σ V_ij, Σ V_j of the cells that it meets [m³]
  double covered;           // share of the lesser volume
} ContactMeeting;

typedef struct ContactMeetings {
  ContactMeeting *list; // by interface, then tet                                      (count)
  int count;
  int *cells; // that are met, part by part; −1: a shape                               (two a pair)
  // Scratch memory.
  int *begin; // of each element of the patches, in `items`                            (elements + 1)
  int *items; // of each element: 2 pair + side                                        (two a pair)
  int *parts; // of each item: its part, in `list`                                     (two a pair)
  int *first; // of each position: the first item with it; −1 between elements         (position_count)
  size_t list_capacity, cell_capacity, begin_capacity, item_capacity, part_capacity, first_capacity;
} ContactMeetings;

void contact_meetings_destroy(ContactMeetings *meetings); // also of a zeroed one

// Marks the interfaces in which an element reaches at least this share of the way to the middle, or has at
// most `way` [m] left to it. `middles`: of each cell, the depth of the middle there [m].
void contact_meetings_mark(const ContactLayout *layout, const ContactEvaluation *evaluation,
                           const double *middles, double least, double way, bool *is_marked);

// Of the pairs of marked interfaces, in place of what was there. `middles` NULL: there are no depths. Volumes
// below `rounding` of the lesser cell's have no direction and no depth. STATUS_MEMORY.
Status contact_meetings_find(ContactMeetings *meetings, const ContactLayout *layout,
                             const ContactEvaluation *evaluation, const double *middles, double rounding,
                             const bool *is_marked);

// How many vertices the cell has in common with that of the part's cells with which it has most: 4, it is one
// of them; also of two shapes.
int contact_meetings_common(const ContactMeetings *meetings, const ContactMesh *mesh,
                            const ContactMeeting *meeting, int cell);

#endif
