// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/status.h"

// Threads that wait shall sleep: on a machine that others use too, spinning ones held a matrix product of 20
// k vertices for 17 ms instead of 2.4 ms. libgomp reads the policy before main, so the program starts itself
// once more; only for commands that have threads, since a start takes a hundredth of a second.
static void let_threads_sleep(char **arguments) {
  if (getenv("OMP_WAIT_POLICY") || setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  execv("/proc/self/exe", arguments); // where that fails, the run is only slower
}

// What was printed must have arrived.
static int flush_output(int exit_code) {
  bool is_whole = fflush(stdout) == 0 && !ferror(stdout);
  if (is_whole || exit_code != 0) return exit_code;
  fprintf(stderr, "error: standard output cannot be written: %s\n", strerror(errno));
  return status_exit_code(STATUS_IO);
}

int main(int argument_count, char **arguments) {
  memory_separate();
  if (app_program_has_threads(argument_count, arguments)) let_threads_sleep(arguments);
  return flush_output(app_program_run(argument_count, arguments));
}
