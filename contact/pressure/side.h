// SPDX-License-Identifier: GPL-3.0-or-later
// A cell of a pair as it lies, with the depth field in it (contact/pressure/field.h).
#ifndef TETLAP_CONTACT_PRESSURE_SIDE_H
#define TETLAP_CONTACT_PRESSURE_SIDE_H

#include "base/vec3.h"
#include "contact/search/layout.h"

typedef struct ContactSide {
  Vec3 x[4];        // vertices [m]
  Vec3 slope[4];    // ∇λ [1/m]
  double sign;      // −1: the cell is turned inside out, and σ of contact/pressure/field.h is; else 1
  Vec3 g;           // σ ∇φ
  double depths[4]; // σ φ of the vertices [m]
  double s;         // rest volume over the present one
} ContactSide;

ContactSide contact_side_of(const ContactLayout *layout, int cell, const double coordinates[12]);

// Barycentric coordinates in the cell.
void contact_side_locate(const ContactSide *side, Vec3 x, double lambda[4]);

// σ φ where these are the barycentric coordinates [m].
static inline double contact_side_depth(const ContactSide *side, const double lambda[4]) {
  double depth = 0;
  for (int v = 0; v < 4; v++) depth += lambda[v] * side->depths[v];
  return depth;
}

#endif
