// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/parameter.h"

#include <math.h>
#include <stddef.h>

#include "fem/model/compliance/compliance.h"

typedef enum Owner { OF_SCENE, OF_MATERIAL, OF_MOTION, OF_LAW, OF_SHAPE } Owner;

// Of a load the unit is told by its kind.
static const struct {
  Owner owner;
  const char *unit;
} kinds[] = {
    [FEM_PARAMETER_YOUNG] = {OF_MATERIAL, "Pa"},
    [FEM_PARAMETER_POISSON] = {OF_MATERIAL, ""},
    [FEM_PARAMETER_MOONEY] = {OF_MATERIAL, ""},
    [FEM_PARAMETER_OGDEN_EXPONENT] = {OF_MATERIAL, ""},
    [FEM_PARAMETER_OGDEN_SHARE] = {OF_MATERIAL, ""},
    [FEM_PARAMETER_FIBRE] = {OF_MATERIAL, "Pa"},
    [FEM_PARAMETER_FIBRE_DIRECTION] = {OF_MATERIAL, ""},
    [FEM_PARAMETER_DAMPING] = {OF_MATERIAL, "s"},
    [FEM_PARAMETER_VISCOSITY] = {OF_MATERIAL, "Pa s"},
    [FEM_PARAMETER_BULK_VISCOSITY] = {OF_MATERIAL, "Pa s"},
    [FEM_PARAMETER_YIELD] = {OF_MATERIAL, "Pa"},
    [FEM_PARAMETER_HARDENING] = {OF_MATERIAL, "Pa"},
    [FEM_PARAMETER_DENSITY] = {OF_SCENE, "kg/m³"},
    [FEM_PARAMETER_GRAVITY] = {OF_SCENE, "m/s²"},
    [FEM_PARAMETER_LOAD] = {OF_SCENE, "N"},
    [FEM_PARAMETER_VELOCITY] = {OF_MOTION, "m/s"},
    [FEM_PARAMETER_AMPLITUDE] = {OF_MOTION, "m"},
    [FEM_PARAMETER_FREQUENCY] = {OF_MOTION, "Hz"},
    [FEM_PARAMETER_SPIN] = {OF_MOTION, "rad/s"},
    [FEM_PARAMETER_TABLE] = {OF_MOTION, "m"},
    [FEM_PARAMETER_PLACE] = {OF_SCENE, "m"},
    [FEM_PARAMETER_SCALE] = {OF_SHAPE, ""},
    [FEM_PARAMETER_ROTATE] = {OF_SHAPE, "°"},
    [FEM_PARAMETER_REST] = {OF_SHAPE, "m"},
    [FEM_PARAMETER_CONTACT_STIFFNESS] = {OF_SCENE, "Pa/m"},
    [FEM_PARAMETER_PAIR_STIFFNESS] = {OF_SCENE, "Pa/m"},
    [FEM_PARAMETER_LAW_PRESSURE] = {OF_LAW, "Pa"},
    [FEM_PARAMETER_LAW_DEPTH] = {OF_LAW, "m"},
    [FEM_PARAMETER_LAW_EXPONENT] = {OF_LAW, ""},
    [FEM_PARAMETER_LAW_TABLE] = {OF_LAW, "Pa"},
    [FEM_PARAMETER_FRICTION] = {OF_SCENE, ""},
    [FEM_PARAMETER_PAIR_FRICTION] = {OF_SCENE, ""},
    [FEM_PARAMETER_START] = {OF_SCENE, "m/s"},
    [FEM_PARAMETER_START_SPIN] = {OF_SCENE, "rad/s"},
    [FEM_PARAMETER_CONTACT_VISCOSITY] = {OF_SCENE, "Pa s/m²"},
};

bool fem_parameter_is_of_material(const FemParameter *parameter) {
  return kinds[parameter->kind].owner == OF_MATERIAL;
}

