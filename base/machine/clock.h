// SPDX-License-Identifier: Apache-2.0
// Wall and processor time [s].
#ifndef TETLAP_BASE_MACHINE_CLOCK_H
#define TETLAP_BASE_MACHINE_CLOCK_H

double clock_wall_s(void); // monotonic; only differences mean something
double clock_cpu_s(void);  // user + system time of all threads of this process

#endif
