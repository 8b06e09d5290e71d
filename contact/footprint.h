// SPDX-License-Identifier: GPL-3.0-or-later
// The heap memory of the parts of a contact system [bytes]: the lists grow with the number of near pairs, the
// rest with the meshes. An overlap model's own data (weights) are not among them.
#ifndef TETLAP_CONTACT_FOOTPRINT_H
#define TETLAP_CONTACT_FOOTPRINT_H

#include "contact/evaluation.h"
#include "contact/stiffness.h"
#include "contact/rest.h"
#include "contact/search/near.h"
#include "contact/status.h"

size_t contact_footprint_layout(const ContactLayout *layout);
size_t contact_footprint_candidates(const ContactCandidates *candidates);
size_t contact_footprint_near(const ContactNear *near);
size_t contact_footprint_rest(const ContactRest *rest);
size_t contact_footprint_evaluation(const ContactEvaluation *evaluation);
size_t contact_footprint_status(const ContactStatus *status);

#endif
