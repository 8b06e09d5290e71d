// SPDX-License-Identifier: GPL-3.0-or-later
// tetlap-mpi: the program of app/main.c, which mpiexec may start several times. By itself it is that program.
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/program.h"
#include "base/ranks.h"
#include "base/status.h"
#include "dist/mpi.h"
#include "dist/solver.h"

// What was printed must have arrived.
static int flush_output(int exit_code) {
  bool is_whole = fflush(stdout) == 0 && !ferror(stdout);
  if (is_whole || exit_code != 0) return exit_code;
  fprintf(stderr, "error: standard output cannot be written: %s\n", strerror(errno));
  return status_exit_code(STATUS_IO);
}

int main(int argument_count, char **arguments) {
  if (dist_mpi_is_wanted()) {
    dist_mpi_begin(&argument_count, &arguments, dist_solver_close);
    if (ranks()->count > 1) dist_solver_provide();
  } else
    dist_mpi_begin_alone();
  return flush_output(app_program_run(argument_count, arguments));
}
