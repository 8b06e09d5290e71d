// SPDX-License-Identifier: GPL-3.0-or-later
// Which coordinates are unknowns: those that are neither prescribed nor of a body that is held. It changes in
// a run when vertices are released and when bodies fall asleep or awake.
#ifndef TETLAP_FEM_MODEL_NUMBERING_H
#define TETLAP_FEM_MODEL_NUMBERING_H

#include "fem/model/model.h"

// Numbers the unknowns anew.
void fem_model_numbering_renew(FemModel *model);

// A copy whose vertices can be released, and bodies held, while the run goes on: bodies, drivers and
// numbering are its own, all else is borrowed from `model`, which must outlive it.
Status fem_model_numbering_copy(FemModel *copy, const FemModel *model);
void fem_model_numbering_destroy_copy(FemModel *copy);

// The next time after `time` at which vertices are released; INFINITY: none.
double fem_model_numbering_next_release(const FemModel *model, double time);
// Releases what is due at `time` and numbers the unknowns anew.
void fem_model_numbering_release(FemModel *model, double time);

#endif
