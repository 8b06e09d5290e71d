// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/scene/drive.h"

#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/scene/table.h"

static FemTable table_of(const FemConstraintDef *def) {
  return (FemTable){def->table, 4, def->table_count};
}

static FemTable angles_of(const FemConstraintDef *def) {
  return (FemTable){def->angles, 2, def->angle_count};
}

// [rad]
static ExpressionValue angle_at(const FemConstraintDef *def, double time) {
  ExpressionValue angle = {.value = def->spin * time, .rate = def->spin};
  if (def->angle) {
    ExpressionValue more = expression_eval(def->angle, time);
    angle.value += more.value, angle.rate += more.rate;
  }
  if (def->angle_count > 0) {
    double value, rate;
    fem_table_eval(angles_of(def), time, &value, &rate);
    angle.value += value, angle.rate += rate;
  }
  return angle;
}

// Rodrigues' formula about the unit vector of an axis.
static Vec3 turn(Vec3 axis, double angle, Vec3 arm) {
  Vec3 along = vec3_scale(vec3_dot(axis, arm), axis);
  Vec3 across = vec3_scale(cos(angle), vec3_sub(arm, along));
  return vec3_add(vec3_add(across, vec3_scale(sin(angle), vec3_cross(axis, arm))), along);
}

static void turn_about_axis(const FemConstraintDef *def, double time, double position[3],
                            double velocity[3]) {
  Vec3 axis = vec3_at(def->axis), centre = vec3_at(def->centre);
  axis = vec3_scale(1 / vec3_length(axis), axis);
  ExpressionValue angle = angle_at(def, time);
  Vec3 turned = turn(axis, angle.value, vec3_sub(vec3_at(position), centre));
  Vec3 carried = turn(axis, angle.value, vec3_at(velocity));
  vec3_store(position, vec3_add(centre, turned));
  vec3_store(velocity, vec3_add(carried, vec3_scale(angle.rate, vec3_cross(axis, turned))));
}

// Adds what moves all points alike.
static void translate(const FemConstraintDef *def, double time, double position[3], double velocity[3]) {
  double omega = 2 * M_PI * def->frequency;
  for (int c = 0; c < 3; c++) {
    position[c] += def->velocity[c] * time + def->amplitude[c] * sin(omega * time);
    velocity[c] += def->velocity[c] + def->amplitude[c] * omega * cos(omega * time);
  }
  if (def->table_count > 0) {
    double displacement[3], rate[3];
    fem_table_eval(table_of(def), time, displacement, rate);
    for (int c = 0; c < 3; c++) position[c] += displacement[c], velocity[c] += rate[c];
  }
  for (int c = 0; c < 3; c++) {
    if (!def->formula[c]) continue;
    ExpressionValue displacement = expression_eval(def->formula[c], time);
    position[c] += displacement.value;
    velocity[c] += displacement.rate;
  }
}

void fem_drive_point(const FemConstraintDef *def, double time, const double rest[3], double position[3],
                     double velocity[3]) {
  bool is_frozen = time >= def->until;
  double t = is_frozen ? def->until : time;
  for (int c = 0; c < 3; c++) position[c] = rest[c], velocity[c] = 0;
  bool turns = def->spin != 0 || def->turns;
  if (def->moves_first) translate(def, t, position, velocity);
  if (turns) turn_about_axis(def, t, position, velocity);
  if (!def->moves_first) translate(def, t, position, velocity);
  for (int c = 0; c < 3 && is_frozen; c++) velocity[c] = 0;
}

double fem_drive_next_change(const FemConstraintDef *def, double time) {
  if (fem_drive_is_still(def) || time >= def->until) return INFINITY;
  bool flows = def->spin != 0 || (def->angle && !expression_is_constant(def->angle));
  for (int c = 0; c < 3; c++)
    flows = flows || def->velocity[c] != 0 || def->amplitude[c] != 0 ||
            (def->formula[c] && !expression_is_constant(def->formula[c]));
  if (flows) return time;
  double next = fmin(fem_table_next_change(table_of(def), time), fem_table_next_change(angles_of(def), time));
  return next < def->until ? next : INFINITY;
}

// Without the turn, which is another signal.
static void eval_motion(const void *self, double time, double value[3], double rate[3]) {
  const FemConstraintDef *def = self;
  for (int c = 0; c < 3; c++) value[c] = rate[c] = 0;
  translate(def, fmin(time, def->until), value, rate);
  for (int c = 0; c < 3 && time >= def->until; c++) rate[c] = 0;
}

static void eval_angle(const void *self, double time, double value[3], double rate[3]) {
  const FemConstraintDef *def = self;
  ExpressionValue angle = angle_at(def, fmin(time, def->until));
  value[0] = angle.value, rate[0] = time >= def->until ? 0 : angle.rate;
  value[1] = value[2] = rate[1] = rate[2] = 0;
}

static double next_knot_of_angle(const void *self, double time) {
  const FemConstraintDef *def = self;
  double next = fem_table_next_row(angles_of(def), time);
  if (def->angle) next = fmin(next, expression_next_kink(def->angle, time));
  return time < def->until ? fmin(next, def->until) : INFINITY;
}

static double next_knot(const void *self, double time) {
  const FemConstraintDef *def = self;
  double next = fem_table_next_row(table_of(def), time);
  for (int c = 0; c < 3; c++)
    if (def->formula[c]) next = fmin(next, expression_next_kink(def->formula[c], time));
  if (time < def->until) return fmin(next, def->until);
  return INFINITY;
}

double fem_drive_horizon(const FemConstraintDef *def, double arm, const FemForesight *foresight, double time,
                         double farthest) {
  FemSignal signal = {.def = def,
                      .eval = eval_motion,
                      .next_knot = next_knot,
                      .deviation = foresight->displacement,
                      .impulse = INFINITY};
  for (int c = 0; c < 3; c++)
    signal.is_curved = signal.is_curved || def->formula[c] || def->amplitude[c] != 0;
  FemSignal angle = {.def = def,
                     .eval = eval_angle,
                     .next_knot = next_knot_of_angle,
                     .is_curved = def->angle,
                     .deviation = foresight->displacement / arm,
                     .impulse = INFINITY};
  double horizon = fem_signal_horizon(&signal, foresight, time, farthest);
  if (def->turns) horizon = fem_signal_horizon(&angle, foresight, time, horizon);
  bool ends_turning = def->spin != 0 && def->until - time > foresight->resolution;
  return ends_turning ? fmin(horizon, def->until) : horizon;
}

Status fem_drive_set(FemConstraintDef *def, double time, double end, const double displacement[3]) {
  double from[4] = {time}, rate[3];
  if (def->table_count > 0) fem_table_eval(table_of(def), time, from + 1, rate);
  if (!def->table) def->table = memory_zeroed(2 * sizeof from / sizeof *from, sizeof *from);
  if (!def->table) return status_no_memory("a motion");
  memcpy(def->table, from, sizeof from);
  def->table[4] = end;
  memcpy(def->table + 5, displacement, 3 * sizeof *displacement);
  def->table_count = 2;
  return STATUS_OK;
}

bool fem_drive_is_still(const FemConstraintDef *def) {
  bool moves = def->is_external || def->spin != 0 || def->turns || def->table_count > 0;
  for (int c = 0; c < 3; c++)
    moves = moves || def->velocity[c] != 0 || def->amplitude[c] != 0 || def->formula[c] != NULL;
  return !moves;
}
