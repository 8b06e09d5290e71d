// SPDX-License-Identifier: GPL-3.0-or-later
// The functions of GNU libmicrohttpd that the server calls, loaded when it starts: the program is not linked
// to it, so other commands start without it and its dependencies.
#ifndef TETLAP_APP_VIEW_LIBRARY_H
#define TETLAP_APP_VIEW_LIBRARY_H

#include <microhttpd.h>

#include "base/status.h"

// Names without their "MHD_".
#define APP_VIEW_FUNCTIONS(FUNCTION)                                                                         \
  FUNCTION(add_response_header)                                                                              \
  FUNCTION(create_response_from_buffer)                                                                      \
  FUNCTION(destroy_response)                                                                                 \
  FUNCTION(get_daemon_info)                                                                                  \
  FUNCTION(lookup_connection_value)                                                                          \
  FUNCTION(queue_response)                                                                                   \
  FUNCTION(start_daemon)                                                                                     \
  FUNCTION(stop_daemon)

typedef struct AppViewLibrary {
#define APP_VIEW_FIELD(name) __typeof__(MHD_##name) *name;
  APP_VIEW_FUNCTIONS(APP_VIEW_FIELD)
#undef APP_VIEW_FIELD
} AppViewLibrary;

// The library stays loaded until the process ends. STATUS_IO: it is not installed; the message names the
// package.
Status app_view_library_load(AppViewLibrary *library);

#endif
