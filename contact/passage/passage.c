// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/passage/passage.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/limits.h"
#include "contact/surface/middle.h"

// |h| from which on a direction is one, and the part of h along the kept direction, or against it, from which
// on an element is not turned, or is.
static const double CLEAR = 0.5, TURNED = 0.5;
// The least reach of what is turned, and, by its cube, the least covered share.
static const double REACH = 0.1;

// In place of a cell: an element that has not met this part before.
enum { NEW = -2 };

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
  contact_meetings_destroy(&passage->meetings);
  memory_free(passage->middles);
  memory_free(passage->is_followed);
  *passage = (ContactPassage){0};
}

// ---- An element and what it meets.

// h, 0 where there is none.
static Vec3 direction_of(const ContactMeeting *meeting) {
  return meeting->size > 0 ? vec3_scale(1 / meeting->size, vec3_at(meeting->slope)) : (Vec3){0, 0, 0};
}

// Whether it is deep enough in the other one to be turned there.
static bool is_deep(const ContactMeeting *meeting, bool has_field) {
  if (!has_field) return meeting->covered > REACH;
  return meeting->reach > REACH && meeting->covered > cube(REACH);
}

// Whether the element may have come from one side of the middle to the other since the state where the lists
// were made, which was judged, too: it moves by the margin at most.
static bool may_cross(const ContactPassage *passage, const ContactMeeting *meeting, double margin) {
  if (!passage->middles || meeting->cell < 0) return true;
  return passage->middles[meeting->cell] * (1 - meeting->reach) <= margin;
}

// What the element becomes where it meets the other one like this.
static void meet(ContactPassageEntry *entry, const ContactMeeting *meeting, bool has_field,
                 bool is_crossing) {
  Vec3 kept = vec3_at(entry->direction), h = direction_of(meeting);
  double length = vec3_length(h), along = vec3_dot(h, kept);
  bool is_known = vec3_length(kept) > 0, is_opposed = is_known && along < -TURNED;
  entry->cell = meeting->cell;
  entry->reach = meeting->reach;
  entry->covered = meeting->covered;
  entry->is_deep = is_deep(meeting, has_field) || (entry->is_deep && is_opposed && is_crossing);
  if (!(meeting->covered >= rounding())) return;
  if (is_opposed && entry->is_deep) entry->is_turned = true;
  if (is_known && along > TURNED) entry->is_turned = false;
  bool is_followed = !is_known || (!entry->is_turned && (along > 0 || !entry->is_deep));
  if (length > CLEAR && is_followed) vec3_store(entry->direction, vec3_scale(1 / length, h));
}

static Status reserve(ContactPassageList *list, size_t count) {
  return memory_reserve((void **)&list->entries, &list->capacity, count, sizeof *list->entries)
             ? STATUS_OK
             : status_no_memory("elements that pass through bodies");
}

static int compare(const ContactPassageEntry *entry, int interface, int tet) {
  if (entry->interface != interface) return entry->interface < interface ? -1 : 1;
  return (entry->tet > tet) - (entry->tet < tet);
}

// Counts an entry's element; the entries of one come after each other.
static void count_element(ContactPassageCount *count, const ContactPassageEntry *entry) {
  if (count->elements > 0 && compare(entry, count->last.interface, count->last.tet) == 0) return;
  if (count->elements++ == 0) count->first = *entry;
  count->last = *entry;
}

static void leave(ContactPassage *passage, const ContactPassageEntry *entry) {
  if (entry->is_turned) count_element(&passage->passed, entry);
}

// ---- From one accepted state to the next.

static Vec3 middle_at_rest(const ContactLayout *layout, int cell) {
  double coordinates[12];
  Vec3 sum = {0, 0, 0};
  contact_layout_gather(layout, cell, layout->rest, coordinates);
  for (int v = 0; v < 4; v++) sum = vec3_add(sum, vec3_at(coordinates + 3 * v));
  return vec3_scale(0.25, sum);
}

// How surely the part is that of the cell: by the vertices that the cell has in common with one of the
// part's, 0 where it lies elsewhere.
static int likeness(const ContactMeetings *meetings, const ContactLayout *layout,
                    const ContactMeeting *meeting, int cell) {
  int common = contact_meetings_common(meetings, &layout->mesh, meeting, cell);
  if (common > 0 || cell < 0 || meeting->cell < 0) return 2 * common;
  Vec3 way = vec3_sub(middle_at_rest(layout, cell), middle_at_rest(layout, meeting->cell));
  return vec3_length(way) <= layout->margin;
}

