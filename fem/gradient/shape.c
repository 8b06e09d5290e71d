// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/shape.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/contact/contact.h"
#include "fem/effect/contact/stick.h"
#include "fem/gradient/difference.h"
#include "fem/mesh/mesh.h"
#include "fem/model/build.h"

// The largest strain of an edge between two points of a difference. What the sixth order omits is below
// (3e-3)⁶, rounding 1e-16/1e-3. Contact: 1e-6², and 1e-16/1e-6; its kinks are sought that near to the shape.
static const double STRAIN = 1e-3, STRAIN_OF_CONTACT = 1e-6;
// A kink by which a force changes by less than this share of it, for a strain of 1, is not told from rounding
// and curvature.
static const double LEAST_KINK = 1e-4;

// ---- Where vertices rest.

static Vec3 rate_of(const FemPlacement *placement, const FemParameter *parameter, Vec3 X) {
  Vec3 arm = vec3_sub(X, vec3_at(placement->translate)), axis = vec3_at(placement->axis);
  double axes[3][3], unit[3] = {0, 0, 0};
  if (parameter->kind == FEM_PARAMETER_PLACE) {
    unit[parameter->component] = 1;
    return vec3_at(unit);
  }
  if (parameter->kind == FEM_PARAMETER_ROTATE)
    return vec3_scale(M_PI / 180 / vec3_length(axis), vec3_cross(axis, arm));
  if (parameter->component < 0) return vec3_scale(1 / placement->scale[0], arm);
  fem_mesh_placement_axes(placement, axes);
  Vec3 along = vec3_at(axes[parameter->component]);
  return vec3_scale(vec3_dot(along, arm) / placement->scale[parameter->component], along);
}

void fem_shape_rest(const FemModel *model, const FemParameter *parameter, double *rests) {
  memset(rests, 0, 3 * (size_t)model->vertex_count * sizeof *rests);
  if (!fem_parameter_moves_rest(parameter)) return;
  const FemModelBody *body = &model->bodies[parameter->body];
  const FemPlacement *placement = &model->scene->bodies[parameter->body].placement;
  if (parameter->kind == FEM_PARAMETER_REST) {
    rests[3 * (size_t)(body->vertex_begin + parameter->row) + (size_t)parameter->component] = 1;
    return;
  }
  for (size_t a = (size_t)body->vertex_begin; a < (size_t)body->vertex_end; a++)
    vec3_store(rests + 3 * a, rate_of(placement, parameter, vec3_at(model->rest + 3 * a)));
}

// The largest strain of an edge with p.
static double strain_of(const FemModel *model, const double *rests) {
  double most = 0;
  for (int e = 0; e < model->tet_count; e++)
    for (int v = 0; v < 4; v++)
      for (int w = 0; w < v; w++) {
        size_t a = 3 * (size_t)model->tets[e][v], b = 3 * (size_t)model->tets[e][w];
        Vec3 edge = vec3_sub(vec3_at(model->rest + a), vec3_at(model->rest + b));
        Vec3 way = vec3_sub(vec3_at(rests + a), vec3_at(rests + b));
        most = fmax(most, vec3_length(way) / vec3_length(edge));
      }
  return most;
}

// ---- The model of another shape.

static void measure(FemModel *model) {
  memset(model->mass, 0, (size_t)model->vertex_count * sizeof *model->mass);
  for (int e = 0; e < model->tet_count; e++) model->volumes[e] = fem_model_element(model, e).volume;
  for (int e = 0; e < model->quadratic_count; e++) {
    double nodes[3 * FEM_QUADRATIC_NODES];
    const int *from = model->quadratic_nodes[e];
    for (int k = 0; k < FEM_QUADRATIC_NODES; k++)
      memcpy(nodes + 3 * k, model->rest + 3 * (size_t)from[k], 3 * sizeof *nodes);
    fem_quadratic_create_curved(&model->quadratics[e], nodes);
  }
  for (int b = 0; b < model->scene->body_count; b++) fem_model_lump(model, &model->bodies[b]);
}