bool fem_parameter_is_of_motion(const FemParameter *parameter) {
  return kinds[parameter->kind].owner == OF_MOTION;
}

bool fem_parameter_is_of_yielding(const FemParameter *parameter) {
  return parameter->kind == FEM_PARAMETER_YIELD || parameter->kind == FEM_PARAMETER_HARDENING;
}

bool fem_parameter_is_of_law(const FemParameter *parameter) {
  return kinds[parameter->kind].owner == OF_LAW;
}

bool fem_parameter_is_of_shape(const FemParameter *parameter) {
  return kinds[parameter->kind].owner == OF_SHAPE;
}

bool fem_parameter_moves_rest(const FemParameter *parameter) {
  bool is_of_place = parameter->kind == FEM_PARAMETER_PLACE && parameter->obstacle < 0;
  return is_of_place || fem_parameter_is_of_shape(parameter);
}

static const FemContactDef *contact_of(const FemModel *model) {
  return &model->scene->contact;
}

const ContactLaw *fem_parameter_law(const FemModel *model, const FemParameter *parameter) {
  const FemContactDef *contact = contact_of(model);
  if (!contact->is_on || parameter->item >= contact->pair_count) return NULL;
  const FemContactLawDef *def = parameter->item < 0 ? &contact->law : &contact->pairs[parameter->item].law;
  return def->law.kind != CONTACT_LAW_LINEAR ? &def->law : NULL;
}

const FemConstraintDef *fem_parameter_motion(const FemModel *model, const FemParameter *parameter) {
  const FemSceneDef *scene = model->scene;
  if (parameter->obstacle >= 0) return &scene->obstacles[parameter->obstacle].motion;
  const FemBodyDef *body = &scene->bodies[parameter->body];
  return parameter->item < body->driven_count ? &body->driven[parameter->item] : NULL;
}

static bool is_of(const FemModel *model, const FemContactPairDef *pair, int a, int b) {
  int first = fem_compliance_party(model, pair->names[0]);
  int second = fem_compliance_party(model, pair->names[1]);
  return (first == a && second == b) || (first == b && second == a);
}

int fem_parameter_pair(const FemModel *model, int a, int b) {
  const FemContactDef *contact = contact_of(model);
  int found = -1;
  for (int i = 0; i < contact->pair_count; i++) {
    const FemContactPairDef *pair = &contact->pairs[i];
    bool is_given = pair->stiffness > 0 || pair->law.law.kind != CONTACT_LAW_LINEAR;
    if (is_given && is_of(model, pair, a, b)) found = i;
  }
  return found;
}

int fem_parameter_friction_pair(const FemModel *model, int a, int b) {
  const FemContactDef *contact = contact_of(model);
  int found = -1;
  for (int i = 0; i < contact->pair_count; i++)
    if (contact->pairs[i].friction.coefficient >= 0 && is_of(model, &contact->pairs[i], a, b)) found = i;
  return found;
}

static bool is_damping(const FemParameter *parameter) {
  return parameter->kind == FEM_PARAMETER_DAMPING || parameter->kind == FEM_PARAMETER_VISCOSITY ||
         parameter->kind == FEM_PARAMETER_BULK_VISCOSITY;
}

// ---- What has a derivative.

static Status check_stiffness(const FemModel *model) {
  const FemContactDef *contact = contact_of(model);
  if (!contact->is_on) return status_fail(STATUS_INPUT, "the scene has no contact");
  if (contact->law.law.kind == CONTACT_LAW_LINEAR && contact->stiffness == 0)
    return status_fail(STATUS_INPUT, "contact.stiffness is chosen from the bodies: write its value into the "
                                     "scene (`tetlap check` says it) for a derivative by it");
  return STATUS_OK;
}

