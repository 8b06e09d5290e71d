// SPDX-License-Identifier: GPL-3.0-or-later
// An upper bound of the energy with which a body may strike another, from the scene alone. It is what the
// body has at the start and what gravity gives it on its way down.
//
// A body falls from its own lowest point to the lowest point of all other bodies and obstacles: to where it
// meets a half-space, to the centre of a ball, a box or a cylinder. It falls no farther than it can until the
// scene ends, and not at all if one of its coordinates is prescribed. A body that another one stops on the
// way has less energy than this bound.
//
// If all bodies float, none falls. Energies are then relative to the common centre of mass, and those of the
// two hardest add up. For two bodies this sum is all that they can lose, m_A m_B/(m_A + m_B) v²/2.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_BLOW_H
#define TETLAP_FEM_MODEL_COMPLIANCE_BLOW_H

#include "fem/model/model.h"

// The largest of any body of the scene, or of two that float [J]; 0 in a static scene.
double fem_blow_hardest(const FemModel *model);

#endif
