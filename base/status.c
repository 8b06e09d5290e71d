// SPDX-License-Identifier: Apache-2.0
#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { STATUS_MESSAGE_SIZE = 2048 };

static _Thread_local char message[STATUS_MESSAGE_SIZE];

// The last message may be among the arguments.
Status status_fail(Status code, const char *format, ...) {
  char text[STATUS_MESSAGE_SIZE];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  memcpy(message, text, strlen(text) + 1);
  return code;
}

Status status_prefix(Status code, const char *format, ...) {
  char rest[STATUS_MESSAGE_SIZE];
  memcpy(rest, message, sizeof rest);
  va_list args;
  va_start(args, format);
  int used = vsnprintf(message, sizeof message, format, args);
  va_end(args);
  if (used >= 0 && used < STATUS_MESSAGE_SIZE)
    snprintf(message + used, sizeof message - (size_t)used, ": %s", rest);
  return code;
}

Status status_no_memory(const char *what) {
  return status_fail(STATUS_MEMORY,
                     "out of memory: %s did not fit; close other programs or make the problem smaller", what);
}

const char *status_message(void) {
  return message;
}

int status_exit_code(Status status) {
  if (status == STATUS_OK) return 0;
  return status > 0 ? -STATUS_SOLVER : -status;
}
