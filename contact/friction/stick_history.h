// SPDX-License-Identifier: GPL-3.0-or-later
// What friction by elastic stick (contact/friction/stick.h) remembers of the last accepted state: what was
// dissipated so far, what acted in each interface, and the vertices in contact with their stretch in the
// rest frame of their body. It is one array of numbers, so it can be copied and written as it is:
//
//   dissipated [J]
//   forces [N] on side 0, areas [m²] that stick and that slide    (interface_count, 3), (interface_count, 2)
//   entries, by interface, then by vertex                         (entry_count, CONTACT_STICK_ENTRY_SIZE)
#ifndef TETLAP_CONTACT_FRICTION_STICK_HISTORY_H
#define TETLAP_CONTACT_FRICTION_STICK_HISTORY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

// A vertex of a slave body that was pressed in the last accepted state, or in an earlier one: of one that has
// left only `way` and `work` are not 0.
typedef struct ContactStickEntry {
  double interface, vertex; // their numbers
  double stretch[3];        // S_a, in the rest frame [m]
  double energy;            // ½ k_a s² as it was stored [J]
  double limit;             // μ N_a then, or what is left of μ_s N_a [N]
  double weak;              // w: the share of μ_s − μ that it has lost since it stuck
  double slides;            // 1: at its limit; 0: it sticks, or has left
  double slip[3];           // slid since it was last touched, in the rest frame [m]
  double slid[3];           // the same in space, as it lay then [m]
  double way;               // Σ of the lengths slid so far [m]
  double work;              // dissipated at it so far [J]
} ContactStickEntry;

enum { CONTACT_STICK_ENTRY_SIZE = sizeof(ContactStickEntry) / sizeof(double) };

// A view of such an array.
typedef struct ContactStickHistory {
  double *dissipated;
  double (*forces)[3];        //                                   (interface_count)
  double (*areas)[2];         //                                   (interface_count)
  ContactStickEntry *entries; //                                   (entry_count)
  int interface_count, entry_count;
} ContactStickHistory;

// How many numbers a history with so many interfaces and entries has.
size_t contact_stick_history_count(int interface_count, int entry_count);

// The view of an array of `count` numbers, which is borrowed.
ContactStickHistory contact_stick_history_view(int interface_count, double *values, size_t count);

// The entry of that vertex, NULL: there is none.
const ContactStickEntry *contact_stick_history_find(const ContactStickHistory *history, int interface,
                                                    int vertex);

// Orders entries, which contact_stick_history_find needs.
void contact_stick_history_sort(ContactStickHistory *history);

// STATUS_INPUT: `count` numbers that are no history of so many interfaces and vertices.
Status contact_stick_history_check(int interface_count, int vertex_count, const double *values, size_t count);

#endif
