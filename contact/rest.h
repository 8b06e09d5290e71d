// SPDX-License-Identifier: GPL-3.0-or-later
// Contact between parties that are held in place. Nothing can change between two held parties, so their
// interface is neither searched nor evaluated. Its forces, covered volumes and energy are kept from the
// moment at which it was put to rest, and are part of every later result.
#ifndef TETLAP_CONTACT_REST_H
#define TETLAP_CONTACT_REST_H

#include "contact/interface.h"
#include "contact/pressure/patch/patches.h"
#include "contact/search/candidates.h"

typedef struct ContactRest {
  bool *is_resting; // of each interface                                        (interface_count)
  bool *is_near;    // of a resting one: it has candidate pairs              (interface_count)
  int resting_count;
  long long candidate_count, pair_count; // of resting interfaces: candidate pairs, and those with V > 0
  double energy;                         // of all resting interfaces [J]
  double *forces;                        // of them [N]                     (vertex_count, 3)
  double *covered;                       // of them, Σ W_i [m³]             (tet_count)
  ContactInterface *interfaces;          // of resting interfaces              (interface_count)
  double *areas; // of contact of resting interfaces [m²]; the user's       (interface_count)
} ContactRest;

// Nothing rests.
Status contact_rest_create(ContactRest *rest, const ContactLayout *layout);
void contact_rest_destroy(ContactRest *rest); // also of a zeroed one

// Forgets all that rests.
void contact_rest_clear(ContactRest *rest, const ContactLayout *layout);
// Takes over, from the patches and interfaces of a full evaluation on these candidates, every interface whose
// two parties (bodies, then shapes) are held.
void contact_rest_keep(ContactRest *rest, const ContactLayout *layout, const ContactCandidateList *candidates,
                       const ContactPatches *patches, const ContactInterface *interfaces,
                       const bool *is_held);

#endif
