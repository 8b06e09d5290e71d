// SPDX-License-Identifier: Apache-2.0
// A library that calls exit() within a call would end the program as if all were well: with the exit code
// that it chose. Within a guarded call it ends with a message and the exit code of STATUS_SOLVER; so it does
// by _exit() where the program's own (app/leave.c) stands before the C library's. Only the thread that calls
// counts: others of a host may end their program meanwhile, and a process that the library forked ends as it
// likes.
#ifndef TETLAP_OVERLAP_FOREIGN_GUARD_H
#define TETLAP_OVERLAP_FOREIGN_GUARD_H

// From here on this thread computes in the library `path`, borrowed until the end.
void overlap_foreign_guard_begin(const char *path);
void overlap_foreign_guard_end(void);

// Before the program ends by `function` with `code`: the code to end with. Within a call it writes the
// message.
int overlap_foreign_guard_leave(const char *function, int code);

// `end` is called with the exit code after the message, and may end the program itself: of several processes
// only one speaks, and the others are to end too. NULL: nothing is called.
void overlap_foreign_guard_set_end(void (*end)(int code));

#endif
