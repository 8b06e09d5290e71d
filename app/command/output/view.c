// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "app/cli/parse.h"
#include "app/job/job.h"
#include "app/view/server.h"
#include "base/files/confine.h"
#include "base/log.h"

enum { DEFAULT_FRAMES = 150, MOST_FRAMES = 1000000, MOST_PORT = 65535 };

typedef struct Options {
  const char *directory;
  int port, frames;
  bool is_quiet;
} Options;

static const AppOption option_table[] = {
    {"port", 'p', "N", "Take this port (default: any that is free)", 0, CLI_INTEGER, CLI_TO(Options, port), 0,
     MOST_PORT},
    {"frames", 0, "N",
     "While the run goes on, show at most N frames, evenly spaced (default: 150); afterwards all", 0,
     CLI_INTEGER, CLI_TO(Options, frames), 2, MOST_FRAMES},
    {"quiet", 'q', NULL, "Say nothing but the address, and errors", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static Status check_directory(const char *directory) {
  struct stat info;
  if (stat(directory, &info) != 0)
    return status_fail(
        STATUS_IO,
        "%s: cannot be opened: %s; give the DIR of `tetlap run SCENE -o DIR`; of a run that is "
        "still to begin, make it: mkdir -p %s",
        directory, strerror(errno), directory);
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

static int run_command(int argument_count, char **arguments) {
  Options options = {.frames = DEFAULT_FRAMES};
  app_cli_parse(&app_command_view, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  return app_cli_command_end(view(&options));
}

const AppCommand app_command_view = {
    .name = "view",
    .help = "show a run in a browser, also while it is running",
    .options = option_table,
    .arguments = &(const AppArguments){"DIR", offsetof(Options, directory), 1,
                                       .missing = "name the directory of a run",
                                       .excess = "one run at a time; '%s' is the second"},
    .doc =
        "Show a run in a browser, also while it is running: the page of `tetlap report`, which is updated "
        "during "
        "the run.\v"
        "DIR is where `tetlap run` writes. The page is served to this machine alone, from an address that is "
        "printed; "
        "no file can be read through it. Ctrl-C ends the server, not the run.",
    .run = run_command};
