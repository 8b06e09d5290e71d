// SPDX-License-Identifier: GPL-3.0-or-later
// tetlap-mpi: the program of app/main.c, which mpiexec may start several times. By itself it is that program.
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "app/program.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "dist/mpi.h"
#include "dist/solver.h"

// A rank a core, with one thread unless asked, and threads that wait sleep; MPI looks for processors, not for
// displays. What is set already stays. OpenMP reads its part before main: so the program starts itself once
// more.
static void settle(char **arguments) {
  static const char *const settings[][2] = {{"OMP_NUM_THREADS", "1"},
                                            {"OMP_WAIT_POLICY", "passive"},
                                            {"OPENBLAS_NUM_THREADS", "1"},
                                            {"HWLOC_COMPONENTS", "-gl,-opencl"}};
  bool is_new = false;
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
    if (getenv(settings[i][0])) continue;
    if (setenv(settings[i][0], settings[i][1], 1) != 0) return;
    is_new = true;
  }
  if (is_new) execv("/proc/self/exe", arguments); // where that fails, the run is only slower
}

int main(int argument_count, char **arguments) {
  memory_separate();
  if (dist_mpi_is_wanted()) {
    settle(arguments);
    dist_mpi_begin(&argument_count, &arguments, dist_solver_close);
    if (ranks()->count > 1) dist_solver_provide();
  } else
    dist_mpi_begin_alone();
  return app_program_run(&app_program_root, argument_count, arguments);
}
