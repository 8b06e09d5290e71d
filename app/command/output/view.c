// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/output/view.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "app/cli/argument.h"
#include "app/job/job.h"
#include "app/view/server.h"
#include "base/files/confine.h"
#include "base/log.h"

enum { KEY_FRAMES = 256, DEFAULT_FRAMES = 150, MOST_FRAMES = 1000000, MOST_PORT = 65535 };

typedef struct Options {
  const char *directory;
  int port, frames;
  bool is_quiet;
} Options;

static const struct argp_option option_table[] = {
    {"port", 'p', "N", 0, "Take this port (default: any that is free)", 0},
    {"frames", KEY_FRAMES, "N", 0,
     "While the run goes on, show at most N frames, evenly spaced (default: 150); afterwards all", 0},
    {"quiet", 'q', NULL, 0, "Say nothing but the address, and errors", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'p':
    options->port = (int)app_argument_integer(state, "port", text, 0, MOST_PORT);
    return 0;
  case KEY_FRAMES:
    options->frames = (int)app_argument_integer(state, "frames", text, 2, MOST_FRAMES);
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->directory) argp_error(state, "one run at a time; '%s' is the second", text);
    options->directory = text;
    return 0;
  case ARGP_KEY_END:
    if (!options->directory) argp_error(state, "name the directory of a run");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status check_directory(const char *directory) {
  struct stat info;
  if (stat(directory, &info) != 0)
    return status_fail(STATUS_IO, "%s: cannot be opened: %s; give the DIR of `tetlap run SCENE -o DIR`",
                       directory, strerror(errno));
  if (!S_ISDIR(info.st_mode))
    return status_fail(STATUS_INPUT, "%s: is not a directory; give the DIR of `tetlap run SCENE -o DIR`",
                       directory);
  return STATUS_OK;
}

static Status view(const Options *options) {
  TRY(check_directory(options->directory));
  AppViewServer server;
  AppViewFolder folder = {.directory = options->directory, .max_frames = options->frames};
  AppViewRefusal refusal;
  TRY(app_view_folder_open(&folder, &refusal));
  confine_end(); // the library is still to be loaded
  TRY(app_view_server_start(&server, &folder, options->port));
  printf("http://127.0.0.1:%d/\n", server.port);
  fflush(stdout);
  log_info("open this address in a browser of this machine; Ctrl-C ends");
  static const struct timespec pause = {.tv_nsec = 50 * 1000 * 1000};
  while (!*app_job_stop_flag()) nanosleep(&pause, NULL);
  app_view_server_stop(&server);
  return STATUS_OK;
}

static const struct argp argp = {
    option_table,
    parse,
    "DIR",
    "Show a run in a browser, also while it is running: the page of `tetlap report`, which is updated during "
    "the run.\v"
    "DIR is where `tetlap run` writes. The page is served to this machine alone, from an address that is "
    "printed; "
    "no file can be read through it. Ctrl-C ends the server, not the run.",
    NULL,
    NULL,
    NULL};

static int run_command(int argument_count, char **arguments) {
  Options options = {.frames = DEFAULT_FRAMES};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  return app_cli_command_end(view(&options));
}

const AppCommand app_command_view = {.name = "view",
                                     .help = "show a run in a browser, also while it is running",
                                     .argp = &argp,
                                     .run = run_command};
