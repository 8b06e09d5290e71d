// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/contact/answers.h"

#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"

Status fem_answers_count_weights(const FemModel *model, size_t *count) {
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
