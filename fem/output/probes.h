// SPDX-License-Identifier: GPL-3.0-or-later
// Probes of the scene as columns of history.csv: probe_NAME_force_x_N … (fem/measure/reading.h).
#ifndef TETLAP_FEM_OUTPUT_PROBES_H
#define TETLAP_FEM_OUTPUT_PROBES_H

#include "fem/effect/system.h"
#include "fem/measure/reading.h"
#include "fem/output/forces.h"
#include "fem/output/history.h"

typedef struct FemProbes {
  FemSystem *system;    // borrowed
  double *external;     // scratch: forces from outside [N]         (vertex_count, 3)
  double *reaction;     // scratch                                  (vertex_count, 3)
  FemReading *readings; // of the state that was measured last      (probe_count)
} FemProbes;

// Without probes in the scene all below does nothing. A zeroed one, and one whose creation failed, can be
// destroyed.
Status fem_probes_create(FemProbes *probes, FemSystem *system);
void fem_probes_destroy(FemProbes *probes);

Status fem_probes_add_columns(FemHistory *history, const FemModel *model);

// Reads all probes at a state, whose forces of contact are given.
Status fem_probes_measure(FemProbes *probes, const FemState *state, const FemForces *contact);

// The columns' values; returns the end of them.
double *fem_probes_fill(const FemProbes *probes, double *row);

#endif
