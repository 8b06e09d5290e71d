// SPDX-License-Identifier: GPL-3.0-or-later
// The property that makes a class of pairs hard, proven for every member, so that the case did occur.
#ifndef TETLAP_APP_STRESS_PAIRS_TRAITS_H
#define TETLAP_APP_STRESS_PAIRS_TRAITS_H

#include <stdbool.h>

#include "datagen/hard.h"

// Whether the pair is what its class (datagen/hard.h) is named after: touching, coplanar and nested by exact
// proof, slivers, scales and orientations by their numbers. False for a class that has no line here.
bool app_stress_traits_hold(int class_index, const DatagenHardPair *pair);

#endif
