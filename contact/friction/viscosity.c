// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/viscosity.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/shape/shape.h"

Status contact_viscosity_create(ContactViscosity *viscosity, ContactSystem *system, double coefficient) {
  *viscosity = (ContactViscosity){.system = system, .viscosity = coefficient};
  if (!(coefficient > 0 && isfinite(coefficient)))
    return status_fail(STATUS_INPUT, "contact: the viscosity is %g Pa s; it must be positive", coefficient);
  return STATUS_OK;
}

void contact_viscosity_destroy(ContactViscosity *viscosity) {
  memory_free(viscosity->rates);
  *viscosity = (ContactViscosity){0};
}

size_t contact_viscosity_bytes(const ContactViscosity *viscosity) {
  return memory_held(viscosity->rates);
}

// What all of this looks at.
typedef struct View {
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const ContactPatches *patches;
  const double *velocities;
} View;

// dV/dt of pair k. A shape that moves by v(x) changes V as vertices that moved by −v would.
static double rate_of_pair(const View *view, int k) {
  double rate = 0;
  const ContactPair *pair = &view->evaluation->pairs[k];
  int s = view->layout->interfaces[pair->interface].shape;
  for (int side = 0; side < 2 && pair->cells[side] >= 0; side++)
    for (int v = 0; v < 4; v++) {
      size_t vertex = (size_t)contact_layout_vertices(view->layout, pair->cells[side])[v];
      Vec3 velocity = vec3_at(view->velocities + 3 * vertex);
      if (s >= 0)
        velocity =
            vec3_sub(velocity, contact_shape_velocity(&view->layout->def.shapes[s], view->evaluation->time,
                                                      vec3_at(view->evaluation->positions + 3 * vertex)));
      rate += vec3_dot(vec3_at(view->evaluation->gradients + 24 * (size_t)k + 12 * side + 3 * v), velocity);
    }
  return rate;
}

// Ẇ_a of all nodes into viscosity->rates.
static Status measure(ContactViscosity *viscosity, const double *velocities, View *view) {
  *view = (View){.layout = contact_system_layout(viscosity->system), .velocities = velocities};
  TRY(contact_system_look(viscosity->system, &view->evaluation));
  view->patches = &view->evaluation->patches;
  if (!memory_reserve((void **)&viscosity->rates, &viscosity->rate_capacity,
                      (size_t)view->patches->node_count, sizeof(double)))
    return status_no_memory("contact viscosity");
  for (int n = 0; n < view->patches->node_count; n++) viscosity->rates[n] = 0;
  for (int k = 0; k < view->evaluation->pair_count; k++) {
    double rate = rate_of_pair(view, k);
    for (int side = 0; side < 2; side++) {
      int e = view->patches->pair_elements[k][side];
      for (int v = 0; e >= 0 && v < 4; v++) viscosity->rates[view->patches->elements[e].nodes[v]] += rate / 4;
    }
  }
  return STATUS_OK;
}

// −∂f/∂v is Σ of these times ∇W_a ∇W_aᵀ.
static double resistance(const ContactViscosity *viscosity, const View *view, const ContactPatch *patch,
                         const ContactNode *node) {
  double volume = view->layout->vertex_volumes[node->vertex];
  double weight = view->layout->interfaces[patch->interface].weight[node->side];
  return weight * viscosity->viscosity * node->covered / (volume * volume);
}

// Turns the rates into what each vertex adds to the pressures, q_a with its weight.
static void press(ContactViscosity *viscosity, const View *view) {
  for (int p = 0; p < view->patches->patch_count; p++) {
    const ContactPatch *patch = &view->patches->patches[p];
    for (int n = patch->node_begin; n < patch->node_end; n++)
      viscosity->rates[n] *= resistance(viscosity, view, patch, &view->patches->nodes[n]);
  }
}

static double pressure_of_pair(const ContactViscosity *viscosity, const View *view, int k) {
  double pressure = 0;
  for (int side = 0; side < 2; side++) {
    int e = view->patches->pair_elements[k][side];
    for (int v = 0; e >= 0 && v < 4; v++)
      pressure += viscosity->rates[view->patches->elements[e].nodes[v]] / 4;
  }
  return pressure;
}

// ---- With the potential `field`: pair by pair.

