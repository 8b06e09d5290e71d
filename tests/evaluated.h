// SPDX-License-Identifier: GPL-3.0-or-later
// Contact at positions, evaluated anew, for tests.
#ifndef TETLAP_TESTS_EVALUATED_H
#define TETLAP_TESTS_EVALUATED_H

#include "suite.h"

#include "contact/system.h"

// The system's, valid until the next evaluation.
static inline const ContactEvaluation *evaluated_at(ContactSystem *system, double time, const double *x) {
  const ContactEvaluation *evaluation;
  ck_assert_ok(contact_evaluate(system, 0, time, x, &evaluation));
  return evaluation;
}

// The same at time 0, its forces added to `force` (vertex_count, 3).
static inline const ContactEvaluation *evaluated_with_force(ContactSystem *system, const double *x,
                                                            double *force) {
  const ContactEvaluation *evaluation = evaluated_at(system, 0, x);
  contact_system_add_force(system, evaluation, force);
  return evaluation;
}

#endif
