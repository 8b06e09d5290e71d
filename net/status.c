// SPDX-License-Identifier: Apache-2.0
#include "net/status.h"

#include <stdarg.h>
#include <stdio.h>

static _Thread_local char message[512];

NetStatus net_status_fail(NetStatus code, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  return code;
}

NetStatus net_status_no_memory(const char *what) {
  return net_status_fail(NET_NO_MEMORY, "no memory for %s", what);
}

const char *net_status_message(void) {
  return message;
}
