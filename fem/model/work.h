// SPDX-License-Identifier: GPL-3.0-or-later
// What a factor of a body's matrix costs, beside a multigrid method, which takes about as many operations a
// vertex in any body. A factor of a cube of n vertices takes some n² operations, n a vertex; of a plate, a
// bar or a tube of as many far fewer.
#ifndef TETLAP_FEM_MODEL_WORK_H
#define TETLAP_FEM_MODEL_WORK_H

#include "fem/model/model.h"

// A body of at most FEM_WORK_UNCOUNTED vertices counts as a cube. So do all of a model of more than
// FEM_WORK_UNKNOWNS unknowns, which is not factorised, since the factor would take gigabytes.
enum { FEM_WORK_UNCOUNTED = 2500, FEM_WORK_UNKNOWNS = 200000 }; // not chosen: measured

// Fills each body's `cube`: of how many vertices a cube is whose factor takes as many operations a vertex, by
// the order of elimination that `cholmod` takes.
Status fem_model_work_count(FemModel *model);

#endif
