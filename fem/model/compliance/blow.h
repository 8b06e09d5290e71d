// SPDX-License-Identifier: GPL-3.0-or-later
// An upper bound of the energy with which a body may strike another, from the scene alone: what it has at the
// start and what gravity gives it on its way down.
//
// A body falls as far as the lowest point of any other body or obstacle lies below its own: to a half-space
// along gravity, of a ball, a box or a cylinder to its centre; not farther than the time until the end lets
// it, and not at all while some of its coordinates are prescribed, or while all bodies float: then energies
// are relative to the centre of mass, and the two hardest count together. Of two bodies that is all that
// they can lose, m_A m_B/(m_A + m_B) v²/2. A body that another one stops on the way has less.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_BLOW_H
#define TETLAP_FEM_MODEL_COMPLIANCE_BLOW_H

#include "fem/model/model.h"

// The largest of any body of the scene, or of two that float [J]; 0 in a static scene.
double fem_blow_hardest(const FemModel *model);

#endif
