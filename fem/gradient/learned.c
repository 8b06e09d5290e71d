// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/learned.h"

#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/model/compliance/laws.h"
#include "overlap/slopes.h"

static bool has_model(const FemContactDef *contact) {
  return contact->is_on && strcmp(contact->overlap, "clip") != 0;
}

bool fem_learned_is_there(const FemModel *model) {
  const FemContactDef *contact = &model->scene->contact;
  return has_model(contact) || (contact->is_on && fem_laws_are_wanted(contact));
}

static Status check_laws(const FemContactDef *contact) {
  if (!fem_laws_are_wanted(contact)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "contact.law: gradients with a pressure law need contact.overlap: clip, "
                                   "whose polyhedra the law is summed over");
}

Status fem_learned_check(const FemModel *model) {
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

Status fem_learned_count_weights(const FemModel *model, size_t *count) {
  OverlapModel overlap;
  if (!model->scene->contact.is_on) return status_fail(STATUS_INPUT, "--weights: the scene has no contact");
  TRY(fem_effect_contact_create_overlap(model->scene, NULL, &overlap));
  const OverlapTraining *training =
      overlap_model_has_own_centroid(&overlap) ? overlap.ops->training : NULL; // pulls x̄, too
  *count = training ? training->count(overlap.self) : 0;
  overlap_model_destroy(&overlap);
  if (training) return STATUS_OK;
  return status_fail(
      STATUS_INPUT,
      "--weights: '%s' has no weights with derivatives; contact.overlap must be geo, geo-small, "
      "hybrid or hybrid=geo, or a weights file of such a network",
      model->scene->contact.overlap);
}

Status fem_answers_begin(FemAnswers *answers, const ContactEvaluation *evaluation) {
  size_t count = 4 * (size_t)evaluation->mesh_pair_count;
  if (!memory_reserve((void **)&answers->by, &answers->capacity, count + 1, sizeof *answers->by))
    return status_no_memory("derivatives by weights");
  memset(answers->by, 0, count * sizeof *answers->by);
  return STATUS_OK;
}

void fem_answers_destroy(FemAnswers *answers) {
  memory_free(answers->by);
  *answers = (FemAnswers){0};
}

Status fem_answers_train(const FemAnswers *answers, const ContactSystem *contact,
                         const ContactEvaluation *evaluation, double *slope) {
  const OverlapModel *model = contact_system_layout(contact)->def.model;
  return model->ops->training->pull(model->self, evaluation->mesh_pair_count, evaluation->coordinates,
                                    answers->by, slope);
}

void fem_learned_destroy(FemLearned *learned) {
  memory_free(learned->begins);
  memory_free(learned->starts);
  memory_free(learned->vertices);
  memory_free(learned->values);
  *learned = (FemLearned){0};
}

// ---- Blocks: those of clipping are taken first, then the model's come in the same order.

typedef struct Collection {
  FemLearned *learned;
  int next;
  Status status;
} Collection;

static Status append(FemLearned *learned, int count, const int *vertices, const double *matrix) {
  int k = learned->block_count, begin = k > 0 ? learned->begins[k] : 0;
  size_t start = k > 0 ? learned->starts[k] : 0, size = 9 * (size_t)count * (size_t)count;
  bool fits =
      memory_reserve((void **)&learned->begins, &learned->begin_capacity, (size_t)k + 2, sizeof(int)) &&
      memory_reserve((void **)&learned->starts, &learned->start_capacity, (size_t)k + 2, sizeof(size_t)) &&
      memory_reserve((void **)&learned->vertices, &learned->vertex_capacity, (size_t)(begin + count),
                     sizeof(int)) &&
      memory_reserve((void **)&learned->values, &learned->value_capacity, start + size, sizeof(double));
  if (!fits) return status_no_memory("derivatives of overlaps");
  memcpy(learned->vertices + begin, vertices, (size_t)count * sizeof *vertices);
  for (size_t i = 0; i < size; i++) learned->values[start + i] = -matrix[i];
  learned->begins[k] = begin, learned->begins[k + 1] = begin + count;
  learned->starts[k] = start, learned->starts[k + 1] = start + size;
  learned->block_count++;
  return STATUS_OK;
}

static void take_clipped(void *self, int count, const int *vertices, const double *matrix) {
  Collection *collection = self;
  if (!collection->status) collection->status = append(collection->learned, count, vertices, matrix);
}

static void add_own(void *self, int count, const int *vertices, const double *matrix) {
  Collection *collection = self;
  const FemLearned *learned = collection->learned;
  int k = collection->next++;
  (void)vertices;
  assert(k < learned->block_count && count == learned->begins[k + 1] - learned->begins[k]);
  assert(memcmp(vertices, learned->vertices + learned->begins[k], (size_t)count * sizeof *vertices) == 0);
  for (size_t i = 0; i < 9 * (size_t)count * (size_t)count; i++)
    learned->values[learned->starts[k] + i] += matrix[i];
}

// Of the potential `field` there are none.
static void refuse_outer(void *self, int count, const int *vertices, const double *w, double scale) {
  (void)self, (void)count, (void)vertices, (void)w, (void)scale;
  assert(false);
}

Status fem_learned_find(FemLearned *learned, ContactSystem *contact, const ContactEvaluation *evaluation) {
  Collection collection = {.learned = learned};
  learned->block_count = 0;
  TRY(contact_system_stiffness(contact, evaluation,
                               &(ContactStiffnessSink){&collection, refuse_outer, take_clipped}));
  TRY(collection.status);
  return contact_system_turn(contact, evaluation, CONTACT_ALL_INTERFACES,
                             &(ContactStiffnessSink){&collection, refuse_outer, add_own});
}

void fem_learned_add_product(const FemLearned *learned, bool back, const double *x, double *y) {
  for (int k = 0; k < learned->block_count; k++) {
    const int *vertices = learned->vertices + learned->begins[k];
    int width = 3 * (learned->begins[k + 1] - learned->begins[k]);
    const double *matrix = learned->values + learned->starts[k];
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
