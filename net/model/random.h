// SPDX-License-Identifier: Apache-2.0
// Seeded random numbers: xoshiro256++ (Blackman and Vigna 2021), its state filled by splitmix64 (Steele, Lea
// and Flood 2014). The state is plain data: a checkpoint stores it and a resumed run draws the same numbers.
#ifndef NET_RANDOM_H
#define NET_RANDOM_H

#include <stdint.h>

typedef struct NetRandom {
  uint64_t state[4];
} NetRandom;

NetRandom net_random_seeded(uint64_t seed, uint64_t stream);
double net_random_uniform(NetRandom *random);                          // [0, 1), 53 bits
double net_random_between(NetRandom *random, double low, double high); // [low, high)
double net_random_normal(NetRandom *random);                           // mean 0, variance 1

// A random order of 0 … count − 1 (Fisher and Yates).
void net_random_shuffle(NetRandom *random, int count, int order[]);

#endif
