/* SPDX-License-Identifier: Apache-2.0 */
/* A model in a process of its own, in C: the protocol at the head of overlap/foreign/process.h. The volume is a sixth of
 * the one that the bounding boxes share.
 *   cc -O2 examples/models/serve.c -o serve -I include
 *   tetlap run examples/02_two_blocks.yaml --overlap exec:./serve */
#define _GNU_SOURCE /* mremap */
#include <stdint.h>
#include <sys/mman.h>
#include <tetlap/model.h>
#include <unistd.h>

enum { SOCKET = 3, MEMORY = 4, PAIR_BYTES = 432 };

static double low_of(const double *tet, int c) {
  double low = tet[c];
  for (int v = 1; v < 4; v++) low = tet[3 * v + c] < low ? tet[3 * v + c] : low;
  return low;
}

static double high_of(const double *tet, int c) {
  double high = tet[c];
  for (int v = 1; v < 4; v++) high = tet[3 * v + c] > high ? tet[3 * v + c] : high;
  return high;
}

static void answer(const double *pair, double *volume, double *centroid) {
  *volume = 1.0 / 6;
  for (int c = 0; c < 3; c++) {
    const double a = low_of(pair, c), b = low_of(pair + 12, c), e = high_of(pair, c), f = high_of(pair + 12, c);
    const double low = a > b ? a : b, high = e < f ? e : f;
    *volume *= high > low ? high - low : 0;
    centroid[c] = (low + high) / 2;
  }
}

int main(void) {
  static const char name[] = "boxes";
  uint64_t request[4], capacity = 0;
  char *map = NULL;
  while (read(SOCKET, request, sizeof request) == sizeof request) { /* what, count, capacity, wants */
    const int is_greeting = request[0] == 1;
    if (request[2] != capacity) {
      map = map ? mremap(map, capacity * PAIR_BYTES, request[2] * PAIR_BYTES, MREMAP_MAYMOVE)
                : mmap(NULL, request[2] * PAIR_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, MEMORY, 0);
      if (map == MAP_FAILED) return 1;
      capacity = request[2];
    }
    const double *pairs = (const double *)map;
    double *volumes = (double *)(map + 192 * capacity), *centroids = (double *)(map + 392 * capacity);
    for (uint64_t i = 0; !is_greeting && i < request[1]; i++) answer(pairs + 24 * i, volumes + i, centroids + 3 * i);
    const uint64_t reply[4] = {0, is_greeting ? sizeof name - 1 : 0, TETLAP_MODEL_CENTROID, 0};
    if (write(SOCKET, reply, sizeof reply) != sizeof reply) return 1;
    if (is_greeting && write(SOCKET, name, sizeof name - 1) != sizeof name - 1) return 1;
  }
  return 0;
}