// One of a pair's two terms: points of one side in the field of the other.
typedef struct Term {
  int interface;
  int count;                // of vertices: 8, with a shape 4
  int free_begin, free_end; // of those on sides that carry unknowns
  int vertices[8];
  double along[24];  // of x ↦ g · (u_A − u_B): λ g, −λ g                  (count, 3)
  double resistance; // η s V
  double rate;       // g · w: how fast they go deeper [m/s]
  double obstacle;   // g · the shape's velocity
} Term;

// Term `t`: the points of side t. False: a shape has none.
static bool term_of(const ContactViscosity *viscosity, const View *view, int k, int t, Term *term) {
  const ContactFieldPair *field = &view->evaluation->fields[k];
  const ContactPair *pair = &view->evaluation->pairs[k];
  int s = view->layout->interfaces[pair->interface].shape;
  if (s >= 0 && t == 1) return false;
  double sign = t == 0 ? 1 : -1; // the points of A go deeper by g_B · w, those of B by −g_A · w
  Vec3 g = vec3_at(field->slopes[1 - t]);
  const double *weight_of = view->layout->interfaces[pair->interface].weight;
  *term = (Term){.interface = pair->interface,
                 .count = s >= 0 ? 4 : 8,
                 .free_begin = weight_of[0] > 0 ? 0 : 4,
                 .free_end = weight_of[1] > 0 ? 8 : 4,
                 .resistance = viscosity->viscosity * field->weighed[t]};
  for (int v = 0; v < term->count; v++) {
    int side = v / 4;
    term->vertices[v] = contact_layout_vertices(view->layout, pair->cells[side])[v % 4];
    double weight = (side == 0 ? sign : -sign) * field->weights[side][v % 4];
    vec3_store(term->along + 3 * v, vec3_scale(weight, g));
    term->rate +=
        vec3_dot(vec3_at(term->along + 3 * v), vec3_at(view->velocities + 3 * (size_t)term->vertices[v]));
  }
  if (s < 0) return true;
  term->obstacle = vec3_dot(g, contact_shape_velocity(&view->layout->def.shapes[s], view->evaluation->time,
                                                      vec3_at(field->centroid)));
  term->rate -= term->obstacle;
  return true;
}

typedef void (*TakeTerm)(void *self, const Term *term);

static Status walk_terms(ContactViscosity *viscosity, const double *velocities, void *self, TakeTerm take) {
  View view = {.layout = contact_system_layout(viscosity->system),
               .velocities = contact_system_spread(viscosity->system, velocities)};
  TRY(contact_system_look(viscosity->system, &view.evaluation));
  for (int k = 0; k < view.evaluation->pair_count; k++)
    for (int t = 0; t < 2; t++) {
      Term term;
      if (term_of(viscosity, &view, k, t, &term)) take(self, &term);
    }
  return STATUS_OK;
}

typedef struct ForceSink {
  const ContactStars *stars;
  double *force;
} ForceSink;

static void push_term(void *self, const Term *term) {
  const ForceSink *to = self;
  for (int v = 0; v < term->count; v++)
    contact_stars_push(to->stars, term->vertices[v],
                       vec3_scale(-term->resistance * term->rate, vec3_at(term->along + 3 * v)), to->force);
}

static void sum_term(void *self, const Term *term) {
  double(*resultants)[3] = self;
  for (int v = 0; v < 4; v++)
    vec3_accumulate(resultants[term->interface],
                    vec3_scale(-term->resistance * term->rate, vec3_at(term->along + 3 * v)));
}

typedef struct TermSink {
  const ContactStiffnessSink *sink;
  double damping_scale;
} TermSink;

static void bend_term(void *self, const Term *term) {
  const TermSink *to = self;
  to->sink->add_outer(to->sink->self, term->free_end - term->free_begin, term->vertices + term->free_begin,
                      term->along + 3 * term->free_begin, to->damping_scale * term->resistance);
}

static void measure_term(void *self, const Term *term) {
  ContactViscosityPower *power = self;
  power->dissipated += term->resistance * term->rate * term->rate;
  power->driven -= term->resistance * term->rate * term->obstacle;
}

static bool has_field(const ContactViscosity *viscosity) {
  return contact_system_layout(viscosity->system)->mesh.has_field;
}

// ---- What both potentials answer.

