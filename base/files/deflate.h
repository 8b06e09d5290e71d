// SPDX-License-Identifier: GPL-3.0-or-later
// Compression and decompression in zlib's format (RFC 1950), which browsers and VTK read too. The one place
// where zlib is used.
#ifndef TETLAP_BASE_FILES_DEFLATE_H
#define TETLAP_BASE_FILES_DEFLATE_H

#include <stdbool.h>
#include <stddef.h>

typedef enum DeflateEffort {
  DEFLATE_FAST,
  DEFLATE_SMALL,
} DeflateEffort;

// The room that `byte_count` bytes need in the worst case.
size_t deflate_bound(size_t byte_count);

// Packs into `target`, whose room is at least deflate_bound(byte_count) bytes; `*packed_count` says how many
// were used. False: no memory, the only way in which it can fail.
bool deflate_pack(void *target, size_t *packed_count, const void *bytes, size_t byte_count,
                  DeflateEffort effort);

// Unpacks exactly `byte_count` bytes. False: `packed` is not such a stream, or not of that length.
bool deflate_unpack(void *bytes, size_t byte_count, const void *packed, size_t packed_count);

#endif
