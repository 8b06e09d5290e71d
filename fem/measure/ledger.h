// SPDX-License-Identifier: GPL-3.0-or-later
// What is accumulated over accepted states: the balance of momentum (momentum.h), elements that passed
// through bodies (contact/passage/passage.h), the error of contact (accuracy.h), the readings of probes (reading.h).
// A step that is taken back changes none of it.
#ifndef TETLAP_FEM_MEASURE_LEDGER_H
#define TETLAP_FEM_MEASURE_LEDGER_H

#include "contact/passage/passage.h"
#include "fem/measure/accuracy.h"
#include "fem/measure/momentum.h"
#include "fem/measure/reading.h"

typedef struct FemLedger {
  FemSystem *system;      // borrowed
  ContactSystem *contact; // borrowed; NULL: the scene has none
  FemMomentum momentum;
  ContactPassage passage;
  FemAccuracy accuracy;
  FemReadings *readings, *next_readings; //                         (probe_count)
} FemLedger;

// What is measured in a state: contact forces, the elastic energy of all bodies [J], what the probes
// read (probe_count).
typedef struct FemLedgerEntry {
  FemMomentumContact contact;
  double elastic;
  const FemReading *readings;
} FemLedgerEntry;

// A zeroed one, and one whose creation failed, can be destroyed.
Status fem_ledger_create(FemLedger *ledger, FemSystem *system);
void fem_ledger_destroy(FemLedger *ledger);

// A run begins, or goes on, at a state that has been evaluated.
Status fem_ledger_begin(FemLedger *ledger, const FemState *state, const FemLedgerEntry *entry);
// Measures a state at which a step would end; what has been accumulated stays as it is.
Status fem_ledger_end(FemLedger *ledger, const FemState *state, const FemLedgerEntry *entry);
// The step has ended at the state that was measured last: it is accumulated.
void fem_ledger_accept(FemLedger *ledger);

// Into summary.json: `contacts`, a row for each two that touched, and `probes`.
void fem_ledger_record(const FemLedger *ledger, Record *record);
// A message on the pair of that rank by pressure times area, 0 first: what presses, and how large the error
// may be. False: there is no such pair.
bool fem_ledger_describe(const FemLedger *ledger, int rank, char *text, size_t size);

// For a checkpoint: a new array, the caller's; and back. STATUS_INPUT: it does not fit.
Status fem_ledger_save(const FemLedger *ledger, double **values, size_t *count);
Status fem_ledger_load(FemLedger *ledger, const double *values, size_t count);

#endif
