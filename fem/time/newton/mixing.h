// SPDX-License-Identifier: GPL-3.0-or-later
// Anderson's mixing of the steps of an iteration (D. G. Anderson, J. ACM 12 (1965) 547; H. F. Walker and P.
// Ni, SIAM J. Numer. Anal. 49 (2011) 1715), of depth two at most.
//
// An iteration x ← x + d(x) whose matrix is old, or incomplete (friction's coupling of slip and pressure is
// left out), converges slowly or oscillates. With Δx_j the steps taken and Δd_j the changes of d that they
// brought,
//     γ = argmin ‖d − Σ γ_j Δd_j‖,     step = d − Σ γ_j (Δx_j + Δd_j)
// which is what GMRES would do where d is linear. The norm is that of the error weights.
#ifndef TETLAP_FEM_TIME_NEWTON_MIXING_H
#define TETLAP_FEM_TIME_NEWTON_MIXING_H

#include <stdbool.h>

#include "base/status.h"

enum { FEM_MIXING_DEPTH = 2 };

typedef struct FemMixing {
  int n;
  int count;                         // pairs (Δx, Δd), the newest first
  double *steps[FEM_MIXING_DEPTH];   // Δx                         (n)
  double *changes[FEM_MIXING_DEPTH]; // Δd                         (n)
  double *last, *taken;              // d of the last iteration, and the step it led to   (n)
  bool has_last;
} FemMixing;

Status fem_mixing_create(FemMixing *mixing, int n);
void fem_mixing_destroy(FemMixing *mixing);

// Another iteration begins.
void fem_mixing_forget(FemMixing *mixing);

// Keeps the direction d as it is for later, without mixing it.
void fem_mixing_note(FemMixing *mixing, const double *d);

// From d to the step, in place. `weights` as in the norm (n).
void fem_mixing_mix(FemMixing *mixing, const double *weights, double *d);

// `share` of that step was taken.
void fem_mixing_take(FemMixing *mixing, double share, const double *step);

#endif