// The entry of contact.pairs that a parameter names, if it names one.
static Status check_entry(const FemModel *model, const FemParameter *parameter) {
  const FemContactDef *contact = contact_of(model);
  if (!contact->is_on) return status_fail(STATUS_INPUT, "the scene has no contact");
  if (parameter->item < contact->pair_count) return STATUS_OK;
  return status_fail(STATUS_INPUT, "contact.pairs has %d entries, no contact.pairs[%d]", contact->pair_count,
                     parameter->item);
}

static Status check_pair(const FemModel *model, const FemParameter *parameter) {
  const FemContactDef *contact = contact_of(model);
  TRY(check_entry(model, parameter));
  if (contact->pairs[parameter->item].stiffness > 0) return STATUS_OK;
  return status_fail(STATUS_INPUT, "contact.pairs[%d] has no stiffness of its own", parameter->item);
}

static Status check_friction(const FemModel *model, const FemParameter *parameter) {
  const FemContactDef *contact = contact_of(model);
  bool is_pair = parameter->kind == FEM_PARAMETER_PAIR_FRICTION;
  TRY(check_entry(model, parameter));
  if ((is_pair ? contact->pairs[parameter->item].friction.coefficient : contact->friction.coefficient) > 0)
    return STATUS_OK;
  return status_fail(STATUS_INPUT, "%s is not given or 0, where it has no derivative: give it a value",
                     is_pair ? "the pair's friction" : "contact.friction");
}

static Status check_law(const FemModel *model, const FemParameter *parameter) {
  const ContactLaw *law = fem_parameter_law(model, parameter);
  TRY(check_entry(model, parameter));
  if (!law) return status_fail(STATUS_INPUT, "%s has no law", parameter->item < 0 ? "contact" : "the pair");
  if (parameter->kind == FEM_PARAMETER_LAW_EXPONENT && !(law->exponent > 1))
    return status_fail(STATUS_INPUT, "the law's exponent is 1, below which there is no law: no derivative");
  bool is_of_row = parameter->row > 0 && parameter->row < law->table_count && parameter->component == 1;
  if (parameter->kind == FEM_PARAMETER_LAW_TABLE && !is_of_row)
    return status_fail(
        STATUS_INPUT,
        "the law's table has %d rows of [d, p]; there are derivatives by p in the rows 1 to %d, "
        "as table[1][1]",
        law->table_count, law->table_count - 1);
  return STATUS_OK;
}

static Status check_load(const FemModel *model, const FemParameter *parameter) {
  const FemBodyDef *body = &model->scene->bodies[parameter->body];
  if (parameter->item >= body->load_count)
    return status_fail(STATUS_INPUT, "body '%s' has %d loads, no loads[%d]", body->name, body->load_count,
                       parameter->item);
  const FemLoadDef *load = &body->loads[parameter->item];
  const double *v = load->vector;
  bool is_given = load->kind == FEM_LOAD_PRESSURE ? load->pressure != 0 : v[0] != 0 || v[1] != 0 || v[2] != 0;
  if (load->kind == FEM_LOAD_EXTERNAL)
    return status_fail(STATUS_INPUT, "body '%s', loads[%d] is set from outside", body->name, parameter->item);
  if (is_given) return STATUS_OK;
  return status_fail(STATUS_INPUT,
                     "body '%s', loads[%d] is zero, which does not tell where it would act: give it a value",
                     body->name, parameter->item);
}

static Status check_motion(const FemModel *model, const FemParameter *parameter) {
  const FemConstraintDef *motion = fem_parameter_motion(model, parameter);
  if (!motion)
    return status_fail(STATUS_INPUT, "body '%s' has %d driven entries, no driven[%d]",
                       model->scene->bodies[parameter->body].name,
                       model->scene->bodies[parameter->body].driven_count, parameter->item);
  if (motion->is_external) return status_fail(STATUS_INPUT, "the motion is set from outside");
  if (parameter->kind == FEM_PARAMETER_SPIN && motion->spin == 0)
    return status_fail(STATUS_INPUT, "the motion has no spin");
  if (parameter->kind == FEM_PARAMETER_TABLE &&
      (parameter->row >= motion->table_count || parameter->component < 0))
    return status_fail(STATUS_INPUT,
                       "the motion's table has %d rows of [t, dx, dy, dz]; there are derivatives by the "
                       "displacements",
                       motion->table_count);
  bool oscillates = parameter->kind == FEM_PARAMETER_AMPLITUDE || parameter->kind == FEM_PARAMETER_FREQUENCY;
  if (oscillates && !(motion->frequency > 0))
    return status_fail(STATUS_INPUT, "the motion does not oscillate: it has no frequency");
  return STATUS_OK;
}

