// SPDX-License-Identifier: GPL-3.0-or-later
// Which elements overlap, by a model and by a reference, and where the two differ: the classification that
// TetrahedronPairNet is judged by, here for the meshes of a scene. All pairs of elements whose boxes meet are
// classified; shapes need no model.
//
// A model's answer is that of its status head if it has one, else V > 0. Where a model has an exact test for
// disjoint pairs, that decides.
#ifndef TETLAP_CONTACT_STATUS_H
#define TETLAP_CONTACT_STATUS_H

#include "contact/search/candidates.h"

typedef enum ContactVerdict {
  CONTACT_VERDICT_RIGHT,
  CONTACT_VERDICT_FALSE_POSITIVE, // called overlapping, and is not
  CONTACT_VERDICT_FALSE_NEGATIVE, // overlaps, and is not called so
} ContactVerdict;

// Of pairs, or of elements.
typedef struct ContactStatusCounts {
  long long asked, overlapping; // overlapping by the reference
  long long false_positives, false_negatives;
} ContactStatusCounts;

// An element's status: whether it overlaps any element of another body.
typedef struct ContactStatus {
  int *predicted, *exact;              // 0 or 1                                       (tet_count)
  int *error;                          // ContactVerdict                               (tet_count)
  int *wrong_pairs;                    // its wrongly classified pairs                 (tet_count)
  ContactStatusCounts pairs, elements; // pairs of cells of the contact mesh
  // Scratch memory for a portion of the pairs.
  ContactPair *portion;
  double *coordinates, *asked, *volumes;
  int *places;            // of those asked in the portion
  unsigned char *says[2]; // model, reference
  double (*boxes)[6];     // of the candidates' cells                     (cell_count)
} ContactStatus;

Status contact_status_create(ContactStatus *status, const ContactLayout *layout);
void contact_status_destroy(ContactStatus *status);

// Runs both at these positions, which the candidates must cover.
Status contact_status_run(ContactStatus *status, const ContactLayout *layout,
                          const ContactCandidateList *candidates, const OverlapModel *model,
                          const OverlapModel *reference, const double *positions);

#endif
