// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/model/compliance/laws.h"

#include <math.h>

#include "base/memory.h"
#include "fem/model/compliance/compliance.h"

static bool is_given(const FemContactLawDef *def) {
  return def->law.kind != CONTACT_LAW_LINEAR;
}

bool fem_laws_are_wanted(const FemContactDef *contact) {
  bool any = is_given(&contact->law);
  for (int i = 0; i < contact->pair_count; i++) any = any || is_given(&contact->pairs[i].law);
  return any;
}

// Up to this many times the stiffest body's E a law must make sense: beyond, bodies are flat before.
static const double HIGHEST = 10;

static Status check(const FemModel *model, const FemContactLawDef *def) {
  char why[256];
  double stiffest = 0;
  if (!is_given(def)) return STATUS_OK;
  for (int p = 0; p < model->part_count; p++) stiffest = fmax(stiffest, model->parts[p].material.young);
  if (contact_law_check(&def->law, model->length, HIGHEST * stiffest, why, sizeof why)) return STATUS_OK;
  const Expression *formula = def->law.formula;
  FemScenePlace place = def->place;
  if (formula && formula->line > 0) place = (FemScenePlace){formula->line, formula->column};
  return status_fail(STATUS_INPUT, "%s: contact law%s%s%s: %s", fem_scene_where(model->scene, &place).text,
                     formula ? " '" : "", formula ? formula->text : "", formula ? "'" : "", why);
}

static void apply_pair(const FemModel *model, const FemContactPairDef *pair, int party_count,
                       const ContactLaw **laws) {
  const ContactLaw *law = is_given(&pair->law) ? &pair->law.law : NULL;
  if (!law && !(pair->stiffness > 0)) return;
  int a = fem_compliance_party(model, pair->names[0]), b = fem_compliance_party(model, pair->names[1]);
  if (a >= 0 && a < model->body_count && b >= 0) laws[a * party_count + b] = law;
  if (b >= 0 && b < model->body_count && a >= 0) laws[b * party_count + a] = law;
}

Status fem_laws_create(const FemModel *model, const ContactLaw ***laws) {
  const FemContactDef *contact = &model->scene->contact;
  *laws = NULL;
  if (!fem_laws_are_wanted(contact)) return STATUS_OK;
  TRY(check(model, &contact->law));
  for (int i = 0; i < contact->pair_count; i++) TRY(check(model, &contact->pairs[i].law));
  int party_count = model->body_count + fem_scene_shape_count(model->scene);
  size_t count = (size_t)model->body_count * (size_t)party_count;
  *laws = memory_zeroed(count, sizeof **laws);
  if (!*laws) return status_no_memory("contact laws");
  for (size_t k = 0; k < count; k++) (*laws)[k] = is_given(&contact->law) ? &contact->law.law : NULL;
  for (int i = 0; i < contact->pair_count; i++) apply_pair(model, &contact->pairs[i], party_count, *laws);
  return STATUS_OK;
}
