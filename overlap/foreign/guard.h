// SPDX-License-Identifier: Apache-2.0
// A library that calls exit() within a call would end the program as if all were well: with the exit code
// that it chose. Within a guarded call it ends with a message and the exit code of STATUS_SOLVER. Only the
// thread that calls counts: others of a host may end their program meanwhile.
#ifndef TETLAP_OVERLAP_FOREIGN_GUARD_H
#define TETLAP_OVERLAP_FOREIGN_GUARD_H

// From here on this thread computes in the library `path`, borrowed until the end.
void overlap_foreign_guard_begin(const char *path);
void overlap_foreign_guard_end(void);

#endif
