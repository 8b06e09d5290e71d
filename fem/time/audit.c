// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/audit.h"

#include <math.h>

#include "fem/model/limits.h"

static double stored(const FemEnergy *energy) {
  return energy->kinetic + energy->elastic + energy->gravity + energy->contact;
}

static double largest_part(const FemAudit *audit, const FemEnergy *energy) {
  double moving = fmax(fabs(energy->kinetic - energy->common_kinetic), fabs(energy->elastic));
  double fallen = energy->gravity - energy->common_gravity - audit->gravity_at_start;
  double held = fmax(fabs(energy->contact), fabs(fallen));
  return fmax(fmax(moving, held), fmax(fabs(audit->work), audit->dissipated));
}

void fem_audit_begin(FemAudit *audit, double time, const FemEnergy *energy, double floor) {
  double total = stored(energy) - energy->applied_work;
  *audit = (FemAudit){.time = time,
                      .work = energy->applied_work,
                      .total = total,
                      .first = total,
                      .lowest = total,
                      .scale = floor,
                      .dissipated_at_start = energy->plastic_work + energy->friction_work,
                      .gravity_at_start = energy->gravity - energy->common_gravity,
                      .dissipated_power = energy->dissipated_power,
                      .driven_power = energy->driven_power};
  audit->scale = fmax(floor, largest_part(audit, energy));
}

// The mean of a dissipated power over a step, from its values at both ends. For a power that oscillates the
// trapezoidal rule is right: its errors cancel over a period, and the logarithmic mean would be too small by
// (ω h)²/6. A power that falls by much in a step falls exponentially, as that of a mode which is damped
// faster than the step is long: there the logarithmic mean is right, and the mean of the ends would be many
// times the energy that there was. The first is used up to a fall by SWINGS, the second from FALLS on, a
// blend in between.
enum { SWINGS = 2, FALLS = SWINGS * SWINGS * SWINGS };
static double mean_dissipated(double begin, double end) {
  const double trapezoid = 0.5 * (begin + end);
  if (!(begin > SWINGS * end)) return trapezoid;
  if (!(end > 0)) return 0;
  double share = fmin(1, log(begin / end / SWINGS) / log((double)FALLS / SWINGS));
  double smooth = share * share * (3 - 2 * share);
  return trapezoid + smooth * ((begin - end) / log(begin / end) - trapezoid);
}

void fem_audit_load_step(FemAudit *audit, double step, double begin, double end, double unbalanced) {
  double change = end - begin, expected = audit->load_change * step * step;
  audit->open += unbalanced + 0.5 * fmin(fabs(change), fabs(change - expected));
  audit->load_change = change / (step * step);
}

FemAudit fem_audit_next(const FemAudit *audit, double time, const FemEnergy *energy) {
  return fem_audit_next_within(audit, time, energy, INFINITY);
}

FemAudit fem_audit_next_within(const FemAudit *audit, double time, const FemEnergy *energy, double least) {
  FemAudit next = *audit;
  const double half_step = 0.5 * (time - audit->time),
               mean = mean_dissipated(audit->dissipated_power, energy->dissipated_power),
               certain = fmin(mean, least);
  next.time = time;
  next.damped += 2 * half_step * certain;
  next.uncertain += 2 * half_step * (mean - certain);
  next.driven_work += half_step * (audit->driven_power + energy->driven_power);
  next.work = next.driven_work + energy->applied_work;
  next.dissipated = next.damped + energy->plastic_work + energy->friction_work - audit->dissipated_at_start;
  next.dissipated_power = energy->dissipated_power;
  next.driven_power = energy->driven_power;
  next.total = stored(energy) + next.dissipated - next.work;
  next.gain = fmax(audit->gain, next.total - audit->lowest - audit->open);
  next.lowest = fmin(audit->lowest, next.total);
  next.scale = fmax(audit->scale, largest_part(&next, energy));
  return next;
}

FemAuditBounds fem_audit_bounds(bool has_contact, double least) {
  double run = has_contact ? FEM_ENERGY : FEM_WITHOUT_CONTACT * FEM_ENERGY;
  return (FemAuditBounds){.run = run, .near = has_contact ? FEM_ENERGY_NEAR : INFINITY, .least = least};
}

double fem_audit_rise(const FemAuditBounds *bounds, const FemAudit *audit) {
  return (audit->total - audit->lowest - audit->open) / fmax(audit->scale, bounds->least);
}

bool fem_audit_is_doubtful(const FemAuditBounds *bounds, const FemAudit *before, const FemAudit *after) {
  return !(after->total - before->total <= FEM_ENERGY_STEP * fmax(after->scale, bounds->least));
}

// With which the step between the two gains energy [W].
static double power_of(const FemAudit *before, const FemAudit *after) {
  return (after->total - before->total) / (after->time - before->time);
}

bool fem_audit_is_refused(const FemAuditBounds *bounds, const FemAudit *before, const FemAudit *after) {
  const double scale = fmax(after->scale, bounds->least);
  double of_step = (after->total - before->total) / scale;
  double of_run = (after->total - before->lowest) / scale;
  bool is_held = of_run <= bounds->near || of_step <= FEM_ENERGY_STEP;
  return !is_held && !(power_of(before, after) <= 2 * before->own_power);
}

void fem_audit_refuse(FemAudit *audit, const FemAudit *refused) {
  if (audit->refused_step > 0) return;
  audit->refused_power = power_of(audit, refused);
  audit->refused_step = refused->time - audit->time;
}

void fem_audit_accept(FemAudit *audit, const FemAudit *next) {
  const double power = power_of(audit, next), step = next->time - audit->time;
  double own = fmax(0, fmin(audit->own_power, 2 * power));
  bool is_short = step * (1 - FEM_ROUNDING) <= FEM_CUT * FEM_CUT * audit->refused_step;
  if (is_short && power >= 0.5 * audit->refused_power && power <= 2 * audit->refused_power) own = power;
  *audit = *next;
  audit->own_power = own;
  audit->refused_power = audit->refused_step = 0;
}

double fem_audit_lost(const FemAudit *audit) {
  return audit->first - audit->total;
}

void fem_audit_release(FemAudit *audit, double kinetic_energy) {
  audit->driven_work += kinetic_energy;
  audit->work += kinetic_energy;
}
