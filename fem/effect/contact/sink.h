// SPDX-License-Identifier: GPL-3.0-or-later
// The matrix of a run as the place where contact's stiffness goes.
#ifndef TETLAP_FEM_EFFECT_CONTACT_SINK_H
#define TETLAP_FEM_EFFECT_CONTACT_SINK_H

#include "contact/stiffness.h"
#include "fem/sparse/matrix.h"

typedef struct FemContactSink {
  FemMatrix *matrix; // borrowed
  double scale;      // factor of all that is added
} FemContactSink;

// Adds to the sink's matrix; `sink` is borrowed and must live as long as the result.
ContactStiffnessSink fem_contact_sink_of(FemContactSink *sink);

#endif
