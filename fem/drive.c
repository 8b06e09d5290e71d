// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/drive.h"

#include <stddef.h>

#include "base/vec3.h"

// Linear between the rows (time, displacement); constant before the first and after the last.
static void follow_table(const FemConstraintDef *def, double time, double displacement[3],
                         double velocity[3]) {
  const double *rows = def->table;
  int last = def->table_count - 1, k = 0;
  while (k < last && rows[4 * (k + 1)] <= time) k++;
  bool is_between = k < last && time >= rows[0];
  double span = is_between ? rows[4 * (k + 1)] - rows[4 * k] : 1;
  double share = is_between ? (time - rows[4 * k]) / span : 0;
  for (int c = 0; c < 3; c++) {
    double from = rows[4 * k + 1 + c], to = is_between ? rows[4 * (k + 1) + 1 + c] : from;
    displacement[c] += from + share * (to - from);
    velocity[c] += (to - from) / span;
  }
}

// Rodrigues' formula about the axis through the centre.
static void turn(const FemConstraintDef *def, double time, double position[3], double velocity[3]) {
  Vec3 axis = vec3_at(def->axis), centre = vec3_at(def->centre);
  axis = vec3_scale(1 / vec3_length(axis), axis);
  double angle = def->spin * time, cosine = cos(angle), sine = sin(angle);
  Vec3 arm = vec3_sub(vec3_at(position), centre);
  Vec3 along = vec3_scale(vec3_dot(axis, arm), axis);
  Vec3 turned = vec3_add(
      vec3_add(vec3_scale(cosine, vec3_sub(arm, along)), vec3_scale(sine, vec3_cross(axis, arm))), along);
  vec3_store(position, vec3_add(centre, turned));
  vec3_accumulate(velocity, vec3_scale(def->spin, vec3_cross(axis, turned)));
}

void fem_drive_point(const FemConstraintDef *def, double time, const double rest[3], double position[3],
                     double velocity[3]) {
  bool is_frozen = time >= def->until;
  double t = is_frozen ? def->until : time;
  for (int c = 0; c < 3; c++) position[c] = rest[c], velocity[c] = 0;
  if (def->spin != 0) turn(def, t, position, velocity);
  double omega = 2 * M_PI * def->frequency;
  for (int c = 0; c < 3; c++) {
    position[c] += def->velocity[c] * t + def->amplitude[c] * sin(omega * t);
    velocity[c] += def->velocity[c] + def->amplitude[c] * omega * cos(omega * t);
  }
  if (def->table_count > 0) {
    double displacement[3] = {0, 0, 0};
    follow_table(def, t, displacement, velocity);
    for (int c = 0; c < 3; c++) position[c] += displacement[c];
  }
  for (int c = 0; c < 3; c++) {
    if (!def->formula[c]) continue;
    ExpressionValue displacement = expression_eval(def->formula[c], t);
    position[c] += displacement.value;
    velocity[c] += displacement.rate;
  }
  if (is_frozen)
    for (int c = 0; c < 3; c++) velocity[c] = 0;
}

static bool is_flat(const double *rows, int width, int k) {
  for (int c = 1; c < width; c++)
    if (rows[width * (k + 1) + c] != rows[width * k + c]) return false;
  return true;
}

double fem_drive_table_next_change(const double *rows, int width, int count, double time) {
  int last = count - 1, k = 0;
  while (k < last && rows[width * (k + 1)] <= time) k++;
  if (k >= last) return INFINITY;
  if (time >= rows[0] && !is_flat(rows, width, k)) return time;
  while (k < last && is_flat(rows, width, k)) k++;
  return k < last ? rows[width * k] : INFINITY;
}

double fem_drive_next_change(const FemConstraintDef *def, double time) {
  if (fem_drive_is_still(def) || time >= def->until) return INFINITY;
  bool flows = def->spin != 0;
  for (int c = 0; c < 3; c++)
    flows = flows || def->velocity[c] != 0 || def->amplitude[c] != 0 ||
            (def->formula[c] && !expression_is_constant(def->formula[c]));
  if (flows) return time;
  double next =
      def->table_count > 0 ? fem_drive_table_next_change(def->table, 4, def->table_count, time) : INFINITY;
  return next < def->until ? next : INFINITY;
}

bool fem_drive_is_still(const FemConstraintDef *def) {
  bool moves = def->spin != 0 || def->table_count > 0;
  for (int c = 0; c < 3; c++)
    moves = moves || def->velocity[c] != 0 || def->amplitude[c] != 0 || def->formula[c] != NULL;
  return !moves;
}
