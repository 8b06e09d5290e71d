// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/passage/meetings.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/shape/convex.h"
#include "contact/shape/shape.h"

void contact_meetings_destroy(ContactMeetings *meetings) {
  memory_free(meetings->list);
  memory_free(meetings->cells);
  memory_free(meetings->begin);
  memory_free(meetings->items);
  memory_free(meetings->parts);
  memory_free(meetings->first);
  *meetings = (ContactMeetings){0};
}

// What one call works on.
typedef struct Work {
  ContactMeetings *meetings;
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const double *middles;
  double rounding;
} Work;

// ---- What is deep.

// Of what that side's element is in: a cell or a shape.
static double middle_of(const ContactLayout *layout, const ContactPair *pair, int side,
                        const double *middles) {
  int other = pair->cells[1 - side];
  return other < 0 ? contact_shape_middle(&layout->def.shapes[layout->interfaces[pair->interface].shape])
                   : middles[other];
}

void contact_meetings_mark(const ContactLayout *layout, const ContactEvaluation *evaluation,
                           const double *middles, double least, double way, bool *is_marked) {
  for (int k = 0; k < evaluation->pair_count; k++) {
    const ContactPair *pair = &evaluation->pairs[k];
    if (is_marked[pair->interface]) continue;
    for (int side = 0; side < 2; side++) {
      if (pair->cells[side] < 0) continue;
      double middle = middle_of(layout, pair, side, middles), depth = evaluation->fields[k].depths[1 - side];
      if (!(depth < least * middle) || middle - depth <= way) is_marked[pair->interface] = true;
    }
  }
}

// ---- The items of each element.

static Status reserve(ContactMeetings *meetings, const ContactLayout *layout,
                      const ContactEvaluation *evaluation) {
  size_t items = 2 * (size_t)evaluation->pair_count, known = meetings->first_capacity;
  size_t positions = (size_t)layout->mesh.position_count;
  bool has_room =
      memory_reserve((void **)&meetings->list, &meetings->list_capacity, items, sizeof *meetings->list) &&
      memory_reserve((void **)&meetings->cells, &meetings->cell_capacity, items, sizeof *meetings->cells) &&
      memory_reserve((void **)&meetings->begin, &meetings->begin_capacity,
                     (size_t)evaluation->patches.element_count + 1, sizeof *meetings->begin) &&
      memory_reserve((void **)&meetings->items, &meetings->item_capacity, items, sizeof *meetings->items) &&
      memory_reserve((void **)&meetings->parts, &meetings->part_capacity, items, sizeof *meetings->parts) &&
      memory_reserve((void **)&meetings->first, &meetings->first_capacity, positions,
                     sizeof *meetings->first);
  if (!has_room) return status_no_memory("elements that pass through bodies");
  for (size_t p = known; p < meetings->first_capacity; p++) meetings->first[p] = -1;
  return STATUS_OK;
}

// In the order of the pairs.
static void sort_items(ContactMeetings *meetings, const ContactPatches *patches, int pair_count) {
  int *begin = meetings->begin, elements = patches->element_count;
  for (int e = 0; e <= elements; e++) begin[e] = 0;
  for (int k = 0; k < pair_count; k++)
    for (int side = 0; side < 2; side++)
      if (patches->pair_elements[k][side] >= 0) begin[patches->pair_elements[k][side]]++;
  for (int e = 0, sum = 0; e <= elements; e++) {
    sum += begin[e];
    begin[e] = sum;
  }
  for (int k = pair_count - 1; k >= 0; k--)
    for (int side = 1; side >= 0; side--)
      if (patches->pair_elements[k][side] >= 0)
        meetings->items[--begin[patches->pair_elements[k][side]]] = 2 * k + side;
}

// The cell that is met, −1: a shape.
static int cell_of(const Work *work, int item) {
  return work->evaluation->pairs[item / 2].cells[1 - item % 2];
}

// ---- Parts: trees of items, the root first.

