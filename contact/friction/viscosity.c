// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/viscosity.h"

#include <math.h>

#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/shape/shape.h"

Status contact_viscosity_create(ContactViscosity *viscosity, ContactSystem *system, double coefficient) {
  *viscosity = (ContactViscosity){.system = system, .viscosity = coefficient};
  if (!(coefficient > 0 && isfinite(coefficient)))
    return status_fail(STATUS_INPUT, "contact: the viscosity is %g Pa s/m²; it must be positive",
                       coefficient);
  return STATUS_OK;
}

// What all of this looks at.
typedef struct View {
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const double *velocities;
} View;

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

static void walk_terms(const ContactViscosity *viscosity, ContactViscosityMotion motion, void *self,
                       TakeTerm take) {
  View view = {.layout = contact_system_layout(viscosity->system),
               .evaluation = motion.evaluation,
               .velocities = contact_system_spread(viscosity->system, motion.velocities)};
  for (int k = 0; k < view.evaluation->pair_count; k++)
    for (int t = 0; t < 2; t++) {
      Term term;
      if (term_of(viscosity, &view, k, t, &term)) take(self, &term);
    }
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

typedef struct MomentSink {
  const double *positions;
  double (*moments)[3];
} MomentSink;

static void turn_term(void *self, const Term *term) {
  const MomentSink *to = self;
  for (int v = 0; v < 4; v++) {
    Vec3 x = vec3_at(to->positions + 3 * (size_t)term->vertices[v]);
    Vec3 force = vec3_scale(-term->resistance * term->rate, vec3_at(term->along + 3 * v));
    vec3_accumulate(to->moments[term->interface], vec3_cross(x, force));
  }
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

void contact_viscosity_add_force(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                 double *force) {
  walk_terms(viscosity, motion, &(ForceSink){contact_system_stars(viscosity->system), force}, push_term);
}

void contact_viscosity_add_resultants(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                      double (*resultants)[3]) {
  walk_terms(viscosity, motion, resultants, sum_term);
}

void contact_viscosity_add_moments(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                   double (*moments)[3]) {
  walk_terms(viscosity, motion, &(MomentSink){motion.evaluation->positions, moments}, turn_term);
}

void contact_viscosity_add_damping(const ContactViscosity *viscosity, ContactViscosityMotion motion,
                                   double scale, const ContactStiffnessSink *sink) {
  walk_terms(viscosity, motion, &(TermSink){contact_system_sink(viscosity->system, sink), scale}, bend_term);
}

ContactViscosityPower contact_viscosity_power(const ContactViscosity *viscosity,
                                              ContactViscosityMotion motion) {
  ContactViscosityPower power = {0, 0};
  walk_terms(viscosity, motion, &power, measure_term);
  return power;
}
