// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/files/deflate.h"

#include <zlib.h>

size_t deflate_bound(size_t byte_count) {
  return compressBound((uLong)byte_count);
}

bool deflate_pack(void *target, size_t *packed_count, const void *bytes, size_t byte_count,
                  DeflateEffort effort) {
  uLongf length = deflate_bound(byte_count);
  int level = effort == DEFLATE_SMALL ? Z_BEST_COMPRESSION : Z_BEST_SPEED;
  int result = compress2(target, &length, bytes, (uLong)byte_count, level);
  *packed_count = length;
  return result == Z_OK;
}

bool deflate_unpack(void *bytes, size_t byte_count, const void *packed, size_t packed_count) {
  uLongf length = (uLongf)byte_count;
  return uncompress(bytes, &length, packed, (uLong)packed_count) == Z_OK && length == byte_count;
}
