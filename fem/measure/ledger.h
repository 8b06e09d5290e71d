// SPDX-License-Identifier: GPL-3.0-or-later
// What a run keeps account of from one accepted state to the next: momentum's balance (momentum.h) and who
// passed through whom (contact/passage.h). A step that is taken back leaves no trace.
#ifndef TETLAP_FEM_MEASURE_LEDGER_H
#define TETLAP_FEM_MEASURE_LEDGER_H

#include "contact/passage.h"
#include "fem/measure/momentum.h"

typedef struct FemLedger {
  FemSystem *system;      // borrowed
  ContactSystem *contact; // borrowed; NULL: the scene has none
  FemMomentum momentum;
  ContactPassage passage;
} FemLedger;

// A zeroed one, and one whose creation failed, can be destroyed.
Status fem_ledger_create(FemLedger *ledger, FemSystem *system);
void fem_ledger_destroy(FemLedger *ledger);

// As those of momentum.h: a run begins or goes on at the scattered state, which has been evaluated …
Status fem_ledger_begin(FemLedger *ledger, double time, const FemMomentumContact *contact);
// … a step may end there …
Status fem_ledger_end(FemLedger *ledger, double time, const FemMomentumContact *contact);
// … and does.
void fem_ledger_accept(FemLedger *ledger);

// For a checkpoint: a new array, the caller's; and back. STATUS_INPUT: it does not fit.
Status fem_ledger_save(const FemLedger *ledger, double **values, size_t *count);
Status fem_ledger_load(FemLedger *ledger, const double *values, size_t count);

#endif
