// SPDX-License-Identifier: Apache-2.0
#include "base/memory.h"

#include <malloc.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

// From this size on an array gets memory of its own, large enough to be cleared in no time. Arrays below it
// share the heap, which keeps its pages up to twice as much: what is freed and asked for again, as lists and
// factors are, would get each page anew, which takes longer than to use it. [bytes]
enum { LARGE = 4 << 20 };

static atomic_long fail_countdown;

static int fails_now(void) {
  return atomic_load(&fail_countdown) > 0 && atomic_fetch_sub(&fail_countdown, 1) == 1;
}

void *memory_zeroed(size_t count, size_t size) {
  if (fails_now()) return NULL;
  return calloc(count ? count : 1, size);
}

void *memory_copy(const void *source, size_t count, size_t size) {
  void *copy = memory_zeroed(count, size);
  if (copy && count) memcpy(copy, source, count * size);
  return copy;
}

// Into zeroed memory, pages of zeros left out: what an array does not use takes no memory.
static void copy_used(char *to, const char *from, size_t bytes) {
  enum { PAGE = 4096 };
  static const char zeros[PAGE];
  for (size_t begin = 0; begin < bytes; begin += PAGE) {
    size_t count = bytes - begin < PAGE ? bytes - begin : PAGE;
    if (memcmp(from + begin, zeros, count) != 0) memcpy(to + begin, from + begin, count);
  }
}

// NULL if it does not fit; else the old one is gone.
static void *grow(void *array, size_t old_bytes, size_t bytes) {
  if (bytes < LARGE) {
    char *larger = realloc(array, bytes);
    if (larger) memset(larger + old_bytes, 0, bytes - old_bytes);
    return larger;
  }
  char *larger = calloc(1, bytes);
  if (!larger) return NULL;
  if (array) copy_used(larger, array, old_bytes);
  free(array);
  return larger;
}

int memory_reserve(void **array, size_t *capacity, size_t wanted, size_t size) {
  if (wanted <= *capacity && *array) return 1;
  size_t grown = *capacity + *capacity / 2 + 8;
  if (grown < wanted) grown = wanted;
  if (fails_now() || grown > SIZE_MAX / size) return 0;
  void *larger = grow(*array, *capacity * size, grown * size);
  if (!larger) return 0;
  *array = larger;
  *capacity = grown;
  return 1;
}

void memory_free(void *array) {
  free(array);
}

size_t memory_held(const void *array) {
  return malloc_usable_size((void *)(uintptr_t)array);
}

size_t memory_held_by(size_t count, const void *const *arrays) {
  size_t sum = 0;
  for (size_t k = 0; k < count; k++) sum += memory_held(arrays[k]);
  return sum;
}

void memory_trim(void) {
  malloc_trim(0);
}

void memory_separate(void) {
  enum { MAPS = 65536 }; // the C library's own number
  mallopt(M_MMAP_MAX, MAPS);
  mallopt(M_MMAP_THRESHOLD, LARGE);
  mallopt(M_TRIM_THRESHOLD, 2 * LARGE);
}

void memory_fail_at(long k) {
  atomic_store(&fail_countdown, k);
}

size_t memory_peak_bytes(void) {
  struct rusage usage;
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  return (size_t)usage.ru_maxrss * 1024;
}
