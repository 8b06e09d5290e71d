// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/change.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/gravity.h"
#include "fem/gradient/difference.h"
#include "fem/model/parts.h"
#include "fem/scene/drive.h"

static size_t values_of(const FemTangent *tangent) {
  return 3 * (size_t)tangent->system->model->vertex_count;
}

Status fem_change_create(FemChange *change, const FemTangent *tangent) {
  size_t values = values_of(tangent);
  *change = (FemChange){.party = -1, .wants_elastic = true};
  change->force = memory_zeroed(values, sizeof(double));
  change->motion = memory_zeroed(values, sizeof(double));
  change->speed = memory_zeroed(values, sizeof(double));
  change->rests = memory_zeroed(values, sizeof(double));
  change->product = memory_zeroed(values, sizeof(double));
  change->contact = memory_zeroed(values, sizeof(double));
  change->rates = memory_zeroed((size_t)tangent->interface_count, sizeof(double));
  change->slips = memory_zeroed((size_t)tangent->interface_count, sizeof(double));
  change->masses = memory_zeroed(values / 3, sizeof(double));
  bool fits = change->force && change->motion && change->speed && change->rests && change->product &&
              change->contact && change->rates && change->slips && change->masses;
  return fits ? STATUS_OK : status_no_memory("what a parameter changes");
}

void fem_change_destroy(FemChange *change) {
  memory_free(change->force);
  memory_free(change->motion);
  memory_free(change->speed);
  memory_free(change->rests);
  fem_shape_destroy(&change->shape);
  memory_free(change->rates);
  memory_free(change->slips);
  memory_free(change->masses);
  memory_free(change->product);
  memory_free(change->contact);
  *change = (FemChange){0};
}

static void clear(FemChange *change, const FemTangent *tangent) {
  size_t bytes = values_of(tangent) * sizeof(double);
  memset(change->force, 0, bytes);
  memset(change->motion, 0, bytes);
  memset(change->speed, 0, bytes);
  memset(change->rates, 0, (size_t)tangent->interface_count * sizeof(double));
  memset(change->slips, 0, (size_t)tangent->interface_count * sizeof(double));
  memset(change->rests, 0, bytes);
  memset(change->masses, 0, bytes / 3);
  fem_shape_destroy(&change->shape);
  change->party = -1;
  change->elastic = change->gravity = 0;
  change->law = (FemVariedLaw){0};
  for (int c = 0; c < 3; c++) change->shift[c] = change->spin[c] = 0;
}

// ---- Weight.

// Of vertices whose weight changes by m `by`; in a static scene the energy is that of rest and of what has
// grown (fem/effect/gravity.c).
static void add_weight(FemChange *change, const FemTangent *tangent, const double by[3],
                       const double *masses) {
  const FemModel *model = tangent->system->model;
  double share = fem_gravity_share(model, tangent->state->time);
  for (int a = 0; a < model->vertex_count; a++)
    for (size_t c = 0, dof = 3 * (size_t)a; c < 3; c++, dof++) {
      double rest = model->rest[dof], way = tangent->state->positions[dof] - rest;
      change->force[dof] += share * masses[a] * by[c];
      change->gravity -= masses[a] * by[c] * (rest + share * way);
    }
}

// ---- Loads.

// Nodal forces are linear in the load's vector and carry its direction.
static Status press(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  const FemModel *model = tangent->system->model;
  const FemLoadDef *def = &model->scene->bodies[parameter->body].loads[parameter->item];
  for (int i = 0; i < model->load_count; i++) {
    const FemLoad *load = &model->loads[i];
    double factor, square = vec3_dot(vec3_at(def->vector), vec3_at(def->vector));
    if (load->def != def) continue;
    TRY(fem_load_factor(def, tangent->state->time, &factor));
    if (def->kind == FEM_LOAD_PRESSURE && !def->is_dead)
      fem_load_add_force(load, factor / def->pressure, tangent->state->positions, change->force);
    for (int k = 0; k < load->vertex_count; k++) {
      Vec3 own = vec3_at(load->force + 3 * (size_t)k);
      double *force = change->force + 3 * (size_t)load->vertices[k];
      if (def->kind == FEM_LOAD_PRESSURE)
        vec3_accumulate(force, vec3_scale(factor / def->pressure, own));
      else
        force[parameter->component] += factor * vec3_dot(own, vec3_at(def->vector)) / square;
    }
  }
  return STATUS_OK;
}

// ---- Prescribed motion.

// A step for differences by a motion's parameter; at the beginning, where it does not act yet, any.
static double step_of(const FemParameter *parameter, double time, double length) {
  static const double TURN = 1e-2; // [rad]
  double rate = time > 0 ? 1 / time : 1;
  switch (parameter->kind) {
  case FEM_PARAMETER_VELOCITY:
    return length * rate;
  case FEM_PARAMETER_FREQUENCY:
    return TURN / (2 * M_PI) * rate;
  case FEM_PARAMETER_SPIN:
    return TURN * rate;
  default:
    return length;
  }
}

