// SPDX-License-Identifier: GPL-3.0-or-later
// What a run reads beside its scene file, as digests: the meshes of its bodies and the weights of its overlap
// model. Kept in manifests and checkpoints, so that a later process sees whether they are still the same.
#ifndef TETLAP_APP_JOB_INPUTS_H
#define TETLAP_APP_JOB_INPUTS_H

#include "base/files/record.h"
#include "fem/model/model.h"

// Adds `meshes` (a digest a body: places, elements, which coordinates are unknown), `shapes` (places and
// elements alone), `weights_file` and
// `weights` ("none": the model has no such file). STATUS_IO: weights that cannot be read; STATUS_MEMORY.
Status app_inputs_record(const FemSceneDef *scene, const FemModel *model, Record *record);

// Whether the digests of two records differ, that of an end state to start from (app/job/start.h) too; of
// none, from everything.
bool app_inputs_differ(const Record *was, const Record *is);

#endif
