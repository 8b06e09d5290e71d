// SPDX-License-Identifier: GPL-3.0-or-later
// Contact forces of whole scenes: all models compared with the exact one in the same configurations of one
// run; and a run with each model, whose time shows what the scene gains from a faster overlap.
#ifndef TETLAP_LAB_PARETO_SCENES_H
#define TETLAP_LAB_PARETO_SCENES_H

#include "lab/pareto/pareto.h"

// Whether the scene can be read, has contact and meshes that can be built: for all scenes before anything is
// measured.
Status lab_pareto_scenes_check(LabPareto *pareto, const char *scene, const char *reference,
                               const char *const *overrides, int override_count);

// Adds a point a model. `reference`: the overlap model of the run that configurations are taken from and that
// the other runs are compared with. A run that fails or takes too long is a result: its point says so.
Status lab_pareto_scenes_measure(LabPareto *pareto, const char *scene, const char *reference,
                                 const char *const *overrides, int override_count);

#endif
