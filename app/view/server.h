// SPDX-License-Identifier: GPL-3.0-or-later
// A server of two things on the loopback address, the page about a run (/) and how far it is (/state), and
// of nothing else: no path leads to a file. A request must come from this machine and not from another
// site's page. It must name this machine as its host, so that a foreign name that was made to point here
// finds nothing (DNS rebinding).
#ifndef TETLAP_APP_VIEW_SERVER_H
#define TETLAP_APP_VIEW_SERVER_H

#include <stdbool.h>

#include "app/view/folder.h"
#include "app/view/library.h"

typedef struct AppViewServer {
  AppViewLibrary library;
  AppViewFolder folder;
  struct MHD_Daemon *daemon;
  int port;
} AppViewServer;

// Starts; answers come from a thread of its own. `port` 0: one that is free. STATUS_IO: the library is
// missing, or the port cannot be had.
Status app_view_server_start(AppViewServer *server, const AppViewFolder *folder, int port);
// Whether a request's header `Host` (NULL: none) names the server at this port.
bool app_view_server_is_own_host(const char *host, int port);

void app_view_server_stop(AppViewServer *server); // also one that did not start

#endif