static Status check_shape(const FemModel *model, const FemParameter *parameter) {
  const FemModelBody *body = &model->bodies[parameter->body];
  const FemPlacement *placement = &model->scene->bodies[parameter->body].placement;
  const double *s = placement->scale, *axis = placement->axis;
  int count = body->vertex_end - body->vertex_begin;
  if (parameter->kind == FEM_PARAMETER_REST && parameter->row >= count)
    return status_fail(STATUS_INPUT, "body '%s' has %d vertices, no rest[%d]", body->name, count,
                       parameter->row);
  if (parameter->kind == FEM_PARAMETER_SCALE && parameter->component < 0 && !(s[0] == s[1] && s[1] == s[2]))
    return status_fail(STATUS_INPUT, "body '%s' has a factor for each axis: write place.scale[0]",
                       body->name);
  if (parameter->kind == FEM_PARAMETER_ROTATE && axis[0] == 0 && axis[1] == 0 && axis[2] == 0)
    return status_fail(STATUS_INPUT, "body '%s' is not turned: give it place.rotate with an axis and degrees",
                       body->name);
  return STATUS_OK;
}

// There is no derivative by ν where elements begin to keep a part of λ only.
static bool is_at_largest_ratio(const FemModelBody *body, const FemMaterial *material) {
  static const double NEAR = 1e-9;
  FemLame lame = fem_material_lame(material);
  double most = fem_model_largest_ratio(body) * lame.mu;
  return isfinite(most) && fabs(lame.lambda - most) <= NEAR * most;
}

// At 0 there is no damping effect that could be varied.
static Status check_damping(const FemModel *model, const FemParameter *parameter) {
  bool is_of_all = parameter->part < 0;
  if (model->scene->is_static || fem_parameter_value(model, parameter) > 0) return STATUS_OK;
  if (is_of_all) return status_fail(STATUS_INPUT, "effects.damping is not given or 0: give it a value");
  return status_fail(STATUS_INPUT, "body '%s' has no such constant of its own, or it is 0: give it a value",
                     model->scene->bodies[parameter->body].name);
}

static Status check_material(const FemModel *model, const FemParameter *parameter) {
  const FemModelBody *body = &model->bodies[parameter->body];
  const FemMaterial *material = &model->parts[parameter->part].material;
  bool is_of_fibres =
      parameter->kind == FEM_PARAMETER_FIBRE || parameter->kind == FEM_PARAMETER_FIBRE_DIRECTION;
  if (is_of_fibres && !(material->fibre_stiffness > 0))
    return status_fail(STATUS_INPUT, "body '%s' has no fibres", body->name);
  if (fem_parameter_is_of_yielding(parameter) && !(material->yield_stress > 0))
    return status_fail(STATUS_INPUT, "body '%s' does not yield: it has no plasticity there", body->name);
  if (parameter->kind == FEM_PARAMETER_OGDEN_SHARE && material->exponents[parameter->row] == 0)
    return status_fail(STATUS_INPUT, "body '%s': the exponent of this share is 0", body->name);
  if (parameter->kind == FEM_PARAMETER_POISSON && is_at_largest_ratio(body, material))
    return status_fail(
        STATUS_INPUT,
        "body '%s': there is no derivative by ν just here, where these elements begin to share "
        "their volume change; take another ν, as %.9g",
        body->name, material->poisson + 1e-4);
  return STATUS_OK;
}

