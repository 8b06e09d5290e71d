// SPDX-License-Identifier: GPL-3.0-or-later
// Which pair stands at which index of a data set. Pair i is a function of the plan and of i alone: its kind
// is that of place π(i) when all pairs are laid out kind by kind, π a permutation of 0 … count − 1 made of
// the seed; its coordinates come from a random stream of its own. So any range can be made by itself, by any
// number of threads, and the counts of the kinds are exactly the mix.
#ifndef TETLAP_DATAGEN_LAW_PLAN_H
#define TETLAP_DATAGEN_LAW_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "datagen/law/law.h"

// Raised whenever the same plan gives other pairs.
enum { DATAGEN_GENERATOR_VERSION = 1 };

typedef enum DatagenLabel {
  DATAGEN_LABEL_EXACT, // overlap/exact/exact.h
  DATAGEN_LABEL_CLIP,  // overlap/clip/clip.h; what it flags, and what it finds empty against the proof, by
                       // exact
} DatagenLabel;

typedef struct DatagenPlan {
  DatagenLaw law;
  DatagenVolumeSieve sieve;
  uint64_t seed;
  long long count;                           // of the whole data set
  long long kind_counts[DATAGEN_KIND_COUNT]; // of the whole
  DatagenLabel label;                        // what V, and ∇V if wanted, are computed with
  bool wants_gradient;
} DatagenPlan;

// STATUS_USAGE: a count below 1 or above 2^40, a volume law that cannot be met (where the mix needs one), a
// swap share outside [0, 1].
Status datagen_plan_make(DatagenPlan *plan, const DatagenLaw *law, uint64_t seed, long long count);

DatagenKind datagen_plan_kind(const DatagenPlan *plan, long long index);

// The range of shard i of n, i from 1: all shards together are the whole, in order.
void datagen_plan_shard(const DatagenPlan *plan, int shard, int shard_count, long long *first,
                        long long *count);

const char *datagen_plan_label_name(DatagenLabel label);

#endif
