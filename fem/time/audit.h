// SPDX-License-Identifier: GPL-3.0-or-later
// The energy audit of a run. The audited total
//     A = kinetic + elastic + gravity + contact + dissipated − work of driven vertices, obstacles and loads
// is constant in exact mechanics. It falls by the integrator's own damping; a rise is an error. Powers are
// integrated by the trapezoidal rule over accepted steps. Where a dissipated power falls to less than half in
// a step, the mean of its ends goes over to the logarithmic one.
// In steps of order 1 the powers at the ends of a step may overestimate what damping dissipates in it. Where
// a step seems to gain energy, a lower bound is computed from its middle, and A uses that. So a rise of A is
// a certain gain, and what the integrator lost is at most what A has fallen by.
//
// The bounds are those of fem/model/limits.h. With contact a step is refused if it gains energy beyond
// rounding once the run's gain is near its bound. A run that gains more than its bound is trouble
// (fem/output/trouble.h).
//
// Forces that are not the gradient of the energy, as a learned model's may be, give a power of their own,
// however short the steps are. What an integrator errs by falls faster than the step, and what a jump gives
// does not fall. So the step that stands is compared with the longest that was refused from the same state,
// if it has FEM_CUT² of its length or less. Where it gains with half to twice the power of that one, this is
// the forces' own power. Steps that gain with up to twice as much are not refused then. The own power is at
// most twice that of any step since, and none after a step that gains nothing.
#ifndef TETLAP_FEM_TIME_AUDIT_H
#define TETLAP_FEM_TIME_AUDIT_H

#include "fem/effect/effect.h"

typedef struct FemAuditBounds {
  double run;  // what a run may gain in all
  double near; // of the run's gain, from which on a step may gain rounding only; INFINITY: no step is refused
  double least; // energy that counts as the scene's at least in these shares [J]
} FemAuditBounds;

typedef struct FemAudit {
  double time;        // of the last accepted state [s]
  double damped;      // by dissipated_power so far, at least [J]
  double dissipated;  // damped, plastic work and friction with a history [J]
  double driven_work; // of driven vertices and obstacles [J]
  double work;        // driven_work and the loads' [J]
  double total;       // A [J]
  double uncertain;   // what steps that seemed to gain energy may have dissipated beyond `damped` [J]
  double first;       // A at the start [J]
  double lowest;      // smallest A so far [J]
  double gain;        // largest rise of A above an earlier value, less what is open [J]
  double scale;       // the scene's energy: largest of its parts so far, gravity from its start, without that
                      // of the common velocity (fem/model/floating.h) [J]
  double gravity_at_start;
  // By plasticity and friction, in the run whose end state this one starts from [J].
  double dissipated_at_start;
  double dissipated_power, driven_power; // at `time` [W]
  double open;                           // of a static scene: fem_audit_load_step [J]
  double load_change;                    // of its last step of load [J/s²]
  double own_power;                      // of the forces; 0: none is known [W]
  double refused_power, refused_step;    // of the longest step refused since `time`; 0: none [W], [s]
} FemAudit;

// `floor` [J]: what the scale is at least, so that rounding in a scene at rest is no gain.
void fem_audit_begin(FemAudit *audit, double time, const FemEnergy *energy, double floor);

// Before the audit of a static scene's next state. `begin` and `end` [J]: the work that the forces at the
// begin and at the end of a load step, `step` long, would do along the displacements of all that is driven
// and loaded. The work is their mean (trapezoidal rule), exact where force is proportional to displacement.
// Its uncertainty, `open`, is the difference of this step's change from that of the step before, plus
// `unbalanced`. Without a step before the whole change counts, since contact or slip may begin within the
// step. `unbalanced` is the work of the forces that equilibrium leaves [J]. A gain below `open` is not
// reported.
void fem_audit_load_step(FemAudit *audit, double step, double begin, double end, double unbalanced);

// The audit as it would be after accepting this state.
FemAudit fem_audit_next(const FemAudit *audit, double time, const FemEnergy *energy);
// The same where the step's mean of the dissipated power is known to be `least` at least [W]: what its ends
// give beyond that is uncertain and not counted.
FemAudit fem_audit_next_within(const FemAudit *audit, double time, const FemEnergy *energy, double least);

FemAuditBounds fem_audit_bounds(bool has_contact, double least);

// How far A stands above an earlier value, as a share of the scene's energy.
double fem_audit_rise(const FemAuditBounds *bounds, const FemAudit *audit);

// Whether the step between the two seems to gain more energy than rounding; `next_within` may find less.
bool fem_audit_is_doubtful(const FemAuditBounds *bounds, const FemAudit *before, const FemAudit *after);

// Whether the step between the two must be taken back.
bool fem_audit_is_refused(const FemAuditBounds *bounds, const FemAudit *before, const FemAudit *after);

// The step between `audit` and `refused` is taken back for its energy.
void fem_audit_refuse(FemAudit *audit, const FemAudit *refused);
// That between `audit` and `next` stands.
void fem_audit_accept(FemAudit *audit, const FemAudit *next);

// What the integrator itself has lost since the start at most, apart from all damping that was asked for [J];
// at least it is `uncertain` less. Negative: gained.
double fem_audit_lost(const FemAudit *audit);

// Coordinates that were driven have been set free: from now on their kinetic energy counts, and counts
// as work of the drive.
void fem_audit_release(FemAudit *audit, double kinetic_energy);

#endif
