// SPDX-License-Identifier: GPL-3.0-or-later
// The contact effect's inside, for output, comparison and audit.
#ifndef TETLAP_FEM_EFFECT_CONTACT_CONTACT_H
#define TETLAP_FEM_EFFECT_CONTACT_CONTACT_H

#include "contact/system.h"
#include "fem/effect/system.h"
#include "fem/scene/scene.h"

// Contact of a model that has the same bodies in another shape, with the stiffness and the smoothness of
// surfaces that the effect `of` has. Destroy it as the effect's operations say.
Status fem_effect_contact_create_like(void **self, const FemModel *model, const void *of);

// The contact system of the effect that fem_system_effect(system, &fem_effect_contact) returned; borrowed.
ContactSystem *fem_effect_contact_system(void *effect);
// Pairs of cells closer than this are laid out in the matrix ahead, where effects were renewed [m].
double fem_effect_contact_reach(const void *effect);

// Contact at a state (contact_evaluate). NULL: the scene has none.
Status fem_effect_contact_evaluate(const FemSystem *system, const FemState *state,
                                   const ContactEvaluation **evaluation);

// The name of side `number` of an interface: a body, an obstacle with a mesh, or a shape.
const char *fem_effect_contact_name(const void *effect, int number);

// Makes the overlap model that the word names (overlap/source.h), its file seen from the program; NULL: the
// scene's. Either with what the scene says of networks. Destroy it with overlap_model_destroy.
Status fem_effect_contact_create_overlap(const FemSceneDef *scene, const char *name, OverlapModel *overlap);
// STATUS_INPUT: forces need more than what the model, made of `name`, gives, with what it lacks.
Status fem_effect_contact_check_overlap(const FemSceneDef *scene, const char *name,
                                        const OverlapModel *model);

#endif