// A motion whose copy can be changed.
typedef struct Motion {
  FemConstraintDef def;
  double *value, middle, step, time;
  bool is_over; // it stands since `until`
} Motion;

static Status copy_motion(Motion *motion, const FemConstraintDef *def, const FemParameter *parameter,
                          double time, double length) {
  *motion = (Motion){.def = *def, .time = fmin(time, def->until), .is_over = time >= def->until};
  motion->def.table = memory_copy(def->table, 4 * (size_t)def->table_count, sizeof(double));
  if (!motion->def.table) return status_no_memory("a motion");
  motion->value = fem_parameter_of_motion(&motion->def, parameter);
  motion->step = step_of(parameter, motion->time, length);
  motion->middle = *motion->value;
  return STATUS_OK;
}

// ∂x/∂p and ∂v/∂p of what rests at a point.
static Vec3 move_point(Motion *motion, const double rest[3], Vec3 *speed) {
  Vec3 sum = {0, 0, 0};
  *speed = (Vec3){0, 0, 0};
  for (int k = 0; k < FEM_DIFFERENCE_POINTS; k++) {
    double position[3], velocity[3];
    *motion->value = motion->middle + fem_difference[k].place * motion->step;
    fem_drive_point(&motion->def, motion->time, rest, position, velocity);
    sum = vec3_add(
        sum, vec3_scale(fem_difference[k].weight / motion->step, vec3_sub(vec3_at(position), vec3_at(rest))));
    *speed = vec3_add(*speed, vec3_scale(fem_difference[k].weight / motion->step, vec3_at(velocity)));
  }
  if (motion->is_over) *speed = (Vec3){0, 0, 0};
  return sum;
}

static void move_vertices(FemChange *change, const FemModel *model, const FemConstraintDef *def,
                          Motion *motion) {
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count && driver->def == def; i++) {
      double moved[3], faster[3];
      int dof = driver->dofs[i];
      Vec3 speed;
      vec3_store(moved, move_point(motion, model->rest + (dof - dof % 3), &speed));
      vec3_store(faster, speed);
      change->motion[dof] = moved[dof % 3];
      change->speed[dof] = faster[dof % 3];
    }
  }
}

// A displacement moves all of an obstacle alike; a spin turns it about its axis, which a displacement that
// comes afterwards has carried along.
static void move_obstacle(FemChange *change, const FemConstraintDef *def, const FemParameter *parameter,
                          Motion *motion) {
  static const double origin[3] = {0, 0, 0};
  Vec3 speed;
  if (parameter->kind != FEM_PARAMETER_SPIN) {
    vec3_store(change->shift, move_point(motion, origin, &speed));
    return;
  }
  double centre[3], velocity[3];
  Vec3 axis = vec3_at(def->axis);
  fem_drive_point(def, motion->time, def->centre, centre, velocity);
  Vec3 about = vec3_at(def->moves_first ? def->centre : centre);
  Vec3 spin = vec3_scale(motion->time / vec3_length(axis), axis);
  vec3_store(change->spin, spin);
  vec3_store(change->shift, vec3_cross(about, spin));
}

static Status move(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  const FemModel *model = tangent->system->model;
  const FemConstraintDef *def = fem_parameter_motion(model, parameter);
  Motion motion;
  Status status = copy_motion(&motion, def, parameter, tangent->state->time, model->length);
  if (!status && parameter->obstacle >= 0) {
    change->party = fem_change_party(model, parameter->obstacle);
    move_obstacle(change, def, parameter, &motion);
  } else if (!status) {
    move_vertices(change, model, def, &motion);
  }
  memory_free(motion.def.table);
  return status;
}

// ---- Places.

int fem_change_party(const FemModel *model, int obstacle) {
  const FemObstacleDef *obstacles = model->scene->obstacles;
  bool is_mesh = obstacles[obstacle].kind == FEM_OBSTACLE_MESH;
  int before = 0;
  for (int o = 0; o < obstacle; o++) before += (obstacles[o].kind == FEM_OBSTACLE_MESH) == is_mesh;
  return before + (is_mesh ? model->scene->body_count : model->body_count);
}

// A step of what rests, as a motion has turned it, and the velocity that it has there.
static Vec3 turned_step(const FemConstraintDef *def, double time, const double step[3], Vec3 *speed) {
  double from[3], to[3], slow[3], fast[3];
  fem_drive_point(def, time, (const double[3]){0, 0, 0}, from, slow);
  fem_drive_point(def, time, step, to, fast);
  *speed = vec3_sub(vec3_at(fast), vec3_at(slow));
  return vec3_sub(vec3_at(to), vec3_at(from));
}

