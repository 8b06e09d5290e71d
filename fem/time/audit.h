// SPDX-License-Identifier: GPL-3.0-or-later
// The energy audit of a run. The audited total
//     A = kinetic + elastic + gravity + contact + dissipated − work of driven vertices, obstacles and loads
// is constant in exact mechanics and falls by the integrator's own damping; a rise is an error. Powers are
// integrated by the trapezoidal rule over accepted steps.
#ifndef TETLAP_FEM_TIME_AUDIT_H
#define TETLAP_FEM_TIME_AUDIT_H

#include "fem/effect/effect.h"

typedef struct FemAudit {
  double time;        // of the last accepted state [s]
  double damped;      // by dissipated_power so far [J]
  double dissipated;  // damped, plastic work and friction with a history [J]
  double driven_work; // of driven vertices and obstacles [J]
  double work;        // driven_work and the loads' [J]
  double total;       // A [J]
  double lowest;      // smallest A so far [J]
  double gain;        // largest rise of A above an earlier value [J]
  double scale;       // the scene's energy: largest of its parts so far, gravity from its start [J]
  double gravity_at_start;
  double dissipated_power, driven_power; // at `time` [W]
} FemAudit;

// `floor` [J]: what the scale is at least, so that a scene at rest is not judged by rounding.
void fem_audit_begin(FemAudit *audit, double time, const FemEnergy *energy, double floor);

// The audit as it would be after accepting this state.
FemAudit fem_audit_next(const FemAudit *audit, double time, const FemEnergy *energy);

// Coordinates that were driven have been set free: from now on their kinetic energy counts, and whoever drove
// them has given it to them.
void fem_audit_release(FemAudit *audit, double kinetic_energy);

#endif
