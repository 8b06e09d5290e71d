// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/varied.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "fem/effect/contact/contact.h"
#include "fem/gradient/difference.h"
#include "fem/model/compliance/compliance.h"

static Status create_effect(FemEffect *effect, const FemEffectOps *ops, const FemModel *model) {
  effect->ops = ops;
  return ops->is_wanted(model->scene) ? ops->create(&effect->self, model) : STATUS_OK;
}

Status fem_varied_create(FemVaried *varied, const FemModel *model) {
  *varied = (FemVaried){.model = *model};
  varied->model.parts = memory_copy(model->parts, (size_t)model->part_count, sizeof *model->parts);
  varied->force = memory_zeroed(3 * (size_t)model->vertex_count, sizeof *varied->force);
  if (!varied->model.parts || !varied->force) return status_no_memory("other materials");
  TRY(create_effect(&varied->elasticity, &fem_effect_elasticity, &varied->model));
  TRY(create_effect(&varied->volume, &fem_effect_volume, &varied->model));
  return create_effect(&varied->damping, &fem_effect_damping, &varied->model);
}

void fem_varied_destroy(FemVaried *varied) {
  FemEffect *effects[] = {&varied->elasticity, &varied->volume, &varied->damping};
  for (int i = 0; i < 3; i++)
    if (effects[i]->self) effects[i]->ops->destroy(effects[i]->self);
  if (varied->contact.self) varied->contact.ops->destroy(varied->contact.self);
  memory_free(varied->scene.contact.pairs);
  memory_free(varied->model.parts);
  memory_free(varied->force);
  *varied = (FemVaried){0};
}

static FemLame lame_along(FemLame from, double step, FemLame rate) {
  return (FemLame){from.lambda + step * rate.lambda, from.mu + step * rate.mu};
}

// λ, μ and what elements keep of λ, along the tangent in E or ν.
static void vary_lame(FemModelPart *to, const FemModelPart *from, double ratio, FemParameterKind constant,
                      double step) {
  FemLame rate = fem_parameter_lame_rate(&from->material, constant), local_rate = rate;
  FemLame lame = fem_material_lame(&from->material), local = fem_material_lame(&from->local);
  if (lame.lambda > ratio * lame.mu) local_rate.lambda = ratio * rate.mu;
  to->material = fem_material_with_lame(&from->material, lame_along(lame, step, rate));
  to->local = fem_material_with_lame(&from->local, lame_along(local, step, local_rate));
  to->bulk = from->bulk + step * (rate.lambda - local_rate.lambda);
}

// The shares' sum stays.
static void vary_share(FemMaterial *to, const FemMaterial *from, int place, double step) {
  double sum = from->shares[0] + from->shares[1] + from->shares[2];
  for (int p = 0; p < 3; p++) to->shares[p] = from->shares[p] + step * ((p == place) - from->shares[p] / sum);
}

// `ratio`: fem_model_largest_ratio of the body.
static void vary(FemModelPart *to, const FemModelPart *from, double ratio, FemParameterKind constant,
                 int place, double step) {
  *to = *from;
  switch (constant) {
  case FEM_PARAMETER_YOUNG:
  case FEM_PARAMETER_POISSON:
    vary_lame(to, from, ratio, constant, step);
    break;
  case FEM_PARAMETER_OGDEN_SHARE:
    vary_share(&to->local, &from->local, place, step);
    break;
  case FEM_PARAMETER_DAMPING:
    to->damping += step;
    break;
  default:
    *fem_parameter_of_material(&to->local, constant, place) += step;
    break;
  }
}