// A body's tetrahedra by its own vertices; `tets` and `nodes` have room for all of the model.
static FemMesh mesh_of(const FemModel *model, const FemModelBody *body, int (*tets)[4], int (*nodes)[10]) {
  int count = body->tet_end - body->tet_begin, quadratics = body->quadratic_end - body->quadratic_begin;
  for (int e = 0; e < count; e++)
    for (int k = 0; k < 4; k++) tets[e][k] = model->tets[body->tet_begin + e][k] - body->vertex_begin;
  for (int e = 0; e < quadratics; e++)
    for (int k = 0; k < 10; k++)
      nodes[e][k] = model->quadratic_nodes[body->quadratic_begin + e][k] - body->vertex_begin;
  return (FemMesh){.vertex_count = body->vertex_end - body->vertex_begin,
                   .tet_count = count,
                   .rest = model->rest + 3 * (size_t)body->vertex_begin,
                   .tets = tets,
                   .quadratic = quadratics > 0 ? nodes : NULL,
                   .quadratic_count = quadratics};
}

static const FemModelBody *body_of(const FemModel *model, const FemLoad *load) {
  const FemModelBody *body = model->bodies;
  while (load->vertices[0] >= body->vertex_end) body++;
  return body;
}

static Status share_loads(FemModel *model, const FemModel *of) {
  int(*tets)[4] = memory_zeroed((size_t)model->tet_count, sizeof *tets);
  int(*nodes)[10] = memory_zeroed((size_t)model->quadratic_count, sizeof *nodes);
  Status status = tets && nodes ? STATUS_OK : status_no_memory("loads of another shape");
  for (model->load_count = 0; model->load_count < of->load_count && !status; model->load_count++) {
    const FemLoad *load = &of->loads[model->load_count];
    bool follows = load->triangle_count + load->face_count > 0;
    model->loads[model->load_count].def = load->def;
    if (follows || load->def->kind == FEM_LOAD_EXTERNAL) continue; // at fixed positions they do not change
    const FemModelBody *body = body_of(model, load);
    FemMesh mesh = mesh_of(model, body, tets, nodes);
    status = fem_load_create_like(&model->loads[model->load_count], load, &mesh, body->vertex_begin);
    if (status) break;
  }
  memory_free(nodes);
  memory_free(tets);
  return status;
}

static void destroy_model(FemModel *model) {
  for (int l = 0; l < model->load_count && model->loads; l++) fem_load_destroy(&model->loads[l]);
  memory_free(model->loads);
  memory_free(model->rest);
  memory_free(model->mass);
  memory_free(model->volumes);
  memory_free(model->quadratics);
}

// Borrows all that does not depend on shape.
static Status create_model(FemModel *model, const FemModel *of, const double *rests, double step) {
  size_t vertices = (size_t)of->vertex_count;
  *model = *of;
  model->load_count = 0;
  model->rest = memory_copy(of->rest, 3 * vertices, sizeof *of->rest);
  model->mass = memory_zeroed(vertices, sizeof *of->mass);
  model->volumes = memory_zeroed((size_t)of->tet_count, sizeof *of->volumes);
  model->quadratics = memory_copy(of->quadratics, (size_t)of->quadratic_count, sizeof *of->quadratics);
  model->loads = memory_zeroed((size_t)of->load_count, sizeof *of->loads);
  if (!model->rest || !model->mass || !model->volumes || !model->quadratics || !model->loads)
    return status_no_memory("another shape");
  for (size_t i = 0; i < 3 * vertices; i++) model->rest[i] += step * rests[i];
  measure(model);
  return share_loads(model, of);
}

// ---- What acts at fixed positions, as a sum of weighted shapes.

static Status add_effect(const FemModel *model, const FemEffectOps *ops, const FemState *state, double *force,
                         FemEnergy *energy) {
  void *self = NULL;
  if (!ops->is_wanted(model->scene)) return STATUS_OK;
  TRY(ops->create(&self, model));
  Status status = ops->add_force(self, state, force);
  if (!status && energy) status = ops->add_energy(self, state, energy);
  ops->destroy(self);
  return status;
}