Status fem_parameter_check(const FemModel *model, const FemParameter *parameter) {
  if (is_damping(parameter)) return check_damping(model, parameter);
  if (fem_parameter_is_of_material(parameter)) return check_material(model, parameter);
  if (fem_parameter_is_of_motion(parameter)) return check_motion(model, parameter);
  if (fem_parameter_is_of_law(parameter)) return check_law(model, parameter);
  if (fem_parameter_is_of_shape(parameter)) return check_shape(model, parameter);
  switch (parameter->kind) {
  case FEM_PARAMETER_LOAD:
    return check_load(model, parameter);
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return check_stiffness(model);
  case FEM_PARAMETER_PAIR_STIFFNESS:
    return check_pair(model, parameter);
  case FEM_PARAMETER_FRICTION:
  case FEM_PARAMETER_PAIR_FRICTION:
    return check_friction(model, parameter);
  case FEM_PARAMETER_CONTACT_VISCOSITY:
    if (!model->scene->is_static)
      return status_fail(STATUS_INPUT, "there is no derivative by the viscosity of contact in a motion");
    break;
  default:
    break;
  }
  return STATUS_OK;
}

// ---- What does not act.

static const char *idle_stiffness(const FemModel *model, const FemParameter *parameter) {
  const FemContactDef *contact = contact_of(model);
  const FemContactLawDef *law = &contact->law;
  if (parameter->kind == FEM_PARAMETER_PAIR_STIFFNESS) law = &contact->pairs[parameter->item].law;
  return law->law.kind == CONTACT_LAW_LINEAR ? NULL : "a pressure law stands in its place";
}

// Pairs with a stiffness or a law of their own do not have the scene's.
static const char *idle_law(const FemModel *model, const FemParameter *parameter) {
  int parties = model->body_count + fem_scene_shape_count(model->scene);
  for (int a = 0; a < model->body_count; a++)
    for (int b = a; b < parties; b++)
      if (fem_compliance_meets(model, a, b) && fem_parameter_pair(model, a, b) == parameter->item)
        return NULL;
  return parameter->item < 0 ? "all that can meet have a stiffness or a law of their own"
                             : "another entry of contact.pairs stands in its place";
}

static const char *idle_of_law(const FemModel *model, const FemParameter *parameter, FemMaterialLaw law) {
  if (model->parts[parameter->part].material.law == law) return NULL;
  return law == FEM_MATERIAL_OGDEN ? "the body's law is not ogden" : "the body's law is not mooney_rivlin";
}

static const char *idle_density(const FemModel *model) {
  const double *g = model->scene->gravity;
  if (!model->scene->is_static) return NULL;
  bool is_heavy = model->scene->has_gravity && (g[0] != 0 || g[1] != 0 || g[2] != 0);
  return is_heavy ? NULL : "a density acts by gravity alone, which the scene does not have";
}

static const char *idle_damping(const FemModel *model, const FemParameter *parameter) {
  if (model->scene->is_static) return "it acts in motions alone, and the scene is static";
  if (parameter->part >= 0) return NULL;
  for (int p = 0; p < model->part_count; p++)
    if (model->parts[p].material.damping < 0) return NULL;
  return "all materials have a damping of their own";
}

