// SPDX-License-Identifier: GPL-3.0-or-later
// The program's own _exit: a library that is loaded later finds it before the C library's, so a model that
// ends the program by it is told (overlap/foreign/guard.h). Part of the programs, not of a library: a host
// keeps its own.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // syscall
#endif
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "overlap/foreign/guard.h"

__attribute__((noreturn)) void _exit(int code) {
  code = overlap_foreign_guard_leave("_exit()", code);
  for (;;) syscall(SYS_exit_group, code);
}

__attribute__((noreturn)) void _Exit(int code) {
  _exit(code);
}