// Of elements, weight, loads and damping.
static Status add_bulk(FemShape *shape, const FemModel *model, const FemState *state, double weight,
                       double *scratch) {
  size_t count = 3 * (size_t)model->vertex_count;
  FemEnergy energy = {0};
  memset(scratch, 0, count * sizeof *scratch);
  TRY(add_effect(model, &fem_effect_elasticity, state, scratch, &energy));
  TRY(add_effect(model, &fem_effect_volume, state, scratch, &energy));
  TRY(add_effect(model, &fem_effect_gravity, state, scratch, &energy));
  TRY(add_effect(model, &fem_effect_loads, state, scratch, NULL));
  TRY(add_effect(model, &fem_effect_damping, state, scratch, NULL));
  for (size_t i = 0; i < count; i++) shape->force[i] += weight * scratch[i];
  for (size_t a = 0; a < count / 3; a++) shape->masses[a] += weight * model->mass[a];
  shape->elastic += weight * energy.elastic;
  shape->gravity += weight * energy.gravity;
  return STATUS_OK;
}

// Sums of contact's forces of all interfaces.
static Status sum_contact(const FemTangent *tangent, void *effect, double *forces, double *energies) {
  const FemState *state = tangent->state;
  ContactSystem *system = fem_effect_contact_system(effect);
  const ContactEvaluation *evaluation;
  size_t values = 3 * (size_t)tangent->system->model->vertex_count;
  TRY(contact_system_update(system, state->time, state->positions, state->velocities, 0));
  TRY(contact_evaluate(system, 0, state->time, state->positions, &evaluation));
  for (int i = 0; i < tangent->interface_count; i++) {
    double *force = forces + values * (size_t)i;
    memset(force, 0, values * sizeof *force);
    contact_system_add_force_of(system, evaluation, i, force);
    energies[i] = contact_system_energy_of(evaluation, i);
  }
  return STATUS_OK;
}

// One side of a difference: what acts between bodies of another shape.
typedef struct Side {
  double *forces;   // of each interface, with friction                (interface_count, 3 vertex_count)
  double *pressing; // the same without friction
  double *energies; // (interface_count)
  FemEffectHistory history; // that friction leaves
} Side;

static void destroy_side(Side *side) {
  memory_free(side->forces);
  memory_free(side->pressing);
  memory_free(side->energies);
  fem_effect_history_destroy(&side->history);
}

static Status create_side(Side *side, const FemTangent *tangent) {
  size_t count = (size_t)tangent->interface_count,
         values = 3 * (size_t)tangent->system->model->vertex_count * count;
  side->forces = memory_zeroed(values, sizeof *side->forces);
  side->pressing = memory_zeroed(values, sizeof *side->pressing);
  side->energies = memory_zeroed(count, sizeof *side->energies);
  bool fits = side->forces && side->pressing && side->energies;
  return fits ? STATUS_OK : status_no_memory("contact of another shape");
}

// Friction of bodies of another shape that remember the same.
static Status rub(const FemTangent *tangent, void *stick, Side *side) {
  const FemState *state = tangent->state;
  size_t values = 3 * (size_t)tangent->system->model->vertex_count;
  const ContactStick *law;
  TRY(fem_effect_stick_evaluate(stick, state, &law));
  for (int i = 0; i < tangent->interface_count; i++)
    contact_stick_add_force_of(law, i, side->forces + values * (size_t)i);
  return fem_effect_stick.advance(stick, state, &side->history);
}

// Friction on that contact.
static Status rub_between(const FemTangent *tangent, const FemModel *model, void *contact, Side *side) {
  void *stick;
  TRY(fem_effect_stick_create_like(&stick, model, contact, tangent->stick));
  Status status = rub(tangent, stick, side);
  fem_effect_stick.destroy(stick);
  return status;
}

static Status evaluate_between(const FemTangent *tangent, const FemModel *model, Side *side) {
  void *contact = NULL;
  TRY(fem_effect_contact_create_like(&contact, model,
                                     fem_system_effect(tangent->system, &fem_effect_contact)));
  Status status = sum_contact(tangent, contact, side->pressing, side->energies);
  size_t all = 3 * (size_t)model->vertex_count * (size_t)tangent->interface_count;
  memcpy(side->forces, side->pressing, all * sizeof *side->forces);
  if (!status && tangent->stick) status = rub_between(tangent, model, contact, side);
  fem_effect_contact.destroy(contact);
  return status;
}