static int root_of(int *parents, int i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

static void join(int *parents, int i, int k) {
  int a = root_of(parents, i), b = root_of(parents, k);
  parents[a > b ? a : b] = a > b ? b : a;
}

static void grow_trees(const Work *work, int begin, int end) {
  const ContactMeetings *meetings = work->meetings;
  const ContactMesh *mesh = &work->layout->mesh;
  for (int i = begin; i < end; i++) {
    int cell = cell_of(work, meetings->items[i]);
    meetings->parts[i] = i;
    for (int v = 0; v < 4 && cell >= 0; v++) {
      int *first = &meetings->first[mesh->cells[cell][v]];
      if (*first < 0) *first = i;
      join(meetings->parts, *first, i);
    }
  }
  for (int i = begin; i < end; i++) {
    int cell = cell_of(work, meetings->items[i]);
    for (int v = 0; v < 4 && cell >= 0; v++) meetings->first[mesh->cells[cell][v]] = -1;
  }
}

// ---- What is met.

// Of the cell, or of the shape that stands for it.
static double volume_of(const ContactLayout *layout, int cell) {
  return cell < 0 ? INFINITY : layout->cell_volumes[cell];
}

static void add_item(const Work *work, int item, ContactMeeting *meeting) {
  const ContactLayout *layout = work->layout;
  int side = item % 2;
  const ContactFieldPair *field = &work->evaluation->fields[item / 2];
  const ContactPair *pair = &work->evaluation->pairs[item / 2];
  int own = pair->cells[side], other = pair->cells[1 - side];
  double lesser =
      fmin(other < 0 ? layout->tet_volumes[contact_mesh_tet(&layout->mesh, own)] : layout->cell_volumes[own],
           volume_of(layout, other));
  meeting->volume += field->volume;
  meeting->other += volume_of(layout, other);
  if (field->volume > meeting->most) meeting->most = field->volume, meeting->cell = other;
  if (!(field->volume >= work->rounding * lesser)) return;
  Vec3 slope = vec3_at(field->slopes[1 - side]);
  vec3_accumulate(meeting->slope, vec3_scale(field->weighed[side], slope));
  meeting->size += field->weighed[side] * vec3_length(slope);
  if (work->middles)
    meeting->reach =
        fmax(meeting->reach, field->depths[1 - side] / middle_of(layout, pair, side, work->middles));
}

// Adds the element's parts without what is met in them, but `cell_end` counts their cells. Of each item, the
// one above it in its tree, which comes before it, gives way to its part.
static void add_parts(const Work *work, int interface, int tet, int begin, int end) {
  ContactMeetings *meetings = work->meetings;
  int *parts = meetings->parts;
  for (int i = begin; i < end; i++) {
    bool is_root = parts[i] == i;
    parts[i] = is_root ? meetings->count++ : parts[parts[i]];
    ContactMeeting *meeting = &meetings->list[parts[i]];
    if (is_root)
      *meeting =
          (ContactMeeting){.interface = interface, .tet = tet, .cell = cell_of(work, meetings->items[i])};
    meeting->cell_end++;
  }
}

static void fill_parts(const Work *work, int first, int begin, int end) {
  ContactMeetings *meetings = work->meetings;
  for (int m = first, next = begin; m < meetings->count; m++) {
    ContactMeeting *meeting = &meetings->list[m];
    int cells = meeting->cell_end;
    meeting->cell_begin = meeting->cell_end = next;
    next += cells;
  }
  for (int i = begin; i < end; i++) {
    ContactMeeting *meeting = &meetings->list[meetings->parts[i]];
    meetings->cells[meeting->cell_end++] = cell_of(work, meetings->items[i]);
    add_item(work, meetings->items[i], meeting);
  }
  for (int m = first; m < meetings->count; m++) {
    ContactMeeting *meeting = &meetings->list[m];
    meeting->covered = meeting->volume / fmin(work->layout->tet_volumes[meeting->tet], meeting->other);
  }
}

static void add_patch(const Work *work, const ContactPatches *patches, const ContactPatch *patch) {
  const ContactMeetings *meetings = work->meetings;
  for (int e = patch->element_begin; e < patch->element_end; e++) {
    int begin = meetings->begin[e], end = meetings->begin[e + 1], first = meetings->count;
    grow_trees(work, begin, end);
    add_parts(work, patch->interface, patches->elements[e].tet, begin, end);
    fill_parts(work, first, begin, end);
  }
}

static int compare(const void *first, const void *second) {
  const ContactMeeting *a = first, *b = second;
  if (a->interface != b->interface) return a->interface < b->interface ? -1 : 1;
  if (a->tet != b->tet) return a->tet < b->tet ? -1 : 1;
  return (a->cell_begin > b->cell_begin) - (a->cell_begin < b->cell_begin);
}

Status contact_meetings_find(ContactMeetings *meetings, const ContactLayout *layout,
                             const ContactEvaluation *evaluation, const double *middles, double rounding,
                             const bool *is_marked) {
  const ContactPatches *patches = &evaluation->patches;
  const Work work = {meetings, layout, evaluation, middles, rounding};
  meetings->count = 0;
  TRY(reserve(meetings, layout, evaluation));
  sort_items(meetings, patches, evaluation->pair_count);
  for (int p = 0; p < patches->patch_count; p++)
    if (is_marked[patches->patches[p].interface]) add_patch(&work, patches, &patches->patches[p]);
  if (meetings->count > 1) qsort(meetings->list, (size_t)meetings->count, sizeof *meetings->list, compare);
  return STATUS_OK;
}

int contact_meetings_common(const ContactMeetings *meetings, const ContactMesh *mesh,
                            const ContactMeeting *meeting, int cell) {
  int most = 0;
  for (int i = meeting->cell_begin; i < meeting->cell_end; i++) {
    int other = meetings->cells[i], common = 0;
    if (other == cell) return 4;
    for (int v = 0; v < 4 && other >= 0 && cell >= 0; v++)
      for (int w = 0; w < 4; w++) common += mesh->cells[other][v] == mesh->cells[cell][w];
    if (common > most) most = common;
  }
  return most;
}
