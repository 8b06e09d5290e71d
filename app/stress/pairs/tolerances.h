// SPDX-License-Identifier: GPL-3.0-or-later
// The accuracy of each overlap model on hard pairs, measured over 100 members a class: what `tetlap stress`
// accepts beyond the standard of double precision.
#ifndef TETLAP_APP_STRESS_PAIRS_TOLERANCES_H
#define TETLAP_APP_STRESS_PAIRS_TOLERANCES_H

#include <stdbool.h>

// The measures of a class of pairs; all relative. Volumes to the smaller tetrahedron's volume.
typedef struct AppStressPairErrors {
  double volume;   // |V − exact|
  double bounds;   // how far V leaves [0, smaller volume]
  double balance;  // Σ∇V, Σ x×∇V, Σ x·∇V − 3V, by powers of the extent
  double order;    // V of the tetrahedra and vertices in another order
  double motion;   // V after a rigid motion and after scaling
  double parts;    // V of the parts of one tetrahedron, summed
  double gradient; // ∇V against central differences, by the extent squared, and the pull-back of x̄; smooth
                   // classes only
  double flags;  // share of pairs whose flags contradict the numbers or miss a flat tetrahedron
  double missed; // share of pairs with V above 1e-9 in common that get V = 0, and so ∇V = 0
} AppStressPairErrors;

typedef struct AppStressTolerance {
  const char *model;
  AppStressPairErrors most;
  const char *reason, *counter;
} AppStressTolerance;

// NULL: the model is held to the standard only.
const AppStressTolerance *app_stress_tolerances_find(const char *model);

#endif
