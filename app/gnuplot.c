// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gnuplot.h"

#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

Status app_gnuplot_run(const char *script) {
  char program[] = "gnuplot", name[4096];
  if (snprintf(name, sizeof name, "%s", script) >= (int)sizeof name)
    return status_fail(STATUS_USAGE, "the picture's name is too long");
  char *arguments[] = {program, name, NULL};
  pid_t child;
  int failed = posix_spawnp(&child, program, NULL, NULL, arguments, environ), ended;
  if (failed)
    return status_fail(STATUS_IO, "gnuplot cannot be run: %s; the script is %s", strerror(failed), script);
  while (waitpid(child, &ended, 0) < 0)
    if (errno != EINTR) return status_fail(STATUS_IO, "gnuplot was lost: %s", strerror(errno));
  if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0)
    return status_fail(STATUS_IO, "gnuplot failed on %s", script);
  return STATUS_OK;
}
