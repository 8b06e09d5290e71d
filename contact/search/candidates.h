// SPDX-License-Identifier: GPL-3.0-or-later
// The pairs that may overlap until the next search, interface by interface. Each interface has a margin, by
// which its two parties may come nearer before a new search. While no pair is near the margin is the distance
// of the parties, then half an element, so that no element passes through another between two searches.
// Motion that two bodies have in common, as in a falling stack, does not use the margin up.
#ifndef TETLAP_CONTACT_SEARCH_CANDIDATES_H
#define TETLAP_CONTACT_SEARCH_CANDIDATES_H

#include "contact/search/broad.h"
#include "contact/search/layout.h"
#include "contact/search/motion.h"

// Valid while the two parties of an interface have come nearer by no more than its margin.
typedef struct ContactCandidateList {
  int count;
  size_t capacity;
  ContactPair *pairs; // by interface, then by cells                      (count)
  int *begin;         // of each interface                               (interface_count + 1)
  double *margins;    // of each interface [m]                           (interface_count)
  int *cells;         // those of mesh pairs, distinct                (cell_count)
  int cell_count;
} ContactCandidateList;

// What a search finds in one interface.
typedef struct ContactFound {
  ContactPairList pairs; // of cells, −1: a shape
  double margin;
  Status status;
} ContactFound;

// A list that a search found, with all that the search depends on.
typedef struct ContactKeptCandidates {
  ContactCandidateList list;
  double *positions; // [m]; NULL: nothing is kept                        (position_count, 3)
  double time;
  ContactShape *shapes;    // as they stood                               (shape_count)
  ContactMotion *expected; // in the next step                            (party_count)
  bool *is_left_out;       // (interface_count)
} ContactKeptCandidates;

typedef struct ContactCandidates {
  ContactCandidateList list;
  bool is_made;
  bool is_fresh;     // made by the last update
  bool *is_left_out; // interfaces that are not searched: at rest (contact/rest.h)   (interface_count)
  long long searches;
  double search_s;
  // Where everything was when the list was made.
  double *reference; // [m]                                           (position_count, 3)
  double reference_time;
  double time_left; // for which the list is expected to hold, at the speeds of the last update [s]
  ContactKeptCandidates kept;
  // Scratch memory.
  ContactFound *found; // of each interface                       (found_count)
  int found_count;
  unsigned char *is_listed; // 0 between calls                        (cell_count)
  double (*boxes)[6];       // of each body                                 (body_count)
  ContactMotion *motions;   // of each party since the search          (party_count)
  ContactMotion *expected;  // in the next step                        (party_count)
} ContactCandidates;

Status contact_candidates_create(ContactCandidates *candidates, const ContactLayout *layout);
void contact_candidates_destroy(ContactCandidates *candidates);

// Searches anew if the motion asks for it.
Status contact_candidates_update(ContactCandidates *candidates, const ContactLayout *layout, double time,
                                 const double *positions, const double *velocities, double step);

// Sets which interfaces are not searched from now on (interface_count); NULL: all are. Their pairs leave the
// list; when an interface is searched again the list must be made anew.
void contact_candidates_leave_out(ContactCandidates *candidates, const ContactLayout *layout,
                                  const bool *is_left_out);

// Keeps the list, if the last update made it, until the next call: a list that is made anew where a search
// would find the same is a copy.
Status contact_candidates_keep(ContactCandidates *candidates, const ContactLayout *layout);

// Whether the list still holds every overlapping pair; NaN: false.
bool contact_candidates_cover(ContactCandidates *candidates, const ContactLayout *layout, double time,
                              const double *positions);

// At the positions that contact_candidates_cover was asked for last: how near two of an interface may be at
// most so that the list is sure to hold them [m].
double contact_candidates_reach(const ContactCandidates *candidates, const ContactLayout *layout,
                                int interface);

// The same after any update, which leaves at most one of the steps that a margin is made for used up, for all
// interfaces that are searched; INFINITY: there are none.
double contact_candidates_least_reach(const ContactLayout *layout);

// The boxes of the list's tetrahedra at these positions, into boxes (cell_count); others are
// left alone.
void contact_candidates_bound(const ContactCandidateList *list, const ContactLayout *layout,
                              const double *positions, double (*boxes)[6]);

// Fills `cells` from the list's pairs; is_listed (cell_count): 0 before and after.
void contact_candidates_list_cells(ContactCandidateList *list, unsigned char *is_listed);

#endif
