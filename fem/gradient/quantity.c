// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/quantity.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/gravity.h"
#include "fem/gradient/contact/pressure.h"
#include "fem/model/limits.h"

// ---- What there is.

static bool is_held(const FemModel *model, const FemConstraintDef *def) {
  for (int d = 0; d < model->driver_count; d++)
    if (model->drivers[d].def == def) return true;
  return false;
}

static Status check_contact(const FemModel *model, const FemQuantity *quantity) {
  if (!model->scene->contact.is_on) return status_fail(STATUS_INPUT, "the scene has no contact");
  if (quantity->body == quantity->other)
    return status_fail(STATUS_INPUT, "a body does not press itself as a whole: name two");
  return STATUS_OK;
}

static Status check_vertex(const FemModel *model, const FemQuantity *quantity) {
  const FemModelBody *body = &model->bodies[quantity->body];
  int count = body->vertex_end - body->vertex_begin;
  if (quantity->vertex >= 0 && quantity->vertex < count) return STATUS_OK;
  return status_fail(STATUS_INPUT, "body '%s' has the vertices 0 to %d, no %d", body->name, count - 1,
                     quantity->vertex);
}

static Status check_energy(const FemModel *model, const FemQuantity *quantity) {
  if (quantity->energies == FEM_QUANTITY_CONTACT && !model->scene->contact.is_on)
    return status_fail(STATUS_INPUT, "the scene has no contact");
  if (quantity->energies == FEM_QUANTITY_GRAVITY && !model->scene->has_gravity)
    return status_fail(STATUS_INPUT, "the scene has no effects.gravity");
  if (quantity->energies & FEM_QUANTITY_CONTACT && fem_remainder_is_there(model))
    return status_fail(STATUS_INPUT,
                       "the energy of contact has a derivative with contact.overlap: clip alone, and without "
                       "contact.law; energy:elastic and energy:gravity have theirs");
  return STATUS_OK;
}

Status fem_quantity_check(const FemModel *model, const FemQuantity *quantity) {
  switch (quantity->kind) {
  case FEM_QUANTITY_POSITION:
    return check_vertex(model, quantity);
  case FEM_QUANTITY_FORCE:
  case FEM_QUANTITY_MOMENT:
    return check_contact(model, quantity);
  case FEM_QUANTITY_PATCH:
    if (model->scene->contact.is_on) return STATUS_OK;
    return status_fail(STATUS_INPUT, "the scene has no contact");
  case FEM_QUANTITY_PRESSURE:
    return fem_pressure_check(model);
  case FEM_QUANTITY_REACTION:
    if (is_held(model, quantity->held)) return STATUS_OK;
    return status_fail(STATUS_INPUT, "nothing is held there");
  case FEM_QUANTITY_ENERGY:
    return check_energy(model, quantity);
  case FEM_QUANTITY_DISPLACEMENT:
  case FEM_QUANTITY_PROBE:
    break;
  }
  return STATUS_OK;
}

const char *fem_quantity_unit(const FemQuantity *quantity) {
  switch (quantity->kind) {
  case FEM_QUANTITY_FORCE:
  case FEM_QUANTITY_PATCH:
  case FEM_QUANTITY_REACTION:
    return "N";
  case FEM_QUANTITY_PRESSURE:
    return "Pa";
  case FEM_QUANTITY_MOMENT:
    return "N m";
  case FEM_QUANTITY_ENERGY:
    return "J";
  default:
    return "m";
  }
}

// ---- Places.

static size_t values_of(const FemTangent *tangent) {
  return 3 * (size_t)tangent->system->model->vertex_count;
}

// The vertices whose mean is asked for; of a body they stand together.
typedef struct Selection {
  const int *vertices; // NULL: from `begin` on
  int begin, count;
  bool is_displaced; // else the position
} Selection;

static Selection select_vertices(const FemQuantity *quantity, const FemModel *model) {
  if (quantity->kind == FEM_QUANTITY_PROBE) {
    const FemProbe *probe = &model->probes[quantity->body];
    return (Selection){probe->vertices, 0, probe->vertex_count, true};
  }
  const FemModelBody *body = &model->bodies[quantity->body];
  if (quantity->kind == FEM_QUANTITY_POSITION)
    return (Selection){NULL, body->vertex_begin + quantity->vertex, 1, false};
  return (Selection){NULL, body->vertex_begin, body->vertex_end - body->vertex_begin, true};
}

