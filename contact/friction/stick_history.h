// SPDX-License-Identifier: GPL-3.0-or-later
// What friction by elastic stick (contact/friction/stick.h) keeps between accepted states: a short list of
// vertices in contact, each with its stretch in the rest frame of its body.
#ifndef TETLAP_CONTACT_STICK_HISTORY_H
#define TETLAP_CONTACT_STICK_HISTORY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

// A vertex of a slave body that was pressed in the last accepted state.
typedef struct ContactStickEntry {
  int interface, vertex;
  double stretch[3]; // S_a, in the rest frame [m]
  double energy;     // ½ k_a s² as it was stored [J]
  double limit;      // μ N_a then [N]
} ContactStickEntry;

// By interface, then by vertex.
typedef struct ContactStickHistory {
  ContactStickEntry *entries; //                                    (count)
  int count;
  size_t capacity;
} ContactStickHistory;

enum { CONTACT_STICK_ENTRY_SIZE = 7 }; // numbers an entry is kept as

void contact_stick_history_destroy(ContactStickHistory *history);

// The entry of that vertex, NULL: there is none.
const ContactStickEntry *contact_stick_history_find(const ContactStickHistory *history, int interface,
                                                    int vertex);

// Appends; the list must be sorted before entries are looked up.
Status contact_stick_history_add(ContactStickHistory *history, const ContactStickEntry *entry);
void contact_stick_history_sort(ContactStickHistory *history);

// As numbers for a checkpoint, a new array of the caller's (count, CONTACT_STICK_ENTRY_SIZE), and back, to
// the bit. STATUS_INPUT: these are no entries of so many interfaces and vertices.
Status contact_stick_history_save(const ContactStickHistory *history, double **values, size_t *count);
Status contact_stick_history_load(ContactStickHistory *history, const double *values, size_t count,
                                  int interface_count, int vertex_count);

#endif
