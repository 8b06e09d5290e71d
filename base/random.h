// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded random numbers: xoshiro256++ (Blackman and Vigna 2021), its state filled by splitmix64. A stream per
// index makes results independent of the number of threads.
#ifndef TETLAP_BASE_RANDOM_H
#define TETLAP_BASE_RANDOM_H

#include <stdint.h>

typedef struct Random {
  uint64_t state[4];
} Random;

Random random_seeded(uint64_t seed, uint64_t stream);
uint64_t random_bits(Random *random);
double random_uniform(Random *random);                          // [0, 1), 53 bits
double random_between(Random *random, double low, double high); // [low, high)
int random_below(Random *random, int count);                    // 0 … count − 1
void random_direction(Random *random, double direction[3]);     // uniform on the unit sphere
void random_rotation(Random *random, double rotation[9]);       // uniform in SO(3), row-major

#endif