static void evaluate_place(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                           double *value, double *slope) {
  const FemModel *model = tangent->system->model;
  const Selection selection = select_vertices(quantity, model);
  double share = 1.0 / selection.count;
  *value = 0;
  for (int k = 0; k < selection.count; k++) {
    int vertex = selection.vertices ? selection.vertices[k] : selection.begin + k;
    size_t dof = 3 * (size_t)vertex + (size_t)quantity->component;
    *value += share * (tangent->state->positions[dof] - (selection.is_displaced ? model->rest[dof] : 0));
    if (slope) slope[dof] += weight * share;
  }
}

// What rests elsewhere is displaced less, if it stays.
static double change_place(const FemQuantity *quantity, const FemTangent *tangent, const FemChange *change) {
  const Selection selection = select_vertices(quantity, tangent->system->model);
  double sum = 0;
  for (int k = 0; k < selection.count && selection.is_displaced; k++) {
    int vertex = selection.vertices ? selection.vertices[k] : selection.begin + k;
    sum += change->rests[3 * (size_t)vertex + (size_t)quantity->component];
  }
  return -sum / selection.count;
}

// ---- Forces of contact: g = Σ w · f over the vertices of one side.

static bool is_of(const FemQuantity *quantity, const FemModel *model, const ContactInterfaceDef *interface) {
  if (quantity->kind == FEM_QUANTITY_PATCH) {
    int body = model->probes[quantity->body].body;
    return body == interface->a || body == interface->b;
  }
  if (interface->a == interface->b) return false;
  int other = quantity->body == interface->a ? interface->b : interface->a;
  bool is_side = quantity->body == interface->a || quantity->body == interface->b;
  return is_side && (quantity->other < 0 || quantity->other == other);
}

// The body whose vertices are summed over: the one that is asked for, or the one that presses the obstacle,
// with the opposite sign.
static const FemModelBody *summed_body(const FemQuantity *quantity, const FemModel *model,
                                       const ContactInterfaceDef *interface, double *sign) {
  bool is_body = quantity->body < model->scene->body_count;
  *sign = is_body ? 1 : -1;
  return &model->bodies[is_body ? quantity->body : interface->a];
}

static Vec3 unit_of(const FemQuantity *quantity) {
  double unit[3] = {0, 0, 0};
  unit[quantity->component] = 1;
  return vec3_at(unit);
}

// The same of a probe's vertices.
static void weigh_patch(const FemQuantity *quantity, const FemTangent *tangent, double *w) {
  const FemProbe *probe = &tangent->system->model->probes[quantity->body];
  memset(w, 0, values_of(tangent) * sizeof *w);
  for (int k = 0; k < probe->vertex_count; k++)
    w[3 * (size_t)probe->vertices[k] + (size_t)quantity->component] = 1;
}

// w (vertex_count, 3) of an interface.
static void weigh(const FemQuantity *quantity, const FemTangent *tangent, int interface, double *w) {
  double sign;
  if (quantity->kind == FEM_QUANTITY_PATCH) {
    weigh_patch(quantity, tangent, w);
    return;
  }
  const FemModelBody *body =
      summed_body(quantity, tangent->system->model, fem_tangent_interface(tangent, interface), &sign);
  Vec3 unit = vec3_scale(sign, unit_of(quantity));
  memset(w, 0, values_of(tangent) * sizeof *w);
  for (size_t a = (size_t)body->vertex_begin; a < (size_t)body->vertex_end; a++)
    vec3_store(w + 3 * a, quantity->kind == FEM_QUANTITY_FORCE
                              ? unit
                              : vec3_cross(unit, vec3_at(tangent->state->positions + 3 * a)));
}

// Of a moment, what w itself changes by positions.
static void add_arms(const FemQuantity *quantity, const FemTangent *tangent, int interface,
                     const double *force, double weight, double *slope) {
  double sign;
  const FemModelBody *body =
      summed_body(quantity, tangent->system->model, fem_tangent_interface(tangent, interface), &sign);
  for (size_t a = (size_t)body->vertex_begin; a < (size_t)body->vertex_end; a++)
    vec3_accumulate(slope + 3 * a,
                    vec3_scale(sign * weight, vec3_cross(vec3_at(force + 3 * a), unit_of(quantity))));
}

static double dot(const FemTangent *tangent, const double *a, const double *b) {
  double sum = 0;
  for (size_t i = 0; i < values_of(tangent); i++) sum += a[i] * b[i];
  return sum;
}

// Scratch memory of an evaluation.
typedef struct Scratch {
  double *w, *force; // (vertex_count, 3)
} Scratch;

static Status create_scratch(Scratch *scratch, const FemTangent *tangent) {
  scratch->w = memory_zeroed(values_of(tangent), sizeof(double));
  scratch->force = memory_zeroed(values_of(tangent), sizeof(double));
  return scratch->w && scratch->force ? STATUS_OK : status_no_memory("a quantity");
}

