// SPDX-License-Identifier: Apache-2.0
#include "base/files/digest.h"

#include <inttypes.h>
#include <stdio.h>

const uint64_t DIGEST_START = UINT64_C(14695981039346656037);
static const uint64_t PRIME = UINT64_C(1099511628211);

uint64_t digest_bytes(uint64_t digest, const void *bytes, size_t size) {
  const unsigned char *next = bytes;
  for (size_t i = 0; i < size; i++) digest = (digest ^ next[i]) * PRIME;
  return digest;
}

void digest_print(uint64_t digest, char text[DIGEST_TEXT]) {
  snprintf(text, DIGEST_TEXT, "%016" PRIx64, digest);
}
