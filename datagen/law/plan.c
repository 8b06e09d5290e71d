// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/law/plan.h"

#include "base/random.h"

static const long long MOST_PAIRS = 1LL << 40;
enum { ROUNDS = 4 };

const char *datagen_plan_label_name(DatagenLabel label) {
  return label == DATAGEN_LABEL_CLIP ? "clip" : "exact";
}

Status datagen_plan_make(DatagenPlan *plan, const DatagenLaw *law, uint64_t seed, long long count) {
  *plan = (DatagenPlan){.law = *law, .seed = seed, .count = count};
  if (!(count >= 1 && count <= MOST_PAIRS))
    return status_fail(STATUS_USAGE, "%lld pairs cannot be made; give a number from 1 to %lld", count,
                       MOST_PAIRS);
  if (!(law->swap_share >= 0 && law->swap_share <= 1))
    return status_fail(STATUS_USAGE, "the share of swapped pairs is %g; give a number from 0 to 1",
                       law->swap_share);
  if (law->mix[DATAGEN_VOLUMETRIC] > 0) TRY(datagen_volume_law_sieve_make(&plan->sieve, &law->volume));
  datagen_law_divide(law->mix, count, plan->kind_counts);
  return STATUS_OK;
}

// A Feistel network (Luby and Rackoff 1988) on numbers of 2 · half_bits bits: a permutation whatever the
// round function is.
static uint64_t permute_bits(uint64_t seed, uint64_t number, int half_bits) {
  const uint64_t mask = ((uint64_t)1 << half_bits) - 1;
  uint64_t left = number >> half_bits, right = number & mask;
  for (uint64_t round = 0; round < ROUNDS; round++) {
    Random random = random_seeded(~seed, right << 8 | round);
    const uint64_t next = (left ^ random_bits(&random)) & mask;
    left = right, right = next;
  }
  return left << half_bits | right;
}

// Applied again until the result is in range: still a permutation, after four rounds or less on average.
static long long permute(const DatagenPlan *plan, long long index) {
  int half_bits = 1;
  while ((long long)1 << 2 * half_bits < plan->count) half_bits++;
  uint64_t number = (uint64_t)index;
  do number = permute_bits(plan->seed, number, half_bits);
  while (number >= (uint64_t)plan->count);
  return (long long)number;
}

DatagenKind datagen_plan_kind(const DatagenPlan *plan, long long index) {
  long long place = permute(plan, index);
  int kind = 0;
  while (place >= plan->kind_counts[kind]) place -= plan->kind_counts[kind++];
  return (DatagenKind)kind;
}

void datagen_plan_shard(const DatagenPlan *plan, int shard, int shard_count, long long *first,
                        long long *count) {
  const long long size = plan->count / shard_count, rest = plan->count % shard_count, before = shard - 1;
  *first = before * size + (before < rest ? before : rest);
  *count = size + (before < rest);
}