static void destroy_scratch(Scratch *scratch) {
  memory_free(scratch->w);
  memory_free(scratch->force);
}

static Status evaluate_interface(const FemQuantity *quantity, const FemTangent *tangent, int interface,
                                 double weight, Scratch *scratch, double *value, double *slope) {
  size_t values = values_of(tangent);
  weigh(quantity, tangent, interface, scratch->w);
  memset(scratch->force, 0, values * sizeof(double));
  TRY(fem_tangent_add_contact(tangent, interface, scratch->force));
  if (tangent->friction) TRY(fem_friction_add_force(tangent->friction, interface, scratch->force));
  *value += dot(tangent, scratch->w, scratch->force);
  if (!slope) return STATUS_OK;
  if (tangent->friction) TRY(fem_friction_pull(tangent->friction, interface, scratch->w, weight));
  TRY(fem_tangent_pull_contact(tangent, interface, scratch->w, weight));
  if (quantity->kind == FEM_QUANTITY_MOMENT)
    add_arms(quantity, tangent, interface, scratch->force, weight, slope);
  memset(scratch->force, 0, values * sizeof(double));
  TRY(fem_tangent_add_contact_product(tangent, interface, true, scratch->w, scratch->force));
  for (size_t i = 0; i < values; i++) slope[i] -= weight * scratch->force[i];
  return STATUS_OK;
}

static Status evaluate_contact(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                               double *value, double *slope) {
  Scratch scratch;
  Status status = create_scratch(&scratch, tangent);
  *value = 0;
  for (int i = 0; i < tangent->interface_count && !status; i++)
    if (is_of(quantity, tangent->system->model, fem_tangent_interface(tangent, i)))
      status = evaluate_interface(quantity, tangent, i, weight, &scratch, value, slope);
  destroy_scratch(&scratch);
  return status;
}

static Status change_contact(const FemQuantity *quantity, const FemTangent *tangent, FemChange *change,
                             double *derivative) {
  Scratch scratch;
  Status status = create_scratch(&scratch, tangent);
  for (int i = 0; i < tangent->interface_count && !status; i++) {
    if (!is_of(quantity, tangent->system->model, fem_tangent_interface(tangent, i))) continue;
    memset(scratch.force, 0, values_of(tangent) * sizeof(double));
    status = fem_change_add_contact(change, tangent, i, scratch.force);
    weigh(quantity, tangent, i, scratch.w);
    *derivative += dot(tangent, scratch.w, scratch.force);
  }
  destroy_scratch(&scratch);
  return status;
}

// ---- Pressures.

static FemPressure pressure_of(const FemQuantity *quantity, int interface, double weight, double *slope) {
  return (FemPressure){.probe = quantity->body,
                       .power = quantity->power,
                       .interface = interface,
                       .weight = weight,
                       .slope = slope};
}

static Status evaluate_pressure(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                                double *value, double *slope) {
  FemPressure pressure = pressure_of(quantity, CONTACT_ALL_INTERFACES, weight, slope);
  if (tangent->answers) pressure.answers = tangent->answers->by;
  return fem_pressure_find(&pressure, tangent, value);
}

// An obstacle that moves changes it as bodies that moved the other way would.
static Status change_pressure(const FemQuantity *quantity, const FemTangent *tangent, FemChange *change,
                              double *derivative) {
  for (int i = 0; i < tangent->interface_count; i++) {
    bool moves = fem_change_moves(change, tangent, i);
    double value;
    if (!moves && change->rates[i] == 0) continue;
    memset(change->contact, 0, values_of(tangent) * sizeof(double));
    FemPressure pressure = pressure_of(quantity, i, 1, change->contact);
    TRY(fem_pressure_find(&pressure, tangent, &value));
    *derivative += change->rates[i] * pressure.stiffness;
    if (!moves) continue;
    fem_change_field(change, tangent, i, change->product);
    *derivative -= dot(tangent, change->product, change->contact);
  }
  return STATUS_OK;
}

// ---- Reactions: g = −Σ f over prescribed coordinates.

// e: 1 where the reaction is summed, else 0 (vertex_count, 3).
static void mark_held(const FemQuantity *quantity, const FemTangent *tangent, double *e) {
  const FemModel *model = tangent->system->model;
  memset(e, 0, values_of(tangent) * sizeof *e);
  for (int d = 0; d < model->driver_count; d++) {
    const FemModelDriver *driver = &model->drivers[d];
    for (int i = 0; i < driver->dof_count && driver->def == quantity->held; i++)
      if (driver->dofs[i] % 3 == quantity->component) e[driver->dofs[i]] = 1;
  }
}

