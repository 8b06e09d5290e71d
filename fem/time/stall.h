// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a run makes progress. Under a force that jumps, or a matrix that is not the force's derivative, an
// integrator with error control does not fail: it cuts its steps again and again and would go on for days.
//
// Tries are counted in windows of 2000, over all the integrators of a run: steps, also those that are taken
// back, and tries that failed before they became a step. Those that led to no accepted step are counted as
// vain. A run is given up
//   standing: at the pace of one window the whole run would take a million tries;
//   creeping: in two windows in a row all of this holds: a quarter of the tries was in vain;
//             what is left of the run would take a hundred thousand more;
//             the pace was below a tenth of that of the fastest window before;
//             the window came less far than from one frame to the next.
// A sound run may be slow, lose many tries, or slow down; none known does all of it for 4000 tries
// (docs/stability.md).
#ifndef TETLAP_FEM_TIME_STALL_H
#define TETLAP_FEM_TIME_STALL_H

enum { FEM_STALL_WINDOW = 2000 };

typedef enum FemStallVerdict { FEM_STALL_GOES_ON, FEM_STALL_STANDS, FEM_STALL_CREEPS } FemStallVerdict;

typedef struct FemStall {
  double end, frame;     // of the run; between two frames [s]
  double time;           // when the window began [s]
  long long tries, vain; // in the window
  double fastest;        // pace of a window so far [s per try]
  int strikes;           // windows in a row, up to the last, in which the run crept
  double left;           // tries that the rest would take at the pace of the last window
} FemStall;

// A run begins at `time`, or is taken up there.
FemStall fem_stall_begin(double time, double end, double frame);

// After a step to `time` that took so many tries, `vain` of them before it; no step can be longer than
// `max_step` [s].
FemStallVerdict fem_stall_add(FemStall *stall, long long tries, long long vain, double time, double max_step);

// Time went on by so much without the integrator: all bodies slept.
void fem_stall_pass(FemStall *stall, double duration);

// The last step was refused after all.
void fem_stall_take_back(FemStall *stall);

#endif
