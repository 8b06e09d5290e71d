// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/columns.h"

#include <math.h>

static double time_s(const FemColumnSource *s) {
  return s->state->time;
}
static double kinetic_J(const FemColumnSource *s) {
  return s->measures->energy.kinetic;
}
static double elastic_J(const FemColumnSource *s) {
  return s->measures->energy.elastic;
}
static double gravity_J(const FemColumnSource *s) {
  return s->measures->energy.gravity;
}
static double contact_J(const FemColumnSource *s) {
  return s->measures->energy.contact;
}
static double work_J(const FemColumnSource *s) {
  return s->audit->work;
}
static double dissipated_J(const FemColumnSource *s) {
  return s->audit->dissipated;
}
static double total_J(const FemColumnSource *s) {
  return s->audit->total;
}
static double lost_J(const FemColumnSource *s) {
  return fem_audit_lost(s->audit);
}
static double momentum_x(const FemColumnSource *s) {
  return s->measures->momentum[0];
}
static double momentum_y(const FemColumnSource *s) {
  return s->measures->momentum[1];
}
static double momentum_z(const FemColumnSource *s) {
  return s->measures->momentum[2];
}
static double angular_x(const FemColumnSource *s) {
  return s->measures->angular_momentum[0];
}
static double angular_y(const FemColumnSource *s) {
  return s->measures->angular_momentum[1];
}
static double angular_z(const FemColumnSource *s) {
  return s->measures->angular_momentum[2];
}
static double active_pairs(const FemColumnSource *s) {
  return s->measures->active_pairs;
}
static double contact_force_peak_N(const FemColumnSource *s) {
  return fmax(s->measures->contact_force, s->measures->peak_force);
}
static double overlap_m3(const FemColumnSource *s) {
  return s->measures->overlap_volume;
}
static double deepest_overlap(const FemColumnSource *s) {
  return s->measures->deepest_overlap;
}
static double min_det_F(const FemColumnSource *s) {
  return s->measures->min_det_F;
}
static double step_s(const FemColumnSource *s) {
  return s->step;
}
static double steps(const FemColumnSource *s) {
  return (double)s->step_count;
}
static double energy_gain(const FemColumnSource *s) {
  return s->audit->gain / s->audit->scale;
}
static double energy_events(const FemColumnSource *s) {
  return (double)s->energy_events;
}
static double momentum_gap(const FemColumnSource *s) {
  return s->measures->momentum_gap;
}
static double inverted(const FemColumnSource *s) {
  return s->measures->trouble.count[FEM_TROUBLE_INVERTED];
}
static double enclosed(const FemColumnSource *s) {
  return s->measures->trouble.count[FEM_TROUBLE_ENCLOSED];
}
static double wrong_way(const FemColumnSource *s) {
  return s->measures->trouble.count[FEM_TROUBLE_WRONG_WAY];
}
static double status_pairs(const FemColumnSource *s) {
  return s->status ? (double)s->status->pairs.asked : 0;
}
static double status_overlapping(const FemColumnSource *s) {
  return s->status ? (double)s->status->pairs.overlapping : 0;
}
static double status_false_positive(const FemColumnSource *s) {
  return s->status ? (double)s->status->pairs.false_positives : 0;
}
static double status_false_negative(const FemColumnSource *s) {
  return s->status ? (double)s->status->pairs.false_negatives : 0;
}
static double status_wrong_elements(const FemColumnSource *s) {
  return s->status ? (double)(s->status->elements.false_positives + s->status->elements.false_negatives) : 0;
}

typedef enum When {
  ALWAYS,
  IF_EFFECT,      // the scene has the effect of the row
  IF_DISSIPATIVE, // an effect dissipates
  IF_MOTION,      // the scene is not static
  IF_STATUS,      // the scene asks for the elements' status
} When;

static const struct {
  const char *title;
  double (*value)(const FemColumnSource *source);
  When when;
  const FemEffectOps *effect;
} columns[] = {
    {"time_s", time_s, .when = ALWAYS},
    {"kinetic_J", kinetic_J, .when = ALWAYS},
    {"elastic_J", elastic_J, .when = ALWAYS},
    {"gravity_J", gravity_J, .when = IF_EFFECT, .effect = &fem_effect_gravity},
    {"contact_J", contact_J, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"work_J", work_J, .when = ALWAYS},
    {"dissipated_J", dissipated_J, .when = IF_DISSIPATIVE},
    {"total_J", total_J, .when = ALWAYS},
    {"lost_J", lost_J, .when = ALWAYS},
    {"momentum_x", momentum_x, .when = ALWAYS},
    {"momentum_y", momentum_y, .when = ALWAYS},
    {"momentum_z", momentum_z, .when = ALWAYS},
    {"angular_x", angular_x, .when = ALWAYS},
    {"angular_y", angular_y, .when = ALWAYS},
    {"angular_z", angular_z, .when = ALWAYS},
    {"active_pairs", active_pairs, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"contact_force_peak_N", contact_force_peak_N, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"overlap_m3", overlap_m3, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"deepest_overlap", deepest_overlap, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"min_det_F", min_det_F, .when = ALWAYS},
    {"step_s", step_s, .when = ALWAYS},
    {"steps", steps, .when = ALWAYS},
    {"energy_gain", energy_gain, .when = ALWAYS},
    {"energy_events", energy_events, .when = ALWAYS},
    {"momentum_gap", momentum_gap, .when = IF_MOTION},
    {"inverted", inverted, .when = ALWAYS},
    {"enclosed", enclosed, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"wrong_way", wrong_way, .when = IF_EFFECT, .effect = &fem_effect_contact},
    {"status_pairs", status_pairs, .when = IF_STATUS},
    {"status_overlapping", status_overlapping, .when = IF_STATUS},
    {"status_false_positive", status_false_positive, .when = IF_STATUS},
    {"status_false_negative", status_false_negative, .when = IF_STATUS},
    {"status_wrong_elements", status_wrong_elements, .when = IF_STATUS},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

int fem_columns_count(void) {
  return COLUMN_COUNT;
}

const char *fem_columns_title(int column) {
  return columns[column].title;
}

bool fem_columns_is_wanted(int column, const FemSystem *system, bool has_status) {
  switch (columns[column].when) {
  case ALWAYS:
    return true;
  case IF_EFFECT:
    return fem_system_effect(system, columns[column].effect) != NULL;
  case IF_DISSIPATIVE:
    return fem_system_dissipates(system) || fem_system_effect(system, &fem_effect_plasticity) ||
           fem_system_effect(system, &fem_effect_stick);
  case IF_MOTION:
    return !system->model->scene->is_static;
  case IF_STATUS:
    return has_status;
  }
  return false;
}

double fem_columns_value(int column, const FemColumnSource *source) {
  return columns[column].value(source);
}