// The slope of −Σ f.
static Status resist(const FemTangent *tangent, double weight, Scratch *scratch, double *slope) {
  TRY(fem_tangent_pull(tangent, scratch->w, scratch->force));
  for (size_t i = 0; i < values_of(tangent); i++) slope[i] += weight * scratch->force[i];
  if (tangent->damping) TRY(fem_damping_pull(tangent->damping, scratch->w, -weight));
  if (tangent->yielding) fem_yielding_pull(tangent->yielding, scratch->w, -weight);
  TRY(fem_tangent_pull_contact(tangent, CONTACT_ALL_INTERFACES, scratch->w, -weight));
  if (!tangent->friction) return STATUS_OK;
  return fem_friction_pull(tangent->friction, CONTACT_ALL_INTERFACES, scratch->w, -weight);
}

static Status evaluate_reaction(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                                double *value, double *slope) {
  FemSystem *system = tangent->system;
  Scratch scratch;
  Status status = create_scratch(&scratch, tangent);
  if (!status) status = fem_system_forces(system, tangent->state);
  if (!status) {
    mark_held(quantity, tangent, scratch.w);
    *value = -dot(tangent, scratch.w, system->forces);
    if (slope) status = resist(tangent, weight, &scratch, slope);
  }
  destroy_scratch(&scratch);
  return status;
}

static Status change_reaction(const FemQuantity *quantity, const FemTangent *tangent, FemChange *change,
                              double *derivative) {
  mark_held(quantity, tangent, change->product);
  *derivative -= dot(tangent, change->product, change->force);
  return STATUS_OK;
}

// ---- Energies, whose derivative by positions is the opposite of a force.

static Status evaluate_effect(const FemTangent *tangent, const FemEffectOps *ops, FemEnergy *energy,
                              double *force) {
  void *self = fem_system_effect(tangent->system, ops);
  if (!self) return STATUS_OK;
  TRY(ops->add_energy(self, tangent->state, energy));
  return ops->add_force(self, tangent->state, force);
}

static Status evaluate_energies(const FemQuantity *quantity, const FemTangent *tangent, FemEnergy *energy,
                                double *force) {
  if (quantity->energies & FEM_QUANTITY_ELASTIC) {
    void *plasticity = fem_system_effect(tangent->system, &fem_effect_plasticity);
    TRY(evaluate_effect(tangent, &fem_effect_elasticity, energy, force));
    TRY(evaluate_effect(tangent, &fem_effect_volume, energy, force));
    // Its derivative by positions is no force (fem_yielding_pull_energy).
    if (plasticity) TRY(fem_effect_plasticity.add_energy(plasticity, tangent->state, energy));
  }
  if (quantity->energies & FEM_QUANTITY_GRAVITY)
    TRY(evaluate_effect(tangent, &fem_effect_gravity, energy, force));
  if (quantity->energies & FEM_QUANTITY_CONTACT)
    TRY(evaluate_effect(tangent, &fem_effect_contact, energy, force));
  return STATUS_OK;
}

// Obstacles move by parameters, not by positions (fem_change_field).
static Status evaluate_energy(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                              double *value, double *slope) {
  const FemModel *model = tangent->system->model;
  double *force = memory_zeroed(values_of(tangent), sizeof *force);
  FemEnergy energy = {0};
  Status status = force ? STATUS_OK : status_no_memory("a quantity");
  if (!status) status = evaluate_energies(quantity, tangent, &energy, force);
  *value = energy.elastic + energy.contact + energy.gravity;
  size_t of_bodies = 3 * (size_t)model->bodies[model->scene->body_count - 1].vertex_end;
  for (size_t i = 0; slope && !status && i < of_bodies; i++) slope[i] -= weight * force[i];
  if (slope && !status && tangent->yielding && quantity->energies & FEM_QUANTITY_ELASTIC)
    fem_yielding_pull_energy(tangent->yielding, weight);
  memory_free(force);
  return status;
}

static Status change_contact_energy(const FemTangent *tangent, FemChange *change, double *derivative) {
  for (int i = 0; i < tangent->interface_count; i++) {
    double energy;
    TRY(fem_tangent_contact_energy(tangent, i, &energy));
    *derivative += change->rates[i] * energy;
    if (change->shape.energies) *derivative += change->shape.energies[i];
    if (!fem_change_moves(change, tangent, i)) continue;
    memset(change->contact, 0, values_of(tangent) * sizeof(double));
    TRY(fem_tangent_add_contact(tangent, i, change->contact));
    fem_change_field(change, tangent, i, change->product);
    *derivative += dot(tangent, change->product, change->contact);
  }
  return STATUS_OK;
}

