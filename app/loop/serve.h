// SPDX-License-Identifier: GPL-3.0-or-later
// A run that another process steps: a few words through a socket, arrays in shared memory. The other side is
// the Python package (python/tetlap/_channel.py).
//
//   request   what, length, a, b        four words of 64 bits, then `length` bytes
//   answer    code, length, time, b     likewise, the time as its bits; the bytes are a message, or JSON
//
//   HELLO     a: version                ─► what there is, and where in the memory, as JSON
//   ADVANCE   a: until [s], b           ─► once there; with b = 1 an answer with the code STEP after each
//                                          step, too, to which the other side says GO (b: 1 = stop here)
//   SET       a: ramp [s], b: kind      ─► bytes: the group's name, a 0, the values
//   FILL      b: which arrays           ─► forces and pressure (1), stress (2) of the present time
//   KEEP                                ─► b: number of the state
//   RESTORE, DROP   b: number
//   WRITE     b: number, bytes: path    ─► the state as a file
//   READ      bytes: path               ─► b: number
//   RECORD    bytes: path               ─► what was set, for `tetlap run --replay`
//
// Points, velocities and contacts are in the memory whenever an answer is. The other side ends the run by
// closing its socket. Codes: 0, STEP, or the program's exit codes.
#ifndef TETLAP_APP_LOOP_SERVE_H
#define TETLAP_APP_LOOP_SERVE_H

#include "app/loop/loop.h"

// Serves until the other side closes the socket; `memory` is a file that this side makes as large as it
// needs. That a scene cannot be opened is the answer to the first request. STATUS_IO: the channel fails.
Status app_loop_serve(const AppLoopOptions *options, int socket, int memory);

#endif
