// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/verdict.h"

#include <math.h>

#include "fem/model/limits.h"

static FemCause cause_of(const FemFindings *findings) {
  if (!findings->is_evaluated) return FEM_CAUSE_FORCES;
  if (findings->gains_energy) return FEM_CAUSE_ENERGY;
  if (findings->differs_from_motion) return FEM_CAUSE_MOMENTUM;
  return findings->reversed <= FEM_ENERGY_REVERSED ? FEM_CAUSE_NONE : FEM_CAUSE_REVERSAL;
}

// The shortest step that is tried for a cause [s].
static double least_of(const FemFindings *findings, FemCause cause) {
  if (cause == FEM_CAUSE_FORCES) return findings->shortest;
  return fmax(findings->shortest, cause == FEM_CAUSE_ENERGY ? findings->rebound : findings->resolved);
}

FemVerdict fem_verdict_of(const FemFindings *findings) {
  const FemCause cause = cause_of(findings);
  double step = fmax(FEM_CUT * findings->length, least_of(findings, cause));
  if (cause == FEM_CAUSE_NONE || !(step < findings->length)) step = 0;
  bool may_stand = cause != FEM_CAUSE_FORCES;
  return (FemVerdict){.stands = may_stand && step == 0, .cause = cause, .step = step};
}

const char *fem_verdict_words(FemCause cause) {
  static const char *const words[] = {"", "its forces cannot be evaluated", "it gains energy",
                                      "forces and motion differ",
                                      "friction acts along the slip that has reversed"};
  return words[cause];
}
