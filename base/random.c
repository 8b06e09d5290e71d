// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.h"

#include <math.h>

static uint64_t splitmix(uint64_t *x) {
  uint64_t z = (*x += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

Random random_seeded(uint64_t seed, uint64_t stream) {
  uint64_t x = seed;
  x = splitmix(&x) ^ (stream * 0xd1342543de82ef95u);
  Random random;
  for (int i = 0; i < 4; i++) random.state[i] = splitmix(&x);
  return random;
}

static uint64_t rotate_left(uint64_t x, int k) {
  return (x << k) | (x >> (64 - k));
}

uint64_t random_bits(Random *random) {
  uint64_t *s = random->state;
  uint64_t result = rotate_left(s[0] + s[3], 23) + s[0];
  uint64_t t = s[1] << 17;
  s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate_left(s[3], 45);
  return result;
}

double random_uniform(Random *random) {
  return (double)(random_bits(random) >> 11) * 0x1p-53;
}

double random_between(Random *random, double low, double high) {
  return low + (high - low) * random_uniform(random);
}

int random_below(Random *random, int count) {
  return (int)(random_uniform(random) * count);
}

void random_direction(Random *random, double direction[3]) {
  double z = random_between(random, -1, 1), angle = random_between(random, 0, 6.283185307179586);
  double r = sqrt(1 - z * z);
  direction[0] = r * cos(angle), direction[1] = r * sin(angle), direction[2] = z;
}

// A uniform unit quaternion (Shoemake 1992) as a matrix.
void random_rotation(Random *random, double rotation[9]) {
  double u = random_uniform(random), a = 6.283185307179586 * random_uniform(random);
  double b = 6.283185307179586 * random_uniform(random);
  double w = sqrt(1 - u) * sin(a), x = sqrt(1 - u) * cos(a), y = sqrt(u) * sin(b), z = sqrt(u) * cos(b);
  double matrix[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                      2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                      2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  for (int i = 0; i < 9; i++) rotation[i] = matrix[i];
}
