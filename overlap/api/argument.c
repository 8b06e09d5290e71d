// SPDX-License-Identifier: Apache-2.0
#include "overlap/api/argument.h"

#include <string.h>
#include <tetlap/overlap.h>

Status overlap_api_argument_copy(void *ours, size_t size, size_t first_size, const void *theirs,
                                 const char *name) {
  size_t given;
  if (!theirs) return status_fail(STATUS_INPUT, "%s is NULL", name);
  memcpy(&given, theirs, sizeof given);
  if (given < first_size)
    return status_fail(STATUS_INPUT, "%s: its size is %zu, at least %zu are expected; begin with %s_INIT",
                       name, given, first_size, "TETLAP_OVERLAP_…");
  for (size_t at = size; at < given; at++)
    if (((const char *)theirs)[at] != 0)
      return status_fail(
          STATUS_INPUT,
          "%s: it has %zu bytes, this library knows %zu, and a field set beyond that needs a later library",
          name, given, size);
  memset(ours, 0, size);
  memcpy(ours, theirs, given < size ? given : size);
  return STATUS_OK;
}

int overlap_api_argument_status(Status status) {
  switch (status) {
  case STATUS_OK:
    return TETLAP_OVERLAP_OK;
  case STATUS_USAGE:
  case STATUS_INPUT:
    return TETLAP_OVERLAP_INVALID;
  case STATUS_IO:
    return TETLAP_OVERLAP_NO_FILE;
  case STATUS_MEMORY:
    return TETLAP_OVERLAP_MEMORY;
  default:
    return TETLAP_OVERLAP_INTERNAL;
  }
}