static double square_of(const double x[3]) {
  return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

// So long that the change is not lost in rounding, and short beside where the law has a pole.
static double step_of(const FemModelPart *part, FemParameterKind constant, int place) {
  FemMaterial material = part->material;
  static const double SHARE = 0.1, OF_EXPONENT = 5e-3;
  double value = *fem_parameter_of_material(&material, constant, place);
  switch (constant) {
  case FEM_PARAMETER_POISSON:
    return SHARE * (0.5 - value);
  case FEM_PARAMETER_MOONEY:
    return SHARE;
  case FEM_PARAMETER_OGDEN_EXPONENT:
    return OF_EXPONENT * fabs(value);
  case FEM_PARAMETER_FIBRE_DIRECTION:
    return OF_EXPONENT * sqrt(square_of(material.fibre_direction));
  case FEM_PARAMETER_OGDEN_SHARE:
    return SHARE * (material.shares[0] + material.shares[1] + material.shares[2]);
  case FEM_PARAMETER_DAMPING: // the scene's, where the material has none
    return SHARE * part->damping;
  default:
    return SHARE * value;
  }
}

// Adds `weight` times the forces of materials and, unless it is NULL, the elastic energy.
static Status add_material(FemVaried *varied, const FemState *state, double weight, double *force,
                           double *energy) {
  const FemEffect *effects[] = {&varied->elasticity, &varied->volume, &varied->damping};
  size_t count = 3 * (size_t)varied->model.vertex_count;
  FemEnergy sum = {0};
  memset(varied->force, 0, count * sizeof *varied->force);
  for (int i = 0; i < 3; i++) {
    if (!effects[i]->self) continue;
    TRY(effects[i]->ops->add_force(effects[i]->self, state, varied->force));
    if (energy) TRY(effects[i]->ops->add_energy(effects[i]->self, state, &sum));
  }
  for (size_t i = 0; i < count; i++) force[i] += weight * varied->force[i];
  if (energy) *energy += weight * sum.elastic;
  return STATUS_OK;
}

Status fem_varied_derive(FemVaried *varied, int part, FemParameterKind constant, int place,
                         const FemState *state, double *force, double *energy) {
  FemModelPart *own = &varied->model.parts[part];
  const FemModelPart kept = *own;
  double ratio = fem_model_largest_ratio(&varied->model.bodies[own->body]);
  double step = step_of(&kept, constant, place);
  bool is_linear = constant != FEM_PARAMETER_OGDEN_EXPONENT && constant != FEM_PARAMETER_FIBRE_DIRECTION;
  const FemDifferencePoint *points = is_linear ? fem_difference_linear : fem_difference;
  Status status = STATUS_OK;
  for (int k = 0; k < (is_linear ? 2 : FEM_DIFFERENCE_POINTS) && !status; k++) {
    vary(own, &kept, ratio, constant, place, points[k].place * step);
    status = add_material(varied, state, points[k].weight / step, force, energy);
  }
  *own = kept;
  return status;
}

static Status add_choice(FemVaried *varied, double weight, double *rates, FemCompliance *choice) {
  TRY(fem_compliance_choose(&varied->model, choice));
  int count = varied->model.body_count * choice->party_count;
  for (int i = 0; i < count; i++) rates[i] += weight * log(choice->stiffness[i]);
  return STATUS_OK;
}

Status fem_varied_derive_stiffness(FemVaried *varied, int part, FemParameterKind constant, double **rates,
                                   int *party_count) {
  static const double SHARE = 1e-3;
  FemMaterial *material = &varied->model.parts[part].material;
  const FemMaterial kept = *material;
  double *value = fem_parameter_of_material(material, constant, 0), middle = *value;
  double step = SHARE * (constant == FEM_PARAMETER_YOUNG ? middle : 0.5 - middle);
  *party_count = varied->model.body_count + fem_scene_shape_count(varied->model.scene);
  *rates = memory_zeroed((size_t)varied->model.body_count * (size_t)*party_count, sizeof **rates);
  Status status = *rates ? STATUS_OK : status_no_memory("contact stiffness");
  for (int k = 0; k < FEM_DIFFERENCE_POINTS && !status; k++) {
    FemCompliance choice = {0};
    *value = middle + fem_difference[k].place * step;
    status = add_choice(varied, fem_difference[k].weight / step, *rates, &choice);
    fem_compliance_destroy(&choice);
  }
  *material = kept;
  return status;
}

// ---- Pressure laws.

static Status create_contact(FemVaried *varied) {
  const FemContactDef *contact = &varied->model.scene->contact;
  if (varied->contact.self) return STATUS_OK;
  if (!varied->scene.contact.pairs) { // else they are left of an attempt that failed later
    void *pairs = memory_copy(contact->pairs, (size_t)contact->pair_count, sizeof *contact->pairs);
    if (!pairs) return status_no_memory("a pressure law");
    varied->scene = *varied->model.scene;
    varied->scene.contact.pairs = pairs;
    varied->model.scene = &varied->scene;
  }
  return create_effect(&varied->contact, &fem_effect_contact, &varied->model);
}

Status fem_varied_derive_law(FemVaried *varied, const FemParameter *parameter, const FemState *state,
                             FemVariedLaw *derived) {
  static const ContactLawBy constants[] = {[FEM_PARAMETER_LAW_PRESSURE] = CONTACT_LAW_BY_PRESSURE,
                                           [FEM_PARAMETER_LAW_DEPTH] = CONTACT_LAW_BY_DEPTH,
                                           [FEM_PARAMETER_LAW_EXPONENT] = CONTACT_LAW_BY_EXPONENT,
                                           [FEM_PARAMETER_LAW_TABLE] = CONTACT_LAW_BY_ROW};
  TRY(create_contact(varied));
  FemContactDef *contact = &varied->scene.contact;
  ContactLaw *law = parameter->item < 0 ? &contact->law.law : &contact->pairs[parameter->item].law.law;
  const ContactLaw kept = *law;
  ContactSystem *system = fem_effect_contact_system(varied->contact.self);
  law->by = constants[parameter->kind];
  law->row = parameter->row;
  *derived = (FemVariedLaw){.system = system, .law = law};
  Status status = contact_system_update(system, state->time, state->positions, state->velocities, 0);
  if (!status) status = contact_evaluate(system, 0, state->time, state->positions, &derived->evaluation);
  *law = kept;
  return status;
}

void fem_varied_add_law(const FemVariedLaw *derived, int interface, double *force) {
  if (derived->law && contact_system_layout(derived->system)->interfaces[interface].law == derived->law)
    contact_system_add_force_of(derived->system, derived->evaluation, interface, force);
}
