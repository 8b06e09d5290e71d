// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/passage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/shape/convex.h"
#include "contact/shape/shape.h"
#include "contact/surface/middle.h"

// |h| from which on a direction is one, and the part of h along the kept direction, or against it, from which
// on an element is not turned, or is.
static const double CLEAR = 0.5, TURNED = 0.5;
// The least reach of what is turned, and, by its cube, the least covered share.
static const double REACH = 0.1;

static double cube(double side) {
  return side * side * side;
}

// The share of a volume below which all is rounding.
static double rounding(void) {
  return cube(REACH * REACH);
}

void contact_passage_destroy(ContactPassage *passage) {
  memory_free(passage->now.entries);
  memory_free(passage->next.entries);
  memory_free(passage->meetings);
  memory_free(passage->middles);
  *passage = (ContactPassage){0};
}

// Of the cell, or of the shape that stands for it.
static double volume_of(const ContactLayout *layout, int cell) {
  return cell < 0 ? INFINITY : layout->cell_volumes[cell];
}

// What the element on side `side` of pair k meets in it.
static void add_pair(const ContactPassage *passage, const ContactLayout *layout,
                     const ContactEvaluation *evaluation, int k, int side, ContactPassageMeeting *meeting) {
  const ContactFieldPair *field = &evaluation->fields[k];
  const ContactPair *pair = &evaluation->pairs[k];
  int own = pair->cells[side], other = pair->cells[1 - side];
  double lesser =
      fmin(other < 0 ? layout->tet_volumes[contact_mesh_tet(&layout->mesh, own)] : layout->cell_volumes[own],
           volume_of(layout, other));
  meeting->volume += field->volume;
  meeting->other += volume_of(layout, other);
  if (!(field->volume >= rounding() * lesser)) return;
  Vec3 slope = vec3_at(field->slopes[1 - side]);
  vec3_accumulate(meeting->slope, vec3_scale(field->weighed[side], slope));
  meeting->size += field->weighed[side] * vec3_length(slope);
  if (!passage->middles) return;
  double middle = other < 0
                      ? contact_shape_middle(&layout->def.shapes[layout->interfaces[pair->interface].shape])
                      : passage->middles[other];
  meeting->reach = fmax(meeting->reach, field->depths[1 - side] / middle);
}

static void find_meetings(ContactPassage *passage, const ContactLayout *layout,
                          const ContactEvaluation *evaluation) {
  const ContactPatches *patches = &evaluation->patches;
  for (int e = 0; e < patches->element_count; e++) passage->meetings[e] = (ContactPassageMeeting){0};
  for (int k = 0; k < evaluation->pair_count; k++)
    for (int side = 0; side < 2; side++) {
      int e = patches->pair_elements[k][side];
      if (e < 0) continue;
      add_pair(passage, layout, evaluation, k, side, &passage->meetings[e]);
    }
  for (int e = 0; e < patches->element_count; e++) {
    ContactPassageMeeting *meeting = &passage->meetings[e];
    meeting->covered = meeting->volume / fmin(layout->tet_volumes[patches->elements[e].tet], meeting->other);
  }
}

static int compare_entries(const void *first, const void *second) {
  const ContactPassageEntry *a = first, *b = second;
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  return (a->tet > b->tet) - (a->tet < b->tet);
}

static void sort(ContactPassageList *list) {
  if (list->count > 1) qsort(list->entries, (size_t)list->count, sizeof *list->entries, compare_entries);
}

// Whether it is deep enough in the other one to be turned there.
static bool is_inside(const ContactPassageEntry *meeting, bool has_field) {
  if (!has_field) return meeting->covered > REACH;
  return meeting->reach > REACH && meeting->covered > cube(REACH);
}

// What the element becomes where it meets the other one like this; the meeting's direction is h, |h| ≤ 1.
static void meet(ContactPassageEntry *entry, const ContactPassageEntry *meeting, bool has_field) {
  Vec3 kept = vec3_at(entry->direction), h = vec3_at(meeting->direction);
  double length = vec3_length(h), along = vec3_dot(h, kept);
  bool is_known = vec3_length(kept) > 0;
  entry->reach = meeting->reach;
  entry->covered = meeting->covered;
  if (!(meeting->covered >= rounding())) return;
  if (is_known && along < -TURNED && is_inside(meeting, has_field)) entry->is_turned = true;
  if (is_known && along > TURNED) entry->is_turned = false;
  bool is_followed = !is_known || (!entry->is_turned && along > 0);
  if (length > CLEAR && is_followed) vec3_store(entry->direction, vec3_scale(1 / length, h));
}

static Status reserve(ContactPassageList *list, size_t count) {
  return memory_reserve((void **)&list->entries, &list->capacity, count, sizeof *list->entries)
             ? STATUS_OK
             : status_no_memory("elements that pass through bodies");
}

