// SPDX-License-Identifier: GPL-3.0-or-later
// Prescribed motion: where a driven point is, and how fast, at a time.
#ifndef TETLAP_FEM_DRIVE_H
#define TETLAP_FEM_DRIVE_H

#include "fem/scene.h"

// x(t) = centre + R(spin t)(rest − centre) + velocity t + amplitude sin(2π frequency t) + table(t) +
// formula(t), all frozen from `until` on. Position [m] and velocity [m/s] of the point that rests at `rest`.
void fem_drive_point(const FemConstraintDef *def, double time, const double rest[3], double position[3],
                     double velocity[3]);

// Whether nothing ever moves.
bool fem_drive_is_still(const FemConstraintDef *def);

#endif
