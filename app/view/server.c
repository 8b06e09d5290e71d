// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/view/server.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/files/confine.h"

static const char *header_of(const AppViewServer *server, struct MHD_Connection *connection,
                             const char *name) {
  return server->library.lookup_connection_value(connection, MHD_HEADER_KIND, name);
}

bool app_view_server_is_own_host(const char *host, int port) {
  static const char *const hosts[] = {"127.0.0.1", "localhost"};
  enum { DEFAULT_PORT = 80 }; // of http: browsers leave it out
  char own[32];
  for (int k = 0; host && k < 2; k++) {
    snprintf(own, sizeof own, "%s:%d", hosts[k], port);
    if (strcmp(host, own) == 0 || (port == DEFAULT_PORT && strcmp(host, hosts[k]) == 0)) return true;
  }
  return false;
}

// Whether a page of another site asks: browsers say so. To follow a link from there is fine.
static bool is_foreign(const AppViewServer *server, struct MHD_Connection *connection) {
  const char *site = header_of(server, connection, "Sec-Fetch-Site"),
             *mode = header_of(server, connection, "Sec-Fetch-Mode");
  if (!site || strcmp(site, "same-origin") == 0 || strcmp(site, "none") == 0) return false;
  return !mode || strcmp(mode, "navigate") != 0;
}