const char *fem_parameter_idle(const FemModel *model, const FemParameter *parameter) {
  if (fem_parameter_is_of_law(parameter)) return idle_law(model, parameter);
  switch (parameter->kind) {
  case FEM_PARAMETER_DAMPING:
    return idle_damping(model, parameter);
  case FEM_PARAMETER_DENSITY:
    return idle_density(model);
  case FEM_PARAMETER_CONTACT_STIFFNESS:
  case FEM_PARAMETER_PAIR_STIFFNESS:
    return idle_stiffness(model, parameter);
  case FEM_PARAMETER_MOONEY:
    return idle_of_law(model, parameter, FEM_MATERIAL_MOONEY_RIVLIN);
  case FEM_PARAMETER_OGDEN_EXPONENT:
    if (model->parts[parameter->part].material.shares[parameter->row] == 0) return "the term's share is 0";
    return idle_of_law(model, parameter, FEM_MATERIAL_OGDEN);
  case FEM_PARAMETER_OGDEN_SHARE:
    return idle_of_law(model, parameter, FEM_MATERIAL_OGDEN);
  case FEM_PARAMETER_START:
  case FEM_PARAMETER_START_SPIN:
    if (model->start) return "the scene goes on from another run, whose velocities it has";
    return model->scene->is_static ? "it acts in motions alone, and the scene is static" : NULL;
  case FEM_PARAMETER_CONTACT_VISCOSITY:
  case FEM_PARAMETER_VISCOSITY:
  case FEM_PARAMETER_BULK_VISCOSITY:
    return model->scene->is_static ? "it acts in motions alone, and the scene is static" : NULL;
  default:
    return NULL;
  }
}

// ---- Values and units.

static double value_of_load(const FemLoadDef *load, int component) {
  return load->kind == FEM_LOAD_PRESSURE ? load->pressure : load->vector[component];
}

static double place_of(const FemModel *model, const FemParameter *parameter) {
  const FemSceneDef *scene = model->scene;
  int c = parameter->component;
  if (parameter->obstacle < 0) return scene->bodies[parameter->body].placement.translate[c];
  const FemObstacleDef *obstacle = &scene->obstacles[parameter->obstacle];
  return obstacle->kind == FEM_OBSTACLE_MESH ? obstacle->placement.translate[c] : obstacle->point[c];
}

double *fem_parameter_of_material(FemMaterial *material, FemParameterKind kind, int row) {
  switch (kind) {
  case FEM_PARAMETER_YOUNG:
    return &material->young;
  case FEM_PARAMETER_POISSON:
    return &material->poisson;
  case FEM_PARAMETER_MOONEY:
    return &material->mooney;
  case FEM_PARAMETER_OGDEN_EXPONENT:
    return &material->exponents[row];
  case FEM_PARAMETER_OGDEN_SHARE:
    return &material->shares[row];
  case FEM_PARAMETER_FIBRE:
    return &material->fibre_stiffness;
  case FEM_PARAMETER_FIBRE_DIRECTION:
    return &material->fibre_direction[row];
  case FEM_PARAMETER_YIELD:
    return &material->yield_stress;
  case FEM_PARAMETER_HARDENING:
    return &material->hardening;
  case FEM_PARAMETER_DAMPING:
    return &material->damping;
  case FEM_PARAMETER_VISCOSITY:
    return &material->viscosity;
  case FEM_PARAMETER_BULK_VISCOSITY:
    return &material->bulk_viscosity;
  default:
    return &material->density;
  }
}

FemLame fem_parameter_lame_rate(const FemMaterial *material, FemParameterKind kind) {
  double young = material->young, nu = material->poisson;
  FemLame lame = fem_material_lame(material);
  if (kind == FEM_PARAMETER_YOUNG) return (FemLame){lame.lambda / young, lame.mu / young};
  double above = 1 + nu, below = 1 - 2 * nu;
  return (FemLame){young * (1 + 2 * nu * nu) / (above * above * below * below), -young / (2 * above * above)};
}

double *fem_parameter_of_motion(FemConstraintDef *motion, const FemParameter *parameter) {
  switch (parameter->kind) {
  case FEM_PARAMETER_VELOCITY:
    return &motion->velocity[parameter->component];
  case FEM_PARAMETER_AMPLITUDE:
    return &motion->amplitude[parameter->component];
  case FEM_PARAMETER_FREQUENCY:
    return &motion->frequency;
  case FEM_PARAMETER_SPIN:
    return &motion->spin;
  default:
    return &motion->table[4 * parameter->row + 1 + parameter->component];
  }
}

