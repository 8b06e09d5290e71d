// SPDX-License-Identifier: Apache-2.0
// A digest of contents: detects accidental changes, not forgery.
#ifndef TETLAP_BASE_FILES_DIGEST_H
#define TETLAP_BASE_FILES_DIGEST_H

#include <stddef.h>
#include <stdint.h>

enum { DIGEST_TEXT = 17 };

extern const uint64_t DIGEST_START;

// FNV-1a of 64 bits (Fowler, Noll, Vo) of what `digest` has seen, followed by `size` bytes. Two contents of
// one size that differ in one byte always have different digests.
uint64_t digest_bytes(uint64_t digest, const void *bytes, size_t size);

// As 16 hexadecimal digits.
void digest_print(uint64_t digest, char text[DIGEST_TEXT]);

#endif
