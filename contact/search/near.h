// SPDX-License-Identifier: GPL-3.0-or-later
// The candidates that may overlap soon: a shorter list for evaluations. A candidate that is not in it stays
// disjoint while its parties have come nearer by less than the skin since the list was made. So the result is
// the same with either list.
//
// To choose them, every cell is enlarged about the centre of its inscribed sphere until each face has moved
// out by half of the skin; it then holds all points within that distance. Where a face separates two enlarged
// cells, the cells themselves are farther apart than the skin. This costs as much as one pass over the
// candidates.
#ifndef TETLAP_CONTACT_SEARCH_NEAR_H
#define TETLAP_CONTACT_SEARCH_NEAR_H

#include "contact/search/candidates.h"

typedef struct ContactNear {
  ContactCandidateList list; // margins: none
  bool is_made;
  double skin;           // [m]
  long long searches;    // of the candidates that it was made from
  double *reference;     // where everything was then [m]              (position_count, 3)
  double reference_time; // [s]
  // Scratch memory.
  ContactMotion *motions;   // of each party since then                (party_count)
  double (*blown)[12];      // enlarged cells                          (cell_count)
  double (*boxes)[6];       // of those                                (cell_count)
  unsigned char *is_listed; // 0 between calls                         (cell_count)
  bool *is_kept;            // candidates                              (kept_capacity)
  size_t kept_capacity;
} ContactNear;

Status contact_near_create(ContactNear *near, const ContactLayout *layout);
void contact_near_destroy(ContactNear *near);

// After contact_candidates_update at these positions: makes the list anew where the candidates are new, the
// next step may use up the skin, or at the speeds of now a much thinner one would do.
Status contact_near_update(ContactNear *near, const ContactLayout *layout,
                           const ContactCandidates *candidates, double time, const double *positions);

// The candidates that it was made from are gone.
void contact_near_forget(ContactNear *near);

// The list to evaluate these positions by, which the candidates cover: its own or that of all candidates.
const ContactCandidateList *contact_near_choose(ContactNear *near, const ContactLayout *layout,
                                                const ContactCandidates *candidates, double time,
                                                const double *positions);

#endif
