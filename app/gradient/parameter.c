// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/parameter.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/gradient/names.h"

enum { MAX_NUMBERS = 3 };

// A key of the scene, # a number.
typedef struct Key {
  const char *text;
  FemParameterKind kind;
  // Which of its numbers is the parameter's item, row, component; −1: none.
  int item, row, component;
} Key;

static const Key body_keys[] = {
    {"material.young", FEM_PARAMETER_YOUNG, -1, -1, -1},
    {"material.poisson", FEM_PARAMETER_POISSON, -1, -1, -1},
    {"material.density", FEM_PARAMETER_DENSITY, -1, -1, -1},
    {"material.plasticity.yield", FEM_PARAMETER_YIELD, -1, -1, -1},
    {"material.plasticity.hardening", FEM_PARAMETER_HARDENING, -1, -1, -1},
    {"material.mooney", FEM_PARAMETER_MOONEY, -1, -1, -1},
    {"material.ogden.exponents[#]", FEM_PARAMETER_OGDEN_EXPONENT, -1, 0, -1},
    {"material.ogden.shares[#]", FEM_PARAMETER_OGDEN_SHARE, -1, 0, -1},
    {"material.fibre.modulus", FEM_PARAMETER_FIBRE, -1, -1, -1},
    {"material.fibre.direction[#]", FEM_PARAMETER_FIBRE_DIRECTION, -1, 0, -1},
    {"velocity[#]", FEM_PARAMETER_START, -1, -1, 0},
    {"spin[#]", FEM_PARAMETER_START_SPIN, -1, -1, 0},
    {"material.damping", FEM_PARAMETER_DAMPING, -1, -1, -1},
    {"material.viscosity", FEM_PARAMETER_VISCOSITY, -1, -1, -1},
    {"material.bulk_viscosity", FEM_PARAMETER_BULK_VISCOSITY, -1, -1, -1},
    {"place.translate[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"place.scale", FEM_PARAMETER_SCALE, -1, -1, -1},
    {"place.scale[#]", FEM_PARAMETER_SCALE, -1, -1, 0},
    {"place.rotate.degrees", FEM_PARAMETER_ROTATE, -1, -1, -1},
    {"rest[#][#]", FEM_PARAMETER_REST, -1, 0, 1},
    {"loads[#].force[#]", FEM_PARAMETER_LOAD, 0, -1, 1},
    {"loads[#].body_force[#]", FEM_PARAMETER_LOAD, 0, -1, 1},
    {"loads[#].traction[#]", FEM_PARAMETER_LOAD, 0, -1, 1},
    {"loads[#].pressure", FEM_PARAMETER_LOAD, 0, -1, -1},
    {"driven[#].velocity[#]", FEM_PARAMETER_VELOCITY, 0, -1, 1},
    {"driven[#].amplitude[#]", FEM_PARAMETER_AMPLITUDE, 0, -1, 1},
    {"driven[#].frequency", FEM_PARAMETER_FREQUENCY, 0, -1, -1},
    {"driven[#].spin", FEM_PARAMETER_SPIN, 0, -1, -1},
    {"driven[#].table[#][#]", FEM_PARAMETER_TABLE, 0, 1, 2},
};

static const Key obstacle_keys[] = {
    {"halfspace.point[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"sphere.centre[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"box.centre[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"cylinder.centre[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"place.translate[#]", FEM_PARAMETER_PLACE, -1, -1, 0},
    {"velocity[#]", FEM_PARAMETER_VELOCITY, -1, -1, 0},
    {"motion.velocity[#]", FEM_PARAMETER_VELOCITY, -1, -1, 0},
    {"motion.amplitude[#]", FEM_PARAMETER_AMPLITUDE, -1, -1, 0},
    {"motion.frequency", FEM_PARAMETER_FREQUENCY, -1, -1, -1},
    {"motion.spin", FEM_PARAMETER_SPIN, -1, -1, -1},
    {"motion.table[#][#]", FEM_PARAMETER_TABLE, -1, 0, 1},
};

static const Key scene_keys[] = {
    {"contact.stiffness", FEM_PARAMETER_CONTACT_STIFFNESS, -1, -1, -1},
    {"contact.pairs[#].stiffness", FEM_PARAMETER_PAIR_STIFFNESS, 0, -1, -1},
    {"contact.law.power.pressure", FEM_PARAMETER_LAW_PRESSURE, -1, -1, -1},
    {"contact.law.power.depth", FEM_PARAMETER_LAW_DEPTH, -1, -1, -1},
    {"contact.law.power.exponent", FEM_PARAMETER_LAW_EXPONENT, -1, -1, -1},
    {"contact.law.exponential.pressure", FEM_PARAMETER_LAW_PRESSURE, -1, -1, -1},
    {"contact.law.exponential.depth", FEM_PARAMETER_LAW_DEPTH, -1, -1, -1},
    {"contact.law.table[#][#]", FEM_PARAMETER_LAW_TABLE, -1, 0, 1},
    {"contact.pairs[#].law.power.pressure", FEM_PARAMETER_LAW_PRESSURE, 0, -1, -1},
    {"contact.pairs[#].law.power.depth", FEM_PARAMETER_LAW_DEPTH, 0, -1, -1},
    {"contact.pairs[#].law.power.exponent", FEM_PARAMETER_LAW_EXPONENT, 0, -1, -1},
    {"contact.pairs[#].law.exponential.pressure", FEM_PARAMETER_LAW_PRESSURE, 0, -1, -1},
    {"contact.pairs[#].law.exponential.depth", FEM_PARAMETER_LAW_DEPTH, 0, -1, -1},
    {"contact.pairs[#].law.table[#][#]", FEM_PARAMETER_LAW_TABLE, 0, 1, 2},
    {"contact.friction.coefficient", FEM_PARAMETER_FRICTION, -1, -1, -1},
    {"contact.pairs[#].friction.coefficient", FEM_PARAMETER_PAIR_FRICTION, 0, -1, -1},
    {"contact.friction", FEM_PARAMETER_FRICTION, -1, -1, -1},
    {"contact.pairs[#].friction", FEM_PARAMETER_PAIR_FRICTION, 0, -1, -1},
    {"contact.viscosity", FEM_PARAMETER_CONTACT_VISCOSITY, -1, -1, -1},
    {"effects.gravity[#]", FEM_PARAMETER_GRAVITY, -1, -1, 0},
    {"effects.damping", FEM_PARAMETER_DAMPING, -1, -1, -1},
};

// Keys by which there are derivatives, for messages.
static const char keys_with_derivatives[] =
    "bodies.NAME.material.{young, poisson, density, mooney, ogden.exponents[K], ogden.shares[K], "
    "fibre.modulus, fibre.direction[K], plasticity.{yield, hardening}, damping, viscosity, bulk_viscosity}, "
    "bodies.NAME.materials[N].{…} the same; "
    "bodies.NAME.loads[N].{force[K], body_force[K], traction[K], pressure}; "
    "bodies.NAME.driven[N].{velocity[K], amplitude[K], frequency, spin, table[ROW][1 to 3]}; "
    "bodies.NAME.{place.{translate[K], scale, scale[K], rotate.degrees}, rest[VERTEX][K], velocity[K], "
    "spin[K]}; "
    "obstacles.NAME.{halfspace.point[K], sphere.centre[K], box.centre[K], cylinder.centre[K], "
    "place.translate[K]}; "
    "obstacles.NAME.motion.{velocity[K], amplitude[K], frequency, spin, table[ROW][1 to 3]}; "
    "contact.stiffness, contact.friction, contact.law.{power.{pressure, depth, exponent}, "
    "exponential.{pressure, depth}, table[ROW][1]}, contact.pairs[N].{stiffness, friction, law.…}; "
    "effects.gravity[K], effects.damping";

static bool matches(const char *key, const char *pattern, int numbers[MAX_NUMBERS]) {
  int count = 0;
  for (; *pattern; pattern++) {
    if (*pattern != '#') {
      if (*key++ != *pattern) return false;
      continue;
    }
    char *end;
    if (!isdigit((unsigned char)*key)) return false;
    long number = strtol(key, &end, 10);
    numbers[count++] = number < INT_MAX ? (int)number : INT_MAX;
    key = end;
  }
  return *key == 0;
}

static bool find_key(const char *text, const Key *keys, size_t count, FemParameter *parameter) {
  int numbers[MAX_NUMBERS];
  for (size_t k = 0; k < count; k++) {
    if (!matches(text, keys[k].text, numbers)) continue;
    parameter->kind = keys[k].kind;
    if (keys[k].item >= 0) parameter->item = numbers[keys[k].item];
    if (keys[k].row >= 0) parameter->row = numbers[keys[k].row];
    if (keys[k].component >= 0) parameter->component = numbers[keys[k].component];
    if (parameter->kind == FEM_PARAMETER_SCALE && keys[k].component < 0) parameter->component = -1;
    return true;
  }
  return false;
}

// The keys of a part are those of a material. `item`: of the body's materials; −1: its own.
static bool find_body_key(const char *text, FemParameter *parameter, int *item) {
  static const char parts[] = "materials[";
  const size_t count = sizeof body_keys / sizeof *body_keys;
  char key[64], *end;
  *item = -1;
  if (strncmp(text, parts, strlen(parts)) != 0) return find_key(text, body_keys, count, parameter);
  text += strlen(parts);
  long number = isdigit((unsigned char)*text) ? strtol(text, &end, 10) : -1;
  if (number < 0 || *end != ']') return false;
  *item = number < INT_MAX ? (int)number : INT_MAX;
  return snprintf(key, sizeof key, "material%s", end + 1) < (int)sizeof key &&
         find_key(key, body_keys, count, parameter);
}

static bool is_in_range(FemParameter *parameter) {
  bool is_of_three = parameter->kind == FEM_PARAMETER_OGDEN_EXPONENT ||
                     parameter->kind == FEM_PARAMETER_OGDEN_SHARE ||
                     parameter->kind == FEM_PARAMETER_FIBRE_DIRECTION;
  if (parameter->kind == FEM_PARAMETER_TABLE) parameter->component--; // behind the time
  return parameter->component <= 2 && (!is_of_three || parameter->row <= 2);
}

// What is of the kind that the key says: a traction is no force, a sphere no box.
static bool is_of_kind(const FemSceneDef *scene, const char *rest, const FemParameter *parameter) {
  static const char *const loads[] = {[FEM_LOAD_FORCE] = "].force[",
                                      [FEM_LOAD_BODY_FORCE] = "].body_force[",
                                      [FEM_LOAD_TRACTION] = "].traction[",
                                      [FEM_LOAD_PRESSURE] = "].pressure"};
  static const char *const shapes[] = {[FEM_OBSTACLE_MESH] = "place.",
                                       [FEM_OBSTACLE_HALFSPACE] = "halfspace.",
                                       [FEM_OBSTACLE_BALL] = "sphere.",
                                       [FEM_OBSTACLE_BOX] = "box.",
                                       [FEM_OBSTACLE_CYLINDER] = "cylinder."};
  if (parameter->kind == FEM_PARAMETER_LOAD) {
    const FemBodyDef *body = &scene->bodies[parameter->body];
    if (parameter->item >= body->load_count) return true; // is told later
    FemLoadKind kind = body->loads[parameter->item].kind;
    return kind <= FEM_LOAD_PRESSURE && strstr(rest, loads[kind]) != NULL;
  }
  if (parameter->kind != FEM_PARAMETER_PLACE || parameter->obstacle < 0) return true;
  const char *shape = shapes[scene->obstacles[parameter->obstacle].kind];
  return strncmp(rest, shape, strlen(shape)) == 0;
}

// The same of a law, where there is one; else it is told later.
static bool is_of_law(const FemModel *model, const char *key, const FemParameter *parameter) {
  static const char *const laws[] = {[CONTACT_LAW_POWER] = ".power.",
                                     [CONTACT_LAW_EXPONENTIAL] = ".exponential.",
                                     [CONTACT_LAW_TABLE] = ".table["};
  const ContactLaw *law = fem_parameter_law(model, parameter);
  return !law || (law->kind <= CONTACT_LAW_TABLE && strstr(key, laws[law->kind]) != NULL);
}

static Status fail_key(void) {
  return status_fail(STATUS_INPUT, "no derivative by it; there are, with K 0 to 2, %s",
                     keys_with_derivatives);
}

// The number of NAME in "bodies.NAME.…"; `rest` is what follows the name, which ends at the first dot.
static Status find_owner(const FemSceneDef *scene, const char *key, const char *list, int begin, int end,
                         int *number, const char **rest) {
  const char *name = key + strlen(list);
  const char *dot = strchr(name, '.');
  if (!dot) return fail_key();
  *rest = dot + 1;
  return app_gradient_find_name(scene, name, (size_t)(dot - name), begin, end, number);
}

static bool is_of_part(const FemParameter *parameter) {
  return fem_parameter_is_of_material(parameter) || parameter->kind == FEM_PARAMETER_DENSITY;
}

static Status find_part(const FemModel *model, int item, FemParameter *parameter) {
  const FemModelBody *body = &model->bodies[parameter->body];
  for (int p = body->part_begin; p < body->part_end; p++)
    if (model->parts[p].item == item) parameter->part = p;
  if (parameter->part >= 0) return STATUS_OK;
  if (item < 0)
    return status_fail(STATUS_INPUT, "body '%s': no tetrahedron is of `material`, all are of `materials`",
                       body->name);
  return status_fail(STATUS_INPUT, "body '%s' has %d materials, no materials[%d]", body->name,
                     model->scene->bodies[parameter->body].part_count, item);
}

static Status read_owned(const FemModel *model, const char *key, FemParameter *parameter) {
  static const char bodies[] = "bodies.", obstacles[] = "obstacles.";
  const FemSceneDef *scene = model->scene;
  const size_t of_obstacle = sizeof obstacle_keys / sizeof *obstacle_keys;
  int all = scene->body_count + scene->obstacle_count;
  const char *rest = NULL;
  bool is_known;
  int item = -1;
  if (strncmp(key, bodies, strlen(bodies)) == 0) {
    TRY(find_owner(scene, key, bodies, 0, scene->body_count, &parameter->body, &rest));
    is_known = find_body_key(rest, parameter, &item);
  } else {
    TRY(find_owner(scene, key, obstacles, scene->body_count, all, &parameter->obstacle, &rest));
    parameter->obstacle -= scene->body_count;
    is_known = find_key(rest, obstacle_keys, of_obstacle, parameter);
  }
  if (!is_known || !is_in_range(parameter)) return fail_key();
  if (is_of_part(parameter)) TRY(find_part(model, item, parameter));
  if (is_of_kind(scene, rest, parameter)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "the scene does not have this key");
}

static Status read_parameter(const FemModel *model, const char *key, FemParameter *parameter) {
  static const char *const lists[] = {"bodies.", "obstacles."};
  for (int k = 0; k < 2; k++)
    if (strncmp(key, lists[k], strlen(lists[k])) == 0) return read_owned(model, key, parameter);
  if (!find_key(key, scene_keys, sizeof scene_keys / sizeof *scene_keys, parameter)) return fail_key();
  if (!is_in_range(parameter)) return fail_key();
  if (!fem_parameter_is_of_law(parameter) || is_of_law(model, key, parameter)) return STATUS_OK;
  return status_fail(STATUS_INPUT, "the scene does not have this key");
}

Status app_gradient_read_parameter(const FemModel *model, const char *key, FemParameter *parameter) {
  *parameter = (FemParameter){.body = -1, .part = -1, .obstacle = -1, .item = -1};
  Status status = read_parameter(model, key, parameter);
  if (!status) status = fem_parameter_check(model, parameter);
  return status_prefix(status, "%s", key);
}
