// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays of a run as text inside a web page: numbers as 16-bit codes, differences from a prediction, bytes
// sorted by weight, deflated, base64. report/src/data/codes.js decodes them.
#ifndef TETLAP_APP_REPORT_CODES_H
#define TETLAP_APP_REPORT_CODES_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/status.h"

enum {
  APP_REPORT_LEVELS = 65534,  // codes 0 … 65534 go from low to high
  APP_REPORT_NO_CODE = 65535, // stands for what is not finite
};

// The ends of the scale on which codes lie. A code stands for low + code/65534 (high − low), so a decoded
// number is off by (high − low)/131068 at most, and by rounding.
typedef struct AppReportScale {
  double low, high;
} AppReportScale;

// The scale of the finite ones of `count` numbers that stand `stride` apart; {0, 0} if there are none.
AppReportScale app_report_codes_scale(const double *values, size_t count, size_t stride);
uint16_t app_report_codes_encode(AppReportScale scale, double value);

// Writes rows (row_count, row_size) of codes as text. Written are differences to the row before and, in the
// first row, to the code `stride` before.
Status app_report_codes_write(FILE *stream, const uint16_t *codes, size_t row_count, size_t row_size,
                              size_t stride);
// Writes whole numbers (count) as text: differences to the number `stride` before.
Status app_report_codes_write_integers(FILE *stream, const int *numbers, size_t count, size_t stride);

#endif
