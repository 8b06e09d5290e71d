// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes as text in the base64 alphabet of RFC 4648: written to a stream piece by piece, and read back.
#ifndef TETLAP_FEM_OUTPUT_VTK_BASE64_H
#define TETLAP_FEM_OUTPUT_VTK_BASE64_H

#include <stddef.h>
#include <stdio.h>

// One run of text; begins zeroed but for the stream.
typedef struct FemBase64 {
  FILE *stream;             // borrowed; its error flag is set after a failure
  unsigned char waiting[3]; // bytes that do not fill a group of four characters yet
  int waiting_count;
} FemBase64;

// The text does not depend on how the bytes are cut into pieces.
void fem_base64_write(FemBase64 *text, const void *bytes, size_t count);
// Pads the last group; the next write begins a text of its own.
void fem_base64_end(FemBase64 *text);

// Reads `count` bytes from the beginning of a text that ends at `end`. Returns the place after the group of
// four that the last byte is in, NULL if there is no such text.
const char *fem_base64_read(const char *text, const char *end, void *bytes, size_t count);

#endif
