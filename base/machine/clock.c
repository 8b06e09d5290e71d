// SPDX-License-Identifier: Apache-2.0
#include "base/machine/clock.h"

#include <time.h>

static double read_clock(clockid_t id) {
  struct timespec now;
  if (clock_gettime(id, &now) != 0) return 0;
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double clock_wall_s(void) {
  return read_clock(CLOCK_MONOTONIC);
}

double clock_cpu_s(void) {
  return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}
