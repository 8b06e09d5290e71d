// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick_history.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vec3.h"

void contact_stick_history_destroy(ContactStickHistory *history) {
  memory_free(history->entries);
  *history = (ContactStickHistory){0};
}

static int compare(const void *one, const void *other) {
  const ContactStickEntry *a = one, *b = other;
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  return (a->vertex > b->vertex) - (a->vertex < b->vertex);
}

const ContactStickEntry *contact_stick_history_find(const ContactStickHistory *history, int interface,
                                                    int vertex) {
  if (history->count == 0) return NULL;
  const ContactStickEntry key = {.interface = interface, .vertex = vertex};
  return bsearch(&key, history->entries, (size_t)history->count, sizeof key, compare);
}

Status contact_stick_history_add(ContactStickHistory *history, const ContactStickEntry *entry) {
  if (!memory_reserve((void **)&history->entries, &history->capacity, (size_t)history->count + 1,
                      sizeof *history->entries))
    return status_no_memory("friction");
  history->entries[history->count++] = *entry;
  return STATUS_OK;
}

void contact_stick_history_sort(ContactStickHistory *history) {
  if (history->count > 1) qsort(history->entries, (size_t)history->count, sizeof *history->entries, compare);
}

Status contact_stick_history_save(const ContactStickHistory *history, double **values, size_t *count) {
  *count = CONTACT_STICK_ENTRY_SIZE * (size_t)history->count;
  *values = memory_zeroed(*count, sizeof **values);
  if (!*values) return status_no_memory("a checkpoint");
  for (int i = 0; i < history->count; i++) {
    const ContactStickEntry *entry = &history->entries[i];
    double *value = *values + CONTACT_STICK_ENTRY_SIZE * (size_t)i;
    value[0] = entry->interface;
    value[1] = entry->vertex;
    vec3_store(value + 2, vec3_at(entry->stretch));
    value[5] = entry->energy;
    value[6] = entry->limit;
  }
  return STATUS_OK;
}

static bool is_number_below(double value, int bound) {
  return value >= 0 && value < bound && value == floor(value);
}

Status contact_stick_history_load(ContactStickHistory *history, const double *values, size_t count,
                                  int interface_count, int vertex_count) {
  history->count = 0;
  for (size_t i = 0; i < count; i += CONTACT_STICK_ENTRY_SIZE) {
    const double *value = values + i;
    if (count % CONTACT_STICK_ENTRY_SIZE != 0 || !is_number_below(value[0], interface_count) ||
        !is_number_below(value[1], vertex_count))
      return status_fail(STATUS_INPUT,
                         "the checkpoint's friction does not fit: there are %d interfaces and %d vertices",
                         interface_count, vertex_count);
    ContactStickEntry entry = {
        .interface = (int)value[0], .vertex = (int)value[1], .energy = value[5], .limit = value[6]};
    vec3_store(entry.stretch, vec3_at(value + 2));
    TRY(contact_stick_history_add(history, &entry));
  }
  contact_stick_history_sort(history);
  return STATUS_OK;
}
