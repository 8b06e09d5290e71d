// SPDX-License-Identifier: GPL-3.0-or-later
// A pressure law p(d): the pressure between two flat surfaces that overlap by d in all, whether both are
// bodies or one is an obstacle. It stands in place of the linear law of the potential `field`
// (contact/pressure/field.h).
//
//   power        p = P (d/D)ⁿ, n ≥ 1
//   exponential  p = P (exp(d/D) − 1)
//   table        rows (d, p) from (0, 0), joined by the monotone cubics of Fritsch and Carlson 1980 with the
//                slopes of Fritsch and Butland 1984, so that p′ is continuous; beyond the last row straight
//   formula      of d
#ifndef TETLAP_CONTACT_PRESSURE_LAW_H
#define TETLAP_CONTACT_PRESSURE_LAW_H

#include <stdbool.h>
#include <stddef.h>

#include "base/expression.h"

typedef enum ContactLawKind {
  CONTACT_LAW_LINEAR, // by a stiffness: no law of this file
  CONTACT_LAW_POWER,
  CONTACT_LAW_EXPONENTIAL,
  CONTACT_LAW_TABLE,
  CONTACT_LAW_FORMULA,
} ContactLawKind;

// What is asked of a law: its value, or its derivative by one of its constants. Pressures, forces and
// energies are linear in p(d), so with the derivative in its place they are the derivatives.
typedef enum ContactLawBy {
  CONTACT_LAW_VALUE,
  CONTACT_LAW_BY_PRESSURE,
  CONTACT_LAW_BY_DEPTH,
  CONTACT_LAW_BY_EXPONENT, // above 1
  CONTACT_LAW_BY_ROW,      // by the pressure in `row` of the table
} ContactLawBy;

typedef struct ContactLaw {
  ContactLawKind kind;
  ContactLawBy by;
  int row;
  double pressure, depth, exponent; // P [Pa], D [m], n
  double *table;                    // d [m], p [Pa], both increasing       (table_count, 2)
  int table_count;
  Expression *formula; // p [Pa] of d [m]
} ContactLaw;

typedef struct ContactLawValue {
  double pressure; // p [Pa]
  double slope;    // p′ [Pa/m]
  double curve;    // p″ [Pa/m²]
} ContactLawValue;

// Of a law that is not linear. Below 0 it is odd, p(−d) = −p(d). Not finite where a formula is not.
ContactLawValue contact_law_at(const ContactLaw *law, double depth);

// "p = 1e+06 Pa (d/1e-05 m)^2".
void contact_law_describe(const ContactLaw *law, char *text, size_t size);

// Looks at the law from depth 0 to `deepest` [m], or until p exceeds `highest` [Pa]. False: `why` says what
// is wrong: p(0) is not 0, p falls, is not finite, or is 0 everywhere.
bool contact_law_check(const ContactLaw *law, double deepest, double highest, char *why, size_t size);

#endif