static Status change_energy(const FemQuantity *quantity, const FemTangent *tangent, FemChange *change,
                            double *derivative) {
  if (quantity->energies & FEM_QUANTITY_ELASTIC) *derivative += change->elastic;
  if (quantity->energies & FEM_QUANTITY_GRAVITY) *derivative += change->gravity;
  if (quantity->energies & FEM_QUANTITY_CONTACT) return change_contact_energy(tangent, change, derivative);
  return STATUS_OK;
}

// ---- All of them.

// q and, unless `slope` is NULL, its derivative by all positions, times `weight` and added.
static Status evaluate_quantity(const FemQuantity *quantity, const FemTangent *tangent, double weight,
                                double *value, double *slope) {
  switch (quantity->kind) {
  case FEM_QUANTITY_FORCE:
  case FEM_QUANTITY_PATCH:
  case FEM_QUANTITY_MOMENT:
    return evaluate_contact(quantity, tangent, weight, value, slope);
  case FEM_QUANTITY_PRESSURE:
    return evaluate_pressure(quantity, tangent, weight, value, slope);
  case FEM_QUANTITY_REACTION:
    return evaluate_reaction(quantity, tangent, weight, value, slope);
  case FEM_QUANTITY_ENERGY:
    return evaluate_energy(quantity, tangent, weight, value, slope);
  case FEM_QUANTITY_DISPLACEMENT:
  case FEM_QUANTITY_PROBE:
  case FEM_QUANTITY_POSITION:
    evaluate_place(quantity, tangent, weight, value, slope);
    break;
  }
  return STATUS_OK;
}

// Its derivative by a parameter at fixed positions.
static Status change_quantity(const FemQuantity *quantity, const FemTangent *tangent, FemChange *change,
                              double *derivative) {
  *derivative = 0;
  switch (quantity->kind) {
  case FEM_QUANTITY_FORCE:
  case FEM_QUANTITY_PATCH:
  case FEM_QUANTITY_MOMENT:
    return change_contact(quantity, tangent, change, derivative);
  case FEM_QUANTITY_PRESSURE:
    return change_pressure(quantity, tangent, change, derivative);
  case FEM_QUANTITY_REACTION:
    return change_reaction(quantity, tangent, change, derivative);
  case FEM_QUANTITY_ENERGY:
    return change_energy(quantity, tangent, change, derivative);
  case FEM_QUANTITY_DISPLACEMENT:
  case FEM_QUANTITY_PROBE:
  case FEM_QUANTITY_POSITION:
    *derivative = change_place(quantity, tangent, change);
    break;
  }
  return STATUS_OK;
}

bool fem_term_is_due(const FemTerm *term, const FemModel *model, double time) {
  double end = model->scene->end;
  return fabs(fmin(term->time, end) - time) <= FEM_TIME_RESOLUTION * end;
}

bool fem_goal_is_due(const FemGoal *goal, const FemModel *model, double time) {
  for (int t = 0; t < goal->term_count; t++)
    if (fem_term_is_due(&goal->terms[t], model, time)) return true;
  return false;
}

Status fem_goal_evaluate(const FemGoal *goal, const FemTangent *tangent, double *value, double *slope,
                         double *factors) {
  for (int t = 0; t < goal->term_count; t++) {
    const FemTerm *term = &goal->terms[t];
    double q;
    if (!fem_term_is_due(term, tangent->system->model, tangent->state->time)) continue;
    factors[t] = term->weight;
    if (goal->is_misfit) {
      TRY(evaluate_quantity(&term->quantity, tangent, 0, &q, NULL));
      factors[t] *= q - term->data;
    }
    TRY(evaluate_quantity(&term->quantity, tangent, factors[t], &q, slope));
    *value += goal->is_misfit ? 0.5 * factors[t] * (q - term->data) : factors[t] * q;
  }
  return STATUS_OK;
}

Status fem_goal_change(const FemGoal *goal, const FemTangent *tangent, const double *factors,
                       FemChange *change, double *derivative) {
  *derivative = 0;
  for (int t = 0; t < goal->term_count; t++) {
    double own;
    if (!fem_term_is_due(&goal->terms[t], tangent->system->model, tangent->state->time)) continue;
    TRY(change_quantity(&goal->terms[t].quantity, tangent, change, &own));
    *derivative += factors[t] * own;
  }
  return STATUS_OK;
}
