// SPDX-License-Identifier: Apache-2.0
// Whether this process has been asked to end, by Ctrl-C or SIGTERM. A flag of the process, as signals are.
// Long computations read it, and waits read it again at intervals, since a signal that comes just before a
// wait does not interrupt it.
#ifndef TETLAP_BASE_MACHINE_INTERRUPT_H
#define TETLAP_BASE_MACHINE_INTERRUPT_H

#include <signal.h>

// Other than 0 once it has been asked. A handler of signals may raise it.
volatile sig_atomic_t *interrupt_flag(void);

#endif
