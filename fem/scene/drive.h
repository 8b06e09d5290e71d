// SPDX-License-Identifier: GPL-3.0-or-later
// Prescribed motion: where a driven point is, and how fast, at a time.
#ifndef TETLAP_FEM_SCENE_DRIVE_H
#define TETLAP_FEM_SCENE_DRIVE_H

#include "fem/scene/scene.h"
#include "fem/scene/signal.h"

// x(t) = centre + R(θ(t))(rest − centre) + d(t), or where the motion moves first
// x(t) = centre + R(θ(t))(rest + d(t) − centre), with d = velocity t + amplitude sin(2π frequency t) +
// table(t)
// + formula(t) and θ = spin t + angle(t) + angles(t), all frozen from `until` on. Position [m] and velocity
// [m/s] of the point that rests at `rest`.
void fem_drive_point(const FemConstraintDef *def, double time, const double rest[3], double position[3],
                     double velocity[3]);

// From a time on, when the motion begins to differ from standing still: that time itself if it moves then,
// INFINITY if it never will again.
double fem_drive_next_change(const FemConstraintDef *def, double time);

// How far a step may go along the motion (signal.h); turns are seen at `arm` [m] from their axis.
double fem_drive_horizon(const FemConstraintDef *def, double arm, const FemForesight *foresight, double time,
                         double farthest);

// Of an external motion: from where it is at `time` it goes to the displacement [m], straight on, until `end`
// > `time` [s], and stays there. STATUS_MEMORY.
Status fem_drive_set(FemConstraintDef *def, double time, double end, const double displacement[3]);

// Whether nothing ever moves.
bool fem_drive_is_still(const FemConstraintDef *def);

#endif