static Status evaluate_contact(const FemTangent *tangent, const double *rests, double step, Side *side) {
  FemModel model;
  Status status = create_side(side, tangent);
  if (status) return status;
  status = create_model(&model, tangent->system->model, rests, step);
  if (!status) status = evaluate_between(tangent, &model, side);
  destroy_model(&model);
  return status;
}

// Without a difference: what acts there.
static Status evaluate_there(const FemTangent *tangent, Side *side) {
  size_t values = 3 * (size_t)tangent->system->model->vertex_count;
  TRY(create_side(side, tangent));
  for (int i = 0; i < tangent->interface_count; i++)
    TRY(fem_tangent_add_contact(tangent, i, side->pressing + values * (size_t)i));
  return tangent->stick ? fem_effect_stick.advance(tangent->stick, tangent->state, &side->history)
                        : STATUS_OK;
}

// By how much rounding changes the second difference of an interface's forces [N]. A pair that is D = V/A
// deep changes by F/D for each metre. A point of a cell is a sum over 4 vertices, whose weights and products
// are rounded by ε/2 each; the difference has it twice.
static double rounding_of(const ContactEvaluation *evaluation, int interface, double largest_coordinate) {
  double slope = 0;
  for (int k = 0; k < evaluation->pair_count; k++) {
    const ContactFieldPair *field = &evaluation->fields[k];
    if (evaluation->pairs[k].interface == interface && field->volume > 0)
      slope += vec3_length(vec3_at(field->force)) * contact_field_area(field) / field->volume;
  }
  return 2 * 4 * DBL_EPSILON * largest_coordinate * slope;
}

static double largest_coordinate_of(const FemTangent *tangent, const FemModelBody *body) {
  double largest = 0;
  for (int i = 3 * body->vertex_begin; i < 3 * body->vertex_end; i++)
    largest = fmax(largest, fabs(tangent->state->positions[i]));
  return largest;
}

// `sides`: behind, there, ahead, of another shape of that body.
static Status judge_kinks(const FemTangent *tangent, const FemModelBody *body,
                          const ContactEvaluation *evaluation, const Side sides[3], size_t values) {
  const double *behind = sides[0].pressing, *there = sides[1].pressing, *ahead = sides[2].pressing;
  double coordinate = largest_coordinate_of(tangent, body);
  for (int i = 0; i < tangent->interface_count; i++) {
    double largest = 0, kink = 0;
    for (size_t k = values * (size_t)i; k < values * (size_t)(i + 1); k++) {
      largest = fmax(largest, fabs(there[k]));
      kink = fmax(kink, fabs(behind[k] - 2 * there[k] + ahead[k]) / 2);
    }
    double least = fmax(LEAST_KINK * STRAIN_OF_CONTACT * largest, rounding_of(evaluation, i, coordinate));
    if (!(kink <= least))
      return status_fail(
          STATUS_INPUT,
          "contact of '%s' has no derivative by this shape: a vertex inside is equally far from two faces of "
          "the surface. Take a mesh where it is not, or scale all axes together (place.scale)",
          body->name);
  }
  return STATUS_OK;
}

// √(2E) S/|S|
static Vec3 stretch_of(const ContactStickEntry *entry) {
  Vec3 stretch = vec3_at(entry->stretch);
  double length = vec3_length(stretch);
  return length > 0 ? vec3_scale(sqrt(2 * entry->energy) / length, stretch) : (Vec3){0, 0, 0};
}

// The entries are the same on both sides, but for vertices that are just about to touch or to leave.
static Status derive_history(FemShape *shape, const FemTangent *tangent, const Side sides[3], double step) {
  const ContactStickHistory there = fem_effect_stick_history(tangent->stick, &sides[1].history);
  shape->entry_count = there.entry_count;
  shape->stretches = memory_zeroed((size_t)there.entry_count, sizeof *shape->stretches);
  if (!shape->stretches) return status_no_memory("friction of another shape");
  for (int side = 0; side < 3; side += 2) {
    const ContactStickHistory history = fem_effect_stick_history(tangent->stick, &sides[side].history);
    for (int e = 0; e < there.entry_count; e++) {
      const ContactStickEntry *own = &there.entries[e],
                              *entry =
                                  contact_stick_history_find(&history, (int)own->interface, (int)own->vertex);
      Vec3 change = vec3_sub(entry ? stretch_of(entry) : (Vec3){0, 0, 0}, stretch_of(own));
      vec3_accumulate(shape->stretches[e], vec3_scale((side - 1) / (2 * step), change));
    }
  }
  return STATUS_OK;
}

