// SPDX-License-Identifier: Apache-2.0
#include "net/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static long fail_at;

void net_memory_fail_at(long k) {
  fail_at = k;
}

void *net_memory_zeroed(size_t count, size_t size) {
  if (fail_at > 0 && --fail_at == 0) return NULL;
  if (size && count > (SIZE_MAX - NET_MEMORY_ALIGNMENT) / size) return NULL;
  size_t bytes = (count * size / NET_MEMORY_ALIGNMENT + 1) * NET_MEMORY_ALIGNMENT;
  void *array = aligned_alloc(NET_MEMORY_ALIGNMENT, bytes);
  if (array) memset(array, 0, bytes);
  return array;
}

char *net_memory_text(const char *text) {
  size_t length = strlen(text) + 1;
  char *copy = net_memory_zeroed(length, 1);
  if (copy) memcpy(copy, text, length);
  return copy;
}

void net_memory_free(void *array) {
  free(array);
}