// The part among those from `begin` on that the entry goes on in, −1: none. Of a cell that one has, with its
// four vertices, no other has any.
static int find_part(const ContactMeetings *meetings, const ContactLayout *layout, int begin, int end,
                     const ContactPassageEntry *entry) {
  int best = -1, most = 0;
  for (int m = begin; m < end && most < 2 * 4; m++) {
    int found = likeness(meetings, layout, &meetings->list[m], entry->cell);
    if (found > most) most = found, best = m;
  }
  return best;
}

// Whether of two entries that go on in one part it is the first that stays: what is turned, or else may still
// turn, is not forgotten.
static bool fits_better(const ContactPassageEntry *entry, const ContactPassageEntry *other,
                        const ContactMeeting *meeting) {
  Vec3 kept = vec3_at(entry->direction), other_kept = vec3_at(other->direction), h = direction_of(meeting);
  bool is_known = vec3_length(kept) > 0, is_other_known = vec3_length(other_kept) > 0;
  if (entry->is_turned != other->is_turned) return entry->is_turned;
  if (is_known != is_other_known) return is_known;
  if (entry->is_deep != other->is_deep) return entry->is_deep;
  return vec3_dot(kept, h) > vec3_dot(other_kept, h);
}

static void append(ContactPassageList *list, const ContactPassageEntry *entry) {
  list->entries[list->count++] = *entry;
}

// Entries of elements that meet nothing: they have left, or lie at rest.
static void leave_before(ContactPassage *passage, const ContactSystem *system, int *i, int interface,
                         int tet) {
  const ContactPassageList *now = &passage->now;
  for (; *i < now->count && compare(&now->entries[*i], interface, tet) < 0; (*i)++) {
    if (contact_system_is_resting(system, now->entries[*i].interface))
      append(&passage->next, &now->entries[*i]);
    else
      leave(passage, &now->entries[*i]);
  }
}

// The entries of one element, from *i on, and the parts that it meets.
static void match_element(ContactPassage *passage, const ContactLayout *layout, int *i, int begin, int end) {
  const ContactMeetings *meetings = &passage->meetings;
  const ContactMeeting *first = &meetings->list[begin];
  ContactPassageList *now = &passage->now, *next = &passage->next;
  ContactPassageEntry *entries = next->entries + next->count;
  for (int m = begin; m < end; m++)
    append(next, &(ContactPassageEntry){.interface = first->interface, .tet = first->tet, .cell = NEW});
  for (; *i < now->count && compare(&now->entries[*i], first->interface, first->tet) == 0; (*i)++) {
    const ContactPassageEntry *entry = &now->entries[*i];
    int m = find_part(meetings, layout, begin, end, entry);
    if (m < 0)
      leave(passage, entry);
    else if (entries[m - begin].cell == NEW || fits_better(entry, &entries[m - begin], &meetings->list[m]))
      entries[m - begin] = *entry;
  }
  for (int m = begin; m < end; m++)
    meet(&entries[m - begin], &meetings->list[m], contact_layout_has_field(layout),
         may_cross(passage, &meetings->list[m], layout->margin));
}

// Both lists are in order.
static void match(ContactPassage *passage, const ContactSystem *system) {
  const ContactLayout *layout = contact_system_layout(system);
  const ContactMeetings *meetings = &passage->meetings;
  int i = 0;
  for (int begin = 0, end; begin < meetings->count; begin = end) {
    const ContactMeeting *first = &meetings->list[begin];
    for (end = begin + 1; end < meetings->count; end++)
      if (meetings->list[end].interface != first->interface || meetings->list[end].tet != first->tet) break;
    leave_before(passage, system, &i, first->interface, first->tet);
    match_element(passage, layout, &i, begin, end);
  }
  leave_before(passage, system, &i, INT_MAX, INT_MAX);
}

// By how much elements move from one accepted state to the next at most [m]. The lists hold for the margin,
// and the first of the states may have used up the share of one step, in any direction.
static double longest_way(const ContactLayout *layout) {
  return layout->margin + layout->margin / CONTACT_STEPS_AHEAD;
}