// The elements of the evaluation's patches; `direction` holds h.
static void list_elements(ContactPassage *passage, const ContactPatches *patches) {
  ContactPassageList *next = &passage->next;
  next->count = 0;
  for (int p = 0; p < patches->patch_count; p++)
    for (int e = patches->patches[p].element_begin; e < patches->patches[p].element_end; e++) {
      const ContactPassageMeeting *meeting = &passage->meetings[e];
      Vec3 h = meeting->size > 0 ? vec3_scale(1 / meeting->size, vec3_at(meeting->slope)) : (Vec3){0, 0, 0};
      ContactPassageEntry *entry = &next->entries[next->count++];
      *entry = (ContactPassageEntry){.interface = patches->patches[p].interface,
                                     .tet = patches->elements[e].tet,
                                     .reach = meeting->reach,
                                     .covered = meeting->covered};
      vec3_store(entry->direction, h);
    }
  sort(next);
}

static void leave(ContactPassage *passage, const ContactPassageEntry *entry) {
  if (!entry->is_turned) return;
  if (passage->passed++ == 0) passage->first = *entry;
}

// Both lists are in order: what is in both goes on, what is in `now` alone has left, or lies at rest.
static void match(ContactPassage *passage, const ContactSystem *system) {
  ContactPassageList *now = &passage->now, *next = &passage->next;
  int listed = next->count, i = 0;
  bool has_field = contact_layout_has_field(contact_system_layout(system));
  for (int k = 0; k < listed; k++) {
    ContactPassageEntry *entry = &next->entries[k], meeting = *entry;
    for (; i < now->count && compare_entries(&now->entries[i], entry) < 0; i++) {
      if (contact_system_is_resting(system, now->entries[i].interface))
        next->entries[next->count++] = now->entries[i];
      else
        leave(passage, &now->entries[i]);
    }
    vec3_store(entry->direction, (Vec3){0, 0, 0});
    if (i < now->count && compare_entries(&now->entries[i], entry) == 0) *entry = now->entries[i++];
    meet(entry, &meeting, has_field);
  }
  for (; i < now->count; i++) {
    if (contact_system_is_resting(system, now->entries[i].interface))
      next->entries[next->count++] = now->entries[i];
    else
      leave(passage, &now->entries[i]);
  }
  if (next->count > listed) sort(next);
}

static Status find_middles(ContactPassage *passage, const ContactLayout *layout) {
  if (passage->middles || !contact_layout_has_field(layout)) return STATUS_OK;
  return contact_middle_find(&layout->mesh, layout->def.tets, layout->rest, &passage->middles);
}

Status contact_passage_look(ContactPassage *passage, const ContactSystem *system,
                            const ContactEvaluation *evaluation) {
  size_t elements = (size_t)evaluation->patches.element_count;
  passage->passed = 0;
  if (!memory_reserve((void **)&passage->meetings, &passage->meeting_capacity, elements,
                      sizeof *passage->meetings))
    return status_no_memory("elements that pass through bodies");
  TRY(reserve(&passage->next, elements + (size_t)passage->now.count));
  TRY(find_middles(passage, contact_system_layout(system)));
  find_meetings(passage, contact_system_layout(system), evaluation);
  list_elements(passage, &evaluation->patches);
  match(passage, system);
  return STATUS_OK;
}

void contact_passage_accept(ContactPassage *passage) {
  ContactPassageList now = passage->now;
  passage->now = passage->next;
  passage->next = now;
  passage->passed = 0;
}

int contact_passage_turned(const ContactPassage *passage, ContactPassageEntry *first) {
  int count = 0;
  for (int i = 0; i < passage->now.count; i++) {
    if (!passage->now.entries[i].is_turned) continue;
    if (count++ == 0) *first = passage->now.entries[i];
  }
  return count;
}

int contact_passage_inside(const ContactPassage *passage, ContactPassageEntry *first) {
  int count = 0;
  for (int i = 0; i < passage->now.count; i++) {
    const ContactPassageEntry *entry = &passage->now.entries[i];
    if (!(entry->covered > 1 - rounding() && entry->reach > 0.5)) continue;
    if (count++ == 0) *first = *entry;
  }
  return count;
}

void contact_passage_save(const ContactPassage *passage, double *values) {
  for (int i = 0; i < passage->now.count; i++, values += CONTACT_PASSAGE_KEPT) {
    const ContactPassageEntry *entry = &passage->now.entries[i];
    values[0] = entry->interface, values[1] = entry->tet, values[2] = entry->is_turned;
    memcpy(values + 3, entry->direction, sizeof entry->direction);
  }
}

Status contact_passage_load(ContactPassage *passage, int count, const double *values) {
  TRY(reserve(&passage->now, (size_t)count));
  passage->now.count = count;
  for (int i = 0; i < count; i++, values += CONTACT_PASSAGE_KEPT) {
    passage->now.entries[i] = (ContactPassageEntry){
        .interface = (int)values[0], .tet = (int)values[1], .is_turned = values[2] != 0};
    memcpy(passage->now.entries[i].direction, values + 3, 3 * sizeof *values);
  }
  return STATUS_OK;
}
