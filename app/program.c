// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"

#include <stdio.h>

#include "base/status.h"

int app_program_run(int argument_count, char **arguments) {
  (void)arguments;
  fprintf(stderr, "usage: tetlap COMMAND …\n");
  return argument_count > 1 ? 0 : status_exit_code(STATUS_USAGE);
}
