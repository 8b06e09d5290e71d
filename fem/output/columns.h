// SPDX-License-Identifier: GPL-3.0-or-later
// The first columns of history.csv: a table with a row for each column, its title, the effect that it needs
// and its value. Those of bodies and interfaces follow (fem/output/recorder.c).
#ifndef TETLAP_FEM_OUTPUT_COLUMNS_H
#define TETLAP_FEM_OUTPUT_COLUMNS_H

#include "contact/status.h"
#include "fem/effect/system.h"
#include "fem/output/trouble.h"
#include "fem/time/audit.h"

// The measures of one state.
typedef struct FemMeasures {
  FemEnergy energy;
  double momentum[3], angular_momentum[3]; // [kg m/s], about the origin [kg m²/s]
  double deepest_overlap;                  // largest share of an element that is covered
  double min_det_F;
  double overlap_volume; // [m³]
  int active_pairs;
  double contact_force; // largest norm over interfaces [N]
  double peak_force;    // largest of that in the steps since the last row [N]
  double momentum_gap;  // the largest of a body, until the end of this step (fem/measure/momentum.h)
  int momentum_body;    // that body
  FemTroubleState trouble;
} FemMeasures;

// What a row is made from. `status` NULL: the scene does not ask for the elements' status.
typedef struct FemColumnSource {
  const FemState *state;
  double step; // the integrator's [s]
  const FemMeasures *measures;
  const FemAudit *audit;
  long long step_count, energy_events;
  const ContactStatus *status; // the recorder's
} FemColumnSource;

int fem_columns_count(void);
const char *fem_columns_title(int column);
// Whether a run of this system has the column.
bool fem_columns_is_wanted(int column, const FemSystem *system, bool has_status);
double fem_columns_value(int column, const FemColumnSource *source);

#endif
