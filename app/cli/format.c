// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/format.h"

#include <math.h>
#include <stdio.h>

#include "app/cli/versions.h"

void app_format_record(Record *record) {
  record_integer(record, "format", APP_FORMAT);
}

Status app_format_check(const Record *record, const char *directory, const char *name, const char *program) {
  if (!record) return STATUS_OK;
  double format = record_find_number(record, "format");
  if (format == APP_FORMAT) return STATUS_OK;
  char found[64], writer[96] = "an unknown program";
  if (isfinite(format))
    snprintf(found, sizeof found, "is of format %.15g", format);
  else
    snprintf(found, sizeof found, "has no format number, so it is older than format %d", APP_FORMAT);
  if (program) snprintf(writer, sizeof writer, "tetlap %s", program);
  return status_fail(
      STATUS_INPUT,
      "%s/%s: %s; it was written by %s. This program, tetlap %s, reads format %d: use the program that "
      "wrote the file, or run the scene again",
      directory, name, found, writer, app_versions_program(), APP_FORMAT);
}