static double value_of_material(const FemModel *model, const FemParameter *parameter) {
  if (parameter->part < 0) return model->scene->stiffness_damping;
  FemMaterial material = model->parts[parameter->part].material;
  double value = *fem_parameter_of_material(&material, parameter->kind, parameter->row);
  return parameter->kind == FEM_PARAMETER_DAMPING ? fmax(0, value) : value; // below 0: that of the scene
}

static double value_of_motion(const FemModel *model, const FemParameter *parameter) {
  FemConstraintDef motion = *fem_parameter_motion(model, parameter);
  return *fem_parameter_of_motion(&motion, parameter);
}

static double value_of_law(const FemModel *model, const FemParameter *parameter) {
  const ContactLaw *law = fem_parameter_law(model, parameter);
  switch (parameter->kind) {
  case FEM_PARAMETER_LAW_PRESSURE:
    return law->pressure;
  case FEM_PARAMETER_LAW_DEPTH:
    return law->depth;
  case FEM_PARAMETER_LAW_EXPONENT:
    return law->exponent;
  default:
    return law->table[2 * (size_t)parameter->row + 1];
  }
}

static double value_of_shape(const FemModel *model, const FemParameter *parameter) {
  const FemPlacement *placement = &model->scene->bodies[parameter->body].placement;
  size_t vertex = (size_t)(model->bodies[parameter->body].vertex_begin + parameter->row);
  if (parameter->kind == FEM_PARAMETER_REST) return model->rest[3 * vertex + (size_t)parameter->component];
  if (parameter->kind == FEM_PARAMETER_ROTATE) return placement->angle_degrees;
  return placement->scale[parameter->component < 0 ? 0 : parameter->component];
}

double fem_parameter_value(const FemModel *model, const FemParameter *parameter) {
  if (fem_parameter_is_of_motion(parameter)) return value_of_motion(model, parameter);
  if (fem_parameter_is_of_law(parameter)) return value_of_law(model, parameter);
  if (fem_parameter_is_of_shape(parameter)) return value_of_shape(model, parameter);
  switch (parameter->kind) {
  case FEM_PARAMETER_GRAVITY:
    return model->scene->has_gravity ? model->scene->gravity[parameter->component] : 0;
  case FEM_PARAMETER_LOAD:
    return value_of_load(&model->scene->bodies[parameter->body].loads[parameter->item], parameter->component);
  case FEM_PARAMETER_PLACE:
    return place_of(model, parameter);
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return contact_of(model)->stiffness;
  case FEM_PARAMETER_PAIR_STIFFNESS:
    return contact_of(model)->pairs[parameter->item].stiffness;
  case FEM_PARAMETER_FRICTION:
    return contact_of(model)->friction.coefficient;
  case FEM_PARAMETER_PAIR_FRICTION:
    return contact_of(model)->pairs[parameter->item].friction.coefficient;
  case FEM_PARAMETER_START:
    return model->scene->bodies[parameter->body].velocity[parameter->component];
  case FEM_PARAMETER_START_SPIN:
    return model->scene->bodies[parameter->body].spin[parameter->component];
  case FEM_PARAMETER_CONTACT_VISCOSITY:
    return contact_of(model)->viscosity;
  default:
    return value_of_material(model, parameter);
  }
}

const char *fem_parameter_unit(const FemModel *model, const FemParameter *parameter) {
  if (parameter->kind != FEM_PARAMETER_LOAD) return kinds[parameter->kind].unit;
  FemLoadKind kind = model->scene->bodies[parameter->body].loads[parameter->item].kind;
  if (kind == FEM_LOAD_BODY_FORCE) return "N/m³";
  return kind == FEM_LOAD_TRACTION || kind == FEM_LOAD_PRESSURE ? "Pa" : "N";
}
