// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/base64.h"

#include <string.h>

enum { GROUPS = 1024 }; // encoded before the stream is called

static void encode(const unsigned char bytes[3], char group[4]) {
  static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  group[0] = alphabet[bytes[0] >> 2];
  group[1] = alphabet[(bytes[0] & 3) << 4 | bytes[1] >> 4];
  group[2] = alphabet[(bytes[1] & 15) << 2 | bytes[2] >> 6];
  group[3] = alphabet[bytes[2] & 63];
}

static void write_groups(FILE *stream, const unsigned char *bytes, size_t group_count) {
  char text[4 * GROUPS];
  while (group_count > 0) {
    size_t part = group_count < GROUPS ? group_count : GROUPS;
    for (size_t g = 0; g < part; g++) encode(bytes + 3 * g, text + 4 * g);
    fwrite(text, 4, part, stream);
    bytes += 3 * part;
    group_count -= part;
  }
}

void fem_base64_write(FemBase64 *text, const void *bytes, size_t count) {
  const unsigned char *next = bytes;
  while (count > 0 && text->waiting_count > 0) {
    text->waiting[text->waiting_count++] = *next++;
    count--;
    if (text->waiting_count < 3) continue;
    write_groups(text->stream, text->waiting, 1);
    text->waiting_count = 0;
  }
  write_groups(text->stream, next, count / 3);
  if (count % 3 == 0) return; // what waits, waits on
  text->waiting_count = (int)(count % 3);
  memcpy(text->waiting, next + count / 3 * 3, count % 3);
}

void fem_base64_end(FemBase64 *text) {
  if (text->waiting_count == 0) return;
  char group[4];
  memset(text->waiting + text->waiting_count, 0, 3 - (size_t)text->waiting_count);
  encode(text->waiting, group);
  if (text->waiting_count == 1) group[2] = '=';
  group[3] = '=';
  fwrite(group, 1, 4, text->stream);
  text->waiting_count = 0;
}

static int value_of(char letter) {
  if (letter >= 'A' && letter <= 'Z') return letter - 'A';
  if (letter >= 'a' && letter <= 'z') return letter - 'a' + 26;
  if (letter >= '0' && letter <= '9') return letter - '0' + 52;
  return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

const char *fem_base64_read(const char *text, const char *end, void *bytes, size_t count) {
  unsigned char *next = bytes;
  if ((size_t)(end - text) / 4 < count / 3 + (count % 3 != 0)) return NULL;
  for (; count > 0; text += 4) {
    size_t part = count < 3 ? count : 3;
    int group = 0;
    for (size_t k = 0; k < 4; k++) {
      int value = k <= part ? value_of(text[k]) : 0;
      if (value < 0) return NULL;
      group = group << 6 | value;
    }
    for (size_t k = 0; k < part; k++) *next++ = (unsigned char)(group >> (16 - 8 * k));
    count -= part;
  }
  return text;
}
