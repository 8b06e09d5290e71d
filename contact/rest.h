// SPDX-License-Identifier: GPL-3.0-or-later
// What two that lie still keep: the result of their last evaluation. A facing whose parties are all held, so
// that nothing of it can change, is neither searched nor evaluated; its forces, covered volumes and energy
// stand in every evaluation as they were when it was put to rest.
#ifndef TETLAP_CONTACT_REST_H
#define TETLAP_CONTACT_REST_H

#include "contact/interface.h"
#include "contact/pressure/patches.h"
#include "contact/search/candidates.h"

typedef struct ContactRest {
  bool *is_resting; // of each facing                                        (facing_count)
  bool *is_near;    // of a resting one: it has candidate pairs              (facing_count)
  int resting_count;
  long long candidate_count, pair_count; // of resting facings: candidate pairs, and those with V > 0
  double energy;                         // theirs [J]
  double *forces;                        // theirs [N]                      (vertex_count, 3)
  double *covered;                       // theirs, Σ W_i [m³]              (tet_count)
  ContactInterface *interfaces;          // of resting facings              (facing_count)
} ContactRest;

// Nothing rests.
Status contact_rest_create(ContactRest *rest, const ContactLayout *layout);
void contact_rest_destroy(ContactRest *rest); // also of a zeroed one

// Forgets all that rests.
void contact_rest_clear(ContactRest *rest, const ContactLayout *layout);
// Takes over, from the patches and interfaces of a full evaluation on these candidates, every facing whose
// two parties (bodies, then shapes) are held.
void contact_rest_keep(ContactRest *rest, const ContactLayout *layout, const ContactCandidateList *candidates,
                       const ContactPatches *patches, const ContactInterface *interfaces,
                       const bool *is_held);

#endif