// Of each interface: without depths; where an element reaches half as deep as one that may turn, or may have
// crossed the middle at the next state; where one of the list may turn or has.
static Status follow(ContactPassage *passage, const ContactLayout *layout,
                     const ContactEvaluation *evaluation, const ContactPassageList *list) {
  size_t count = (size_t)layout->interface_count;
  if (!memory_reserve((void **)&passage->is_followed, &passage->followed_capacity, count,
                      sizeof *passage->is_followed))
    return status_no_memory("elements that pass through bodies");
  for (size_t i = 0; i < count; i++) passage->is_followed[i] = !passage->middles;
  for (int i = 0; i < list->count; i++) {
    const ContactPassageEntry *entry = &list->entries[i];
    if (entry->is_turned || entry->is_deep) passage->is_followed[entry->interface] = true;
  }
  if (passage->middles)
    contact_meetings_mark(layout, evaluation, passage->middles, REACH / 2, longest_way(layout),
                          passage->is_followed);
  return STATUS_OK;
}

// Of `next`, what a second look at the state would not follow; an interface at rest has no meetings to judge
// by.
static Status drop(ContactPassage *passage, const ContactSystem *system,
                   const ContactEvaluation *evaluation) {
  ContactPassageList *next = &passage->next;
  const int count = next->count;
  if (count == 0) return STATUS_OK;
  TRY(follow(passage, contact_system_layout(system), evaluation, next));
  next->count = 0;
  for (int i = 0; i < count; i++) {
    const ContactPassageEntry entry = next->entries[i];
    if (passage->is_followed[entry.interface] || contact_system_is_resting(system, entry.interface))
      append(next, &entry);
  }
  return STATUS_OK;
}

static Status find_middles(ContactPassage *passage, const ContactLayout *layout) {
  if (passage->middles || !contact_layout_has_field(layout)) return STATUS_OK;
  return contact_middle_find(&layout->mesh, layout->def.tets, layout->rest, &passage->middles);
}

Status contact_passage_look(ContactPassage *passage, const ContactSystem *system,
                            const ContactEvaluation *evaluation) {
  const ContactLayout *layout = contact_system_layout(system);
  passage->passed.elements = 0;
  passage->next.count = 0;
  TRY(find_middles(passage, layout));
  TRY(follow(passage, layout, evaluation, &passage->now));
  TRY(contact_meetings_find(&passage->meetings, layout, evaluation, passage->middles, rounding(),
                            passage->is_followed));
  TRY(reserve(&passage->next, (size_t)passage->meetings.count + (size_t)passage->now.count));
  match(passage, system);
  return drop(passage, system, evaluation);
}

void contact_passage_accept(ContactPassage *passage) {
  ContactPassageList now = passage->now;
  passage->now = passage->next;
  passage->next = now;
  passage->passed.elements = 0;
}

ContactPassageCount contact_passage_turned(const ContactPassage *passage) {
  ContactPassageCount count = {.elements = 0};
  for (int i = 0; i < passage->now.count; i++)
    if (passage->now.entries[i].is_turned) count_element(&count, &passage->now.entries[i]);
  return count;
}

ContactPassageCount contact_passage_inside(const ContactPassage *passage) {
  ContactPassageCount count = {.elements = 0};
  for (int i = 0; i < passage->now.count; i++) {
    const ContactPassageEntry *entry = &passage->now.entries[i];
    if (entry->covered > 1 - rounding() && entry->reach > 0.5) count_element(&count, entry);
  }
  return count;
}

void contact_passage_save(const ContactPassage *passage, double *values) {
  for (int i = 0; i < passage->now.count; i++, values += CONTACT_PASSAGE_KEPT) {
    const ContactPassageEntry *entry = &passage->now.entries[i];
    values[0] = entry->interface, values[1] = entry->tet, values[2] = entry->is_turned;
    memcpy(values + 3, entry->direction, sizeof entry->direction);
    values[6] = entry->cell, values[7] = entry->is_deep;
  }
}

Status contact_passage_load(ContactPassage *passage, int count, const double *values) {
  TRY(reserve(&passage->now, (size_t)count));
  passage->now.count = count;
  for (int i = 0; i < count; i++, values += CONTACT_PASSAGE_KEPT) {
    passage->now.entries[i] = (ContactPassageEntry){.interface = (int)values[0],
                                                    .tet = (int)values[1],
                                                    .cell = (int)values[6],
                                                    .is_turned = values[2] != 0,
                                                    .is_deep = values[7] != 0};
    memcpy(passage->now.entries[i].direction, values + 3, 3 * sizeof *values);
  }
  return STATUS_OK;
}