// Bodies that are apart do not press, wherever they rest.
static Status derive_contact(FemShape *shape, const FemTangent *tangent, const FemModelBody *body,
                             const double *rests, double strain) {
  const ContactEvaluation *evaluation;
  TRY(fem_effect_contact_evaluate(tangent->system, tangent->state, &evaluation));
  if (evaluation->pair_count == 0) return STATUS_OK;
  size_t values = 3 * (size_t)tangent->system->model->vertex_count, count = (size_t)tangent->interface_count;
  double step = STRAIN_OF_CONTACT / strain;
  Side sides[3] = {{0}};
  shape->contact = memory_zeroed(values * count, sizeof *shape->contact);
  shape->energies = memory_zeroed(count, sizeof *shape->energies);
  bool fits = shape->contact && shape->energies;
  Status status = fits ? STATUS_OK : status_no_memory("contact of another shape");
  if (!status) status = evaluate_there(tangent, &sides[1]);
  for (int k = 0; k < 3 && !status; k += 2)
    status = evaluate_contact(tangent, rests, (k - 1) * step, &sides[k]);
  if (!status) status = judge_kinks(tangent, body, evaluation, sides, values);
  for (size_t i = 0; i < values * count && !status; i++)
    shape->contact[i] = (sides[2].forces[i] - sides[0].forces[i]) / (2 * step);
  for (size_t i = 0; i < count && !status; i++)
    shape->energies[i] = (sides[2].energies[i] - sides[0].energies[i]) / (2 * step);
  if (!status && tangent->stick) status = derive_history(shape, tangent, sides, step);
  for (int k = 0; k < 3; k++) destroy_side(&sides[k]);
  return status;
}

static Status derive_bulk(FemShape *shape, const FemTangent *tangent, const double *rests, double strain) {
  size_t values = 3 * (size_t)tangent->system->model->vertex_count;
  double step = STRAIN / strain;
  double *scratch = memory_zeroed(values, sizeof *scratch);
  shape->force = memory_zeroed(values, sizeof *shape->force);
  shape->masses = memory_zeroed(values / 3, sizeof *shape->masses);
  bool fits = scratch && shape->force && shape->masses;
  Status status = fits ? STATUS_OK : status_no_memory("forces of another shape");
  for (int k = 0; k < FEM_DIFFERENCE_POINTS && !status; k++) {
    FemModel model;
    status = create_model(&model, tangent->system->model, rests, fem_difference[k].place * step);
    if (!status) status = add_bulk(shape, &model, tangent->state, fem_difference[k].weight / step, scratch);
    destroy_model(&model);
  }
  memory_free(scratch);
  return status;
}

Status fem_shape_derive(FemShape *shape, const FemTangent *tangent, int body, const double *rests) {
  const FemModel *model = tangent->system->model;
  double strain = strain_of(model, rests);
  TRY(derive_bulk(shape, tangent, rests, strain));
  return tangent->contact ? derive_contact(shape, tangent, &model->bodies[body], rests, strain) : STATUS_OK;
}

Status fem_shape_add_masses(const FemModel *model, const double *rests, double *masses) {
  Status status = STATUS_OK;
  double step = STRAIN / strain_of(model, rests);
  for (int k = 0; k < FEM_DIFFERENCE_POINTS && !status; k++) {
    FemModel other;
    status = create_model(&other, model, rests, fem_difference[k].place * step);
    for (int a = 0; a < model->vertex_count && !status; a++)
      masses[a] += fem_difference[k].weight / step * other.mass[a];
    destroy_model(&other);
  }
  return status;
}

void fem_shape_destroy(FemShape *shape) {
  memory_free(shape->force);
  memory_free(shape->masses);
  memory_free(shape->contact);
  memory_free(shape->energies);
  memory_free(shape->stretches);
  *shape = (FemShape){0};
}