// The reply takes `text` over, which malloc gave; headers keep it where it belongs.
static enum MHD_Result reply(const AppViewServer *server, struct MHD_Connection *connection,
                             unsigned int code, const char *type, char *text, size_t size) {
  static const char *const headers[][2] = {
      {"Cache-Control", "no-store"},
      {"X-Content-Type-Options", "nosniff"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Content-Security-Policy", "frame-ancestors 'none'"},
      {"Referrer-Policy", "no-referrer"},
  };
  const AppViewLibrary *library = &server->library;
  struct MHD_Response *response = library->create_response_from_buffer(size, text, MHD_RESPMEM_MUST_FREE);
  if (!response) {
    free(text);
    return MHD_NO;
  }
  library->add_response_header(response, "Content-Type", type);
  for (size_t k = 0; k < sizeof headers / sizeof *headers; k++)
    library->add_response_header(response, headers[k][0], headers[k][1]);
  enum MHD_Result result = library->queue_response(connection, code, response);
  library->destroy_response(response);
  return result;
}

static enum MHD_Result refuse(const AppViewServer *server, struct MHD_Connection *connection,
                              unsigned int code, const char *why) {
  char *text = strdup(why);
  return text ? reply(server, connection, code, "text/plain; charset=utf-8", text, strlen(text)) : MHD_NO;
}

static unsigned int code_of(AppViewRefusal refusal) {
  switch (refusal) {
  case APP_VIEW_MISSING:
    return MHD_HTTP_NOT_FOUND;
  case APP_VIEW_FORBIDDEN:
    return MHD_HTTP_FORBIDDEN;
  default:
    return MHD_HTTP_INTERNAL_SERVER_ERROR;
  }
}

// What has failed when it was read: something that is not to be read, or else something that is broken.
static enum MHD_Result fail(const AppViewServer *server, struct MHD_Connection *connection) {
  return refuse(server, connection, code_of(confine_has_refused() ? APP_VIEW_FORBIDDEN : APP_VIEW_ALLOWED),
                status_message());
}

static enum MHD_Result send_state(const AppViewServer *server, struct MHD_Connection *connection) {
  Record *state;
  char *text = NULL;
  size_t size = 0;
  Status status = app_view_folder_state(&server->folder, &state);
  FILE *stream = status ? NULL : open_memstream(&text, &size);
  if (!status) status = stream ? record_print_line(state, stream) : status_no_memory("the state");
  if (stream) fclose(stream);
  record_destroy(state);
  if (!status) return reply(server, connection, MHD_HTTP_OK, "application/json", text, size);
  free(text);
  return fail(server, connection);
}

// What is written just now may not fit together, so it is read again before that is reported.
static enum MHD_Result send_page(const AppViewServer *server, struct MHD_Connection *connection) {
  static const struct timespec pause = {.tv_nsec = 100 * 1000 * 1000};
  enum { ATTEMPTS = 3 };
  char *page;
  size_t size;
  for (int attempt = 1; app_view_folder_page(&server->folder, &page, &size); attempt++) {
    if (attempt == ATTEMPTS || confine_has_refused()) return fail(server, connection);
    nanosleep(&pause, NULL);
  }
  return reply(server, connection, MHD_HTTP_OK, "text/html; charset=utf-8", page, size);
}

static enum MHD_Result answer(void *self, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *upload,
                              size_t *upload_size, void **state) {
  (void)version, (void)upload, (void)upload_size, (void)state;
  const AppViewServer *server = self;
  if (!app_view_server_is_own_host(header_of(server, connection, "Host"), server->port))
    return refuse(server, connection, MHD_HTTP_FORBIDDEN, "this server answers to 127.0.0.1 only");
  if (is_foreign(server, connection))
    return refuse(server, connection, MHD_HTTP_FORBIDDEN, "this server does not answer to pages of others");
  if (strcmp(method, "GET") != 0)
    return refuse(server, connection, MHD_HTTP_METHOD_NOT_ALLOWED, "there is nothing but GET");
  bool is_page = strcmp(url, "/") == 0;
  if (!is_page && strcmp(url, "/state") != 0)
    return refuse(server, connection, MHD_HTTP_NOT_FOUND, "there is nothing but / and /state");
  AppViewRefusal refusal;
  if (app_view_folder_open(&server->folder, &refusal))
    return refuse(server, connection, code_of(refusal), status_message());
  return is_page ? send_page(server, connection) : send_state(server, connection);
}

static int port_of(const AppViewServer *server) {
  const union MHD_DaemonInfo *info =
      server->library.get_daemon_info(server->daemon, MHD_DAEMON_INFO_BIND_PORT);
  return info ? info->port : 0;
}

// `reason` is an errno; 0: unknown.
static Status fail_port(int port, int reason) {
  return status_fail(
      STATUS_IO,
      "port %d of 127.0.0.1 cannot be opened%s%s; choose another with --port, or 0 for any that is free",
      port, reason ? ": " : "",
      reason == EADDRINUSE ? "another program has it"
      : reason == EACCES   ? "it needs the rights of the administrator"
      : reason             ? strerror(reason)
                           : "");
}

// Why no socket of ours can have the address, an errno; 0: one can. The library's own is lost when it cleans
// up.
static int find_reason(const struct sockaddr_in *address) {
  int found = socket(AF_INET, SOCK_STREAM, 0), reason = errno;
  if (found < 0) return reason;
  reason = bind(found, (const struct sockaddr *)address, sizeof *address) == 0 ? 0 : errno;
  close(found);
  return reason;
}

Status app_view_server_start(AppViewServer *server, const AppViewFolder *folder, int port) {
  *server = (AppViewServer){.folder = *folder};
  TRY(app_view_library_load(&server->library));
  struct sockaddr_in address = {
      .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  enum { SECONDS = 30, MOST_CONNECTIONS = 32 };
  server->daemon = server->library.start_daemon(
      MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_AUTO, (uint16_t)port, NULL, NULL, answer, server,
      MHD_OPTION_SOCK_ADDR, &address, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned int)SECONDS,
      MHD_OPTION_CONNECTION_LIMIT, (unsigned int)MOST_CONNECTIONS, MHD_OPTION_END);
  if (!server->daemon) return fail_port(port, find_reason(&address));
  server->port = port ? port : port_of(server);
  return STATUS_OK;
}

void app_view_server_stop(AppViewServer *server) {
  if (server->daemon) server->library.stop_daemon(server->daemon);
  server->daemon = NULL;
}
