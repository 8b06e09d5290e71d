// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/contact/remainder.h"

#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/compliance/laws.h"
#include "overlap/slopes.h"

static bool has_model(const FemContactDef *contact) {
  return contact->is_on && strcmp(contact->overlap, "clip") != 0;
}

bool fem_remainder_is_there(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  return has_model(contact) || (contact->is_on && fem_laws_are_wanted(contact));
}

static Status check_laws(const FemContactDef *contact) {
  if (!fem_laws_are_wanted(contact)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "contact.law: gradients with a pressure law need contact.overlap: clip, "
                                   "whose polyhedra the law is summed over");
}

Status fem_remainder_check(const FemModel *model) {
  OverlapModel overlap;
  if (!has_model(&model->scene->contact)) return STATUS_OK;
  TRY(check_laws(&model->scene->contact));
  TRY(fem_effect_contact_create_overlap(model->scene, NULL, &overlap));
  bool has_slopes = overlap_slopes_are_there(&overlap);
  overlap_model_destroy(&overlap);
  if (has_slopes) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "contact.overlap: '%s' has no derivatives of its centroid; gradients need clip, geo, "
                     "geo-small, hybrid, or a model with second derivatives or a pull-back",
                     model->scene->contact.overlap);
}

void fem_remainder_destroy(FemRemainder *remainder) {
  memory_free(remainder->begins);
  memory_free(remainder->starts);
  memory_free(remainder->vertices);
  memory_free(remainder->values);
  *remainder = (FemRemainder){0};
}

// ---- Blocks: first those of the matrix, negative, then the exact ones, which come in the same order.

typedef struct Collection {
  FemRemainder *remainder;
  int next;
  Status status;
} Collection;

static Status append(FemRemainder *remainder, int count, const int *vertices, const double *matrix) {
  int k = remainder->block_count, begin = k > 0 ? remainder->begins[k] : 0;
  size_t start = k > 0 ? remainder->starts[k] : 0, size = 9 * (size_t)count * (size_t)count;
  bool fits =
      memory_reserve((void **)&remainder->begins, &remainder->begin_capacity, (size_t)k + 2, sizeof(int)) &&
      memory_reserve((void **)&remainder->starts, &remainder->start_capacity, (size_t)k + 2,
                     sizeof(size_t)) &&
      memory_reserve((void **)&remainder->vertices, &remainder->vertex_capacity, (size_t)(begin + count),
                     sizeof(int)) &&
      memory_reserve((void **)&remainder->values, &remainder->value_capacity, start + size, sizeof(double));
  if (!fits) return status_no_memory("derivatives of overlaps");
  memcpy(remainder->vertices + begin, vertices, (size_t)count * sizeof *vertices);
  for (size_t i = 0; i < size; i++) remainder->values[start + i] = -matrix[i];
  remainder->begins[k] = begin, remainder->begins[k + 1] = begin + count;
  remainder->starts[k] = start, remainder->starts[k + 1] = start + size;
  remainder->block_count++;
  return STATUS_OK;
}

static void append_negative(void *self, int count, const int *vertices, const double *matrix) {
  Collection *collection = self;
  if (!collection->status) collection->status = append(collection->remainder, count, vertices, matrix);
}

static void add_exact(void *self, int count, const int *vertices, const double *matrix) {
  Collection *collection = self;
  const FemRemainder *remainder = collection->remainder;
  int k = collection->next++;
  (void)vertices;
  assert(k < remainder->block_count && count == remainder->begins[k + 1] - remainder->begins[k]);
  assert(memcmp(vertices, remainder->vertices + remainder->begins[k], (size_t)count * sizeof *vertices) == 0);
  for (size_t i = 0; i < 9 * (size_t)count * (size_t)count; i++)
    remainder->values[remainder->starts[k] + i] += matrix[i];
}

// Of the potential `field` there are none.
static void refuse_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  (void)self, (void)count, (void)vertices, (void)w, (void)scale;
  assert(false);
}

Status fem_remainder_find(FemRemainder *remainder, ContactSystem *contact,
                          const ContactEvaluation *evaluation) {
  Collection collection = {.remainder = remainder};
  remainder->block_count = 0;
  TRY(contact_system_stiffness(contact, evaluation,
                               &(ContactStiffnessSink){&collection, refuse_outer, append_negative}));
  TRY(collection.status);
  return contact_system_turn(contact, evaluation, CONTACT_ALL_INTERFACES,
                             &(ContactStiffnessSink){&collection, refuse_outer, add_exact});
}

void fem_remainder_add_product(const FemRemainder *remainder, bool back, const double *x, double *y) {
  for (int k = 0; k < remainder->block_count; k++) {
    const int *vertices = remainder->vertices + remainder->begins[k];
    int width = 3 * (remainder->begins[k + 1] - remainder->begins[k]);
    const double *matrix = remainder->values + remainder->starts[k];
    for (int r = 0; r < width; r++) {
      size_t row = 3 * (size_t)vertices[r / 3] + (size_t)(r % 3);
      for (int c = 0; c < width; c++) {
        size_t column = 3 * (size_t)vertices[c / 3] + (size_t)(c % 3);
        double value = matrix[r * width + c];
        if (back)
          y[column] += value * x[row];
        else
          y[row] += value * x[column];
      }
    }
  }
}