// What is held or driven goes along with where it rests.
static void carry(FemChange *change, const FemTangent *tangent) {
  const FemModel *model = tangent->system->model;
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count; i++) {
      int dof = driver->dofs[i];
      double step[3], faster[3];
      Vec3 speed;
      vec3_store(step,
                 turned_step(driver->def, tangent->state->time, change->rests + (dof - dof % 3), &speed));
      vec3_store(faster, speed);
      change->motion[dof] = step[dof % 3];
      change->speed[dof] = faster[dof % 3];
    }
  }
}

static void place_body(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  const FemModel *model = tangent->system->model;
  const FemModelBody *body = &model->bodies[parameter->body];
  fem_shape_rest(model, parameter, change->rests);
  carry(change, tangent);
  double unseen = 1 - fem_gravity_share(model, tangent->state->time);
  for (int a = body->vertex_begin; a < body->vertex_end && model->scene->has_gravity; a++)
    change->gravity -= unseen * model->mass[a] * model->scene->gravity[parameter->component];
}

static void place(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  const FemModel *model = tangent->system->model;
  if (parameter->obstacle < 0) {
    place_body(change, tangent, parameter);
    return;
  }
  double step[3] = {0, 0, 0};
  step[parameter->component] = 1;
  change->party = fem_change_party(model, parameter->obstacle);
  const FemConstraintDef *motion = &model->scene->obstacles[parameter->obstacle].motion;
  Vec3 speed;
  vec3_store(change->shift, turned_step(motion, tangent->state->time, step, &speed));
}

static Status reshape(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  fem_shape_rest(tangent->system->model, parameter, change->rests);
  carry(change, tangent);
  if (!(tangent->state->time > 0)) return STATUS_OK; // where a path begins, at rest
  TRY(fem_shape_derive(&change->shape, tangent, parameter->body, change->rests));
  size_t values = values_of(tangent);
  for (size_t i = 0; i < values; i++) change->force[i] += change->shape.force[i];
  memcpy(change->masses, change->shape.masses, values / 3 * sizeof(double));
  change->elastic += change->shape.elastic;
  change->gravity += change->shape.gravity;
  return STATUS_OK;
}

// ---- Stiffness of contact.

static void rate_contact(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  const FemModel *model = tangent->system->model;
  int pair = parameter->kind == FEM_PARAMETER_PAIR_STIFFNESS ? parameter->item : -1;
  for (int i = 0; i < tangent->interface_count; i++) {
    const ContactInterfaceDef *interface = fem_tangent_interface(tangent, i);
    if (!interface->law && fem_parameter_pair(model, interface->a, interface->b) == pair)
      change->rates[i] = 1 / interface->stiffness;
  }
}

static void rub(FemChange *change, const FemTangent *tangent, const FemParameter *parameter) {
  int pair = parameter->kind == FEM_PARAMETER_PAIR_FRICTION ? parameter->item : -1;
  for (int i = 0; i < tangent->interface_count; i++) {
    const ContactInterfaceDef *interface = fem_tangent_interface(tangent, i);
    change->slips[i] =
        fem_parameter_friction_pair(tangent->system->model, interface->a, interface->b) == pair;
  }
}

static Status rate_choice(FemChange *change, FemVaried *varied, const FemTangent *tangent, int part,
                          FemParameterKind constant) {
  double *rates;
  int parties;
  Status status = fem_varied_derive_stiffness(varied, part, constant, &rates, &parties);
  for (int i = 0; i < tangent->interface_count && !status; i++) {
    const ContactInterfaceDef *interface = fem_tangent_interface(tangent, i);
    if (!interface->law) change->rates[i] = rates[interface->a * parties + interface->b];
  }
  memory_free(rates);
  return status;
}

static double *elastic_of(FemChange *change) {
  return change->wants_elastic ? &change->elastic : NULL;
}

// Plasticity's part is apart (fem/gradient/effect/yielding.h).
static Status change_material(FemChange *change, FemVaried *varied, const FemTangent *tangent,
                              const FemParameter *parameter, bool follows) {
  FemParameterKind constant = parameter->kind;
  if (fem_parameter_is_of_yielding(parameter)) return STATUS_OK;
  bool is_elastic = constant == FEM_PARAMETER_YOUNG || constant == FEM_PARAMETER_POISSON;
  TRY(fem_varied_derive(varied, parameter->part, constant, parameter->row, tangent->state, change->force,
                        elastic_of(change)));
  if (!follows || !is_elastic || !tangent->contact) return STATUS_OK;
  return rate_choice(change, varied, tangent, parameter->part, constant);
}

