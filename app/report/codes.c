// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/codes.h"

#include <math.h>
#include <stdbool.h>

#include "base/files/deflate.h"
#include "base/memory.h"
#include "fem/output/vtk/base64.h"

AppReportScale app_report_codes_scale(const double *values, size_t count, size_t stride) {
  AppReportScale scale = {INFINITY, -INFINITY};
  for (size_t i = 0; i < count; i++) {
    double value = values[i * stride];
    if (!isfinite(value)) continue;
    scale.low = fmin(scale.low, value);
    scale.high = fmax(scale.high, value);
  }
  return scale.low <= scale.high ? scale : (AppReportScale){0, 0};
}

uint16_t app_report_codes_encode(AppReportScale scale, double value) {
  if (!isfinite(value)) return APP_REPORT_NO_CODE;
  double width = scale.high - scale.low;
  if (!(width > 0)) return 0;
  double place = (value - scale.low) / width;
  return (uint16_t)lround(fmin(fmax(place, 0), 1) * APP_REPORT_LEVELS);
}

// Deflates and writes.
static Status write_packed(FILE *stream, const unsigned char *bytes, size_t byte_count) {
  size_t packed_count;
  unsigned char *packed = memory_zeroed(deflate_bound(byte_count), 1);
  bool ok = packed && deflate_pack(packed, &packed_count, bytes, byte_count, DEFLATE_SMALL);
  if (ok) {
    FemBase64 text = {.stream = stream};
    fem_base64_write(&text, packed, packed_count);
    fem_base64_end(&text);
  }
  memory_free(packed);
  return ok ? STATUS_OK : status_no_memory("an array of the page");
}

// Small differences of either sign become small whole numbers: 0, −1, 1, −2 … become 0, 1, 2, 3 …
static uint16_t fold16(uint16_t difference) {
  return (uint16_t)(difference & 0x8000 ? ~(difference << 1) : difference << 1);
}
static uint32_t fold32(uint32_t difference) {
  return difference & 0x80000000U ? ~(difference << 1) : difference << 1;
}

Status app_report_codes_write(FILE *stream, const uint16_t *codes, size_t row_count, size_t row_size,
                              size_t stride) {
  const size_t count = row_count * row_size;
  unsigned char *bytes = memory_zeroed(count, 2);
  if (!bytes) return status_no_memory("an array of the page");
  for (size_t i = 0; i < count; i++) {
    const size_t back = i < row_size ? stride : row_size;
    uint16_t folded = fold16((uint16_t)(codes[i] - (i < back ? 0 : codes[i - back])));
    bytes[i] = (unsigned char)folded;
    bytes[count + i] = (unsigned char)(folded >> 8);
  }
  Status status = write_packed(stream, bytes, 2 * count);
  memory_free(bytes);
  return status;
}

Status app_report_codes_write_integers(FILE *stream, const int *numbers, size_t count, size_t stride) {
  unsigned char *bytes = memory_zeroed(count, 4);
  if (!bytes) return status_no_memory("an array of the page");
  for (size_t i = 0; i < count; i++) {
    uint32_t folded = fold32((uint32_t)numbers[i] - (i < stride ? 0 : (uint32_t)numbers[i - stride]));
    for (size_t plane = 0; plane < 4; plane++)
      bytes[plane * count + i] = (unsigned char)(folded >> (8 * plane));
  }
  Status status = write_packed(stream, bytes, 4 * count);
  memory_free(bytes);
  return status;
}