Status contact_viscosity_add_force(ContactViscosity *viscosity, const double *velocities, double *force) {
  if (has_field(viscosity))
    return walk_terms(viscosity, velocities, &(ForceSink){contact_system_stars(viscosity->system), force},
                      push_term);
  View view;
  TRY(measure(viscosity, velocities, &view));
  press(viscosity, &view);
  for (int k = 0; k < view.evaluation->pair_count; k++) {
    double pressure = pressure_of_pair(viscosity, &view, k);
    const ContactPair *pair = &view.evaluation->pairs[k];
    for (int side = 0; side < 2 && pair->cells[side] >= 0; side++)
      for (int v = 0; v < 4; v++)
        vec3_accumulate(force + 3 * (size_t)contact_layout_vertices(view.layout, pair->cells[side])[v],
                        vec3_scale(-pressure, vec3_at(view.evaluation->gradients + 24 * (size_t)k +
                                                      (size_t)(12 * side + 3 * v))));
  }
  return STATUS_OK;
}

Status contact_viscosity_add_resultants(ContactViscosity *viscosity, const double *velocities,
                                        double (*resultants)[3]) {
  if (has_field(viscosity)) return walk_terms(viscosity, velocities, resultants, sum_term);
  View view;
  TRY(measure(viscosity, velocities, &view));
  press(viscosity, &view);
  for (int k = 0; k < view.evaluation->pair_count; k++) {
    double pressure = pressure_of_pair(viscosity, &view, k);
    for (int v = 0; v < 4; v++)
      vec3_accumulate(resultants[view.evaluation->pairs[k].interface],
                      vec3_scale(-pressure, vec3_at(view.evaluation->gradients + 24 * (size_t)k + 3 * v)));
  }
  return STATUS_OK;
}

Status contact_viscosity_add_jacobian(ContactViscosity *viscosity, const double *velocities,
                                      double stiffness_scale, double damping_scale,
                                      const ContactStiffnessSink *sink) {
  if (has_field(viscosity))
    return walk_terms(viscosity, velocities,
                      &(TermSink){contact_system_sink(viscosity->system, sink), damping_scale}, bend_term);
  View view;
  TRY(measure(viscosity, velocities, &view));
  for (int p = 0; p < view.patches->patch_count; p++) {
    const ContactPatch *patch = &view.patches->patches[p];
    for (int n = patch->node_begin; n < patch->node_end; n++) {
      const ContactNode *node = &view.patches->nodes[n];
      double by_velocity = resistance(viscosity, &view, patch, node);
      double by_position = node->covered > 0 ? by_velocity * fmax(viscosity->rates[n], 0) / node->covered : 0;
      viscosity->rates[n] = damping_scale * by_velocity + stiffness_scale * by_position;
    }
  }
  return contact_system_add_nodes(viscosity->system, viscosity->rates, sink);
}

Status contact_viscosity_power(ContactViscosity *viscosity, const double *velocities,
                               ContactViscosityPower *power) {
  View view;
  *power = (ContactViscosityPower){0, 0};
  if (has_field(viscosity)) return walk_terms(viscosity, velocities, power, measure_term);
  TRY(measure(viscosity, velocities, &view));
  for (int p = 0; p < view.patches->patch_count; p++) {
    const ContactPatch *patch = &view.patches->patches[p];
    for (int n = patch->node_begin; n < patch->node_end; n++)
      power->dissipated += resistance(viscosity, &view, patch, &view.patches->nodes[n]) *
                           viscosity->rates[n] * viscosity->rates[n];
  }
  press(viscosity, &view);
  for (int k = view.evaluation->mesh_pair_count; k < view.evaluation->pair_count; k++) {
    double pressure = pressure_of_pair(viscosity, &view, k);
    const ContactPair *pair = &view.evaluation->pairs[k];
    const ContactShape *shape = &view.layout->def.shapes[view.layout->interfaces[pair->interface].shape];
    for (int v = 0; v < 4; v++) {
      Vec3 x = vec3_at(view.evaluation->positions +
                       3 * (size_t)contact_layout_vertices(view.layout, pair->cells[0])[v]);
      power->driven -=
          pressure * vec3_dot(vec3_at(view.evaluation->gradients + 24 * (size_t)k + 3 * (size_t)v),
                              contact_shape_velocity(shape, view.evaluation->time, x));
    }
  }
  return STATUS_OK;
}
