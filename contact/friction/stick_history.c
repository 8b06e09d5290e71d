// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick_history.h"

#include <math.h>
#include <stdlib.h>

enum { INTERFACE_SIZE = 3 + 2, ENTRY_SIZE = CONTACT_STICK_ENTRY_SIZE };

size_t contact_stick_history_count(int interface_count, int entry_count) {
  return 1 + INTERFACE_SIZE * (size_t)interface_count + ENTRY_SIZE * (size_t)entry_count;
}

ContactStickHistory contact_stick_history_view(int interface_count, double *values, size_t count) {
  size_t interfaces = (size_t)interface_count;
  double *forces = values + 1, *areas = forces + 3 * interfaces, *entries = areas + 2 * interfaces;
  return (ContactStickHistory){.dissipated = values,
                               .forces = (double(*)[3])forces,
                               .areas = (double(*)[2])areas,
                               .entries = (ContactStickEntry *)entries,
                               .interface_count = interface_count,
                               .entry_count = (int)((count - (size_t)(entries - values)) / ENTRY_SIZE)};
}

static int compare(const void *one, const void *other) {
  const ContactStickEntry *a = one, *b = other;
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

const ContactStickEntry *contact_stick_history_find(const ContactStickHistory *history, int interface,
                                                    int vertex) {
  if (history->entry_count == 0) return NULL;
  const ContactStickEntry key = {.interface = interface, .vertex = vertex};
  return bsearch(&key, history->entries, (size_t)history->entry_count, sizeof key, compare);
}

void contact_stick_history_sort(ContactStickHistory *history) {
  if (history->entry_count > 1)
    qsort(history->entries, (size_t)history->entry_count, sizeof *history->entries, compare);
}

static bool is_number_below(double value, int bound) {
  return value >= 0 && value < bound && value == floor(value);
}

Status contact_stick_history_check(int interface_count, int vertex_count, const double *values,
                                   size_t count) {
  size_t own = contact_stick_history_count(interface_count, 0);
  bool fits = count >= own && (count - own) % ENTRY_SIZE == 0;
  for (size_t i = own; fits && i < count; i += ENTRY_SIZE)
    fits = is_number_below(values[i], interface_count) && is_number_below(values[i + 1], vertex_count);
  if (fits) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "the checkpoint's friction does not fit: %zu numbers, for a scene with %d interfaces and "
      "%d vertices",
      count, interface_count, vertex_count);
}
