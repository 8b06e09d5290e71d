// SPDX-License-Identifier: Apache-2.0
#include "net/model/random.h"

#include <math.h>

static uint64_t splitmix(uint64_t *seed) {
  uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static uint64_t rotate(uint64_t x, int bits) {
  return (x << bits) | (x >> (64 - bits));
}

NetRandom net_random_seeded(uint64_t seed, uint64_t stream) {
  uint64_t stirred = splitmix(&seed) ^ splitmix(&stream) * 0xd1342543de82ef95u;
  NetRandom random;
  for (int k = 0; k < 4; k++) random.state[k] = splitmix(&stirred);
  return random;
}

static uint64_t random_bits(NetRandom *random) {
  uint64_t *s = random->state;
  uint64_t bits = rotate(s[0] + s[3], 23) + s[0];
  uint64_t t = s[1] << 17;
  s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate(s[3], 45);
  return bits;
}

double net_random_uniform(NetRandom *random) {
  return (double)(random_bits(random) >> 11) * 0x1p-53;
}

double net_random_between(NetRandom *random, double low, double high) {
  return low + (high - low) * net_random_uniform(random);
}

// Box and Muller; one of the two numbers is thrown away so that the state stays the four words.
double net_random_normal(NetRandom *random) {
  double radius = sqrt(-2 * log(1 - net_random_uniform(random)));
  return radius * cos(6.283185307179586 * net_random_uniform(random));
}

void net_random_shuffle(NetRandom *random, int count, int order[]) {
  for (int k = 0; k < count; k++) {
    int j = (int)(net_random_uniform(random) * (k + 1));
    order[k] = order[j];
    order[j] = k;
  }
}