// By the damping of all materials that have none of their own.
static Status damp(FemChange *change, FemVaried *varied, const FemTangent *tangent) {
  const FemModel *model = tangent->system->model;
  for (int p = 0; p < model->part_count; p++)
    if (model->parts[p].material.damping < 0)
      TRY(fem_varied_derive(varied, p, FEM_PARAMETER_DAMPING, 0, tangent->state, change->force,
                            elastic_of(change)));
  return STATUS_OK;
}

// ---- What follows for contact.

bool fem_change_moves(const FemChange *change, const FemTangent *tangent, int interface) {
  return change->party >= 0 && fem_tangent_interface(tangent, interface)->b == change->party;
}

void fem_change_field(const FemChange *change, const FemTangent *tangent, int interface, double *field) {
  const FemModelBody *body = &tangent->system->model->bodies[fem_tangent_interface(tangent, interface)->a];
  memset(field, 0, values_of(tangent) * sizeof *field);
  for (size_t a = (size_t)body->vertex_begin; a < (size_t)body->vertex_end; a++)
    vec3_store(field + 3 * a,
               vec3_add(vec3_at(change->shift),
                        vec3_cross(vec3_at(change->spin), vec3_at(tangent->state->positions + 3 * a))));
}

static void turn_forces(const FemChange *change, const FemTangent *tangent, int interface, double *force) {
  const FemModelBody *body = &tangent->system->model->bodies[fem_tangent_interface(tangent, interface)->a];
  for (size_t a = (size_t)body->vertex_begin; a < (size_t)body->vertex_end; a++)
    vec3_accumulate(force + 3 * a, vec3_cross(vec3_at(change->spin), vec3_at(change->contact + 3 * a)));
}

Status fem_change_add_contact(FemChange *change, const FemTangent *tangent, int interface, double *force) {
  size_t values = values_of(tangent);
  bool moves = fem_change_moves(change, tangent, interface);
  fem_varied_add_law(&change->law, interface, force);
  if (change->shape.contact)
    for (size_t i = 0; i < values; i++) force[i] += change->shape.contact[values * (size_t)interface + i];
  if (!moves && change->rates[interface] == 0) return STATUS_OK;
  memset(change->contact, 0, values * sizeof(double));
  TRY(fem_tangent_add_contact(tangent, interface, change->contact));
  for (size_t i = 0; i < values; i++) force[i] += change->rates[interface] * change->contact[i];
  if (!moves) return STATUS_OK;
  turn_forces(change, tangent, interface, force);
  fem_change_field(change, tangent, interface, change->product);
  return fem_tangent_add_contact_product(tangent, interface, false, change->product, force);
}

static Status find(FemChange *change, FemVaried *varied, const FemTangent *tangent,
                   const FemParameter *parameter, bool follows) {
  double by[3] = {0, 0, 0};
  if (parameter->kind == FEM_PARAMETER_DAMPING && parameter->part < 0) return damp(change, varied, tangent);
  if (fem_parameter_is_of_material(parameter))
    return change_material(change, varied, tangent, parameter, follows);
  if (fem_parameter_is_of_motion(parameter)) return move(change, tangent, parameter);
  if (fem_parameter_is_of_law(parameter))
    return fem_varied_derive_law(varied, parameter, tangent->state, &change->law);
  if (fem_parameter_is_of_shape(parameter)) return reshape(change, tangent, parameter);
  switch (parameter->kind) {
  case FEM_PARAMETER_DENSITY:
    fem_model_parts_spread(tangent->system->model, parameter->part, change->masses);
    add_weight(change, tangent, tangent->system->model->scene->gravity, change->masses);
    break;
  case FEM_PARAMETER_GRAVITY:
    by[parameter->component] = 1;
    add_weight(change, tangent, by, tangent->system->model->mass);
    break;
  case FEM_PARAMETER_LOAD:
    return press(change, tangent, parameter);
  case FEM_PARAMETER_PLACE:
    place(change, tangent, parameter);
    break;
  case FEM_PARAMETER_CONTACT_STIFFNESS:
  case FEM_PARAMETER_PAIR_STIFFNESS:
    rate_contact(change, tangent, parameter);
    break;
  case FEM_PARAMETER_FRICTION:
  case FEM_PARAMETER_PAIR_FRICTION:
    rub(change, tangent, parameter);
    break;
  default: // acts in motions alone
    break;
  }
  return STATUS_OK;
}

Status fem_change_find(FemChange *change, FemVaried *varied, const FemTangent *tangent,
                       const FemParameter *parameter, bool follows) {
  clear(change, tangent);
  if (fem_parameter_idle(tangent->system->model, parameter)) return STATUS_OK;
  TRY(find(change, varied, tangent, parameter, follows));
  for (int i = 0; i < tangent->interface_count; i++)
    TRY(fem_change_add_contact(change, tangent, i, change->force));
  return STATUS_OK;
}
