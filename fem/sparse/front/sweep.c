// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/sparse/front/sweep.h"

// Columns that are taken together: a vector is read and written once for all of them.
// Most nodes have three.
enum { TOGETHER = 6, NODE = 3 };
// Sums that are formed side by side.
enum { LANES = 4 };

// The loops that read all of a factor, also for the instructions that most processors have.
#if defined(__x86_64__) && !defined(__clang__)
#define FASTEST __attribute__((target_clones("avx2", "default")))
#else
#define FASTEST
#endif

#define REAL double
#define SWEEP(name) name##_double
#include "fem/sparse/front/sweep.inc"
#undef REAL
#undef SWEEP
#define REAL float
#define SWEEP(name) name##_float
#include "fem/sparse/front/sweep.inc"

static size_t place(const FemSweepPanel *panel, int row, int column) {
  return (size_t)column * (size_t)panel->height + (size_t)row;
}

void fem_sweep_forward(const FemSweepPanel *panel, int begin, int end, double *x) {
  if (panel->values)
    forward_double(panel->values, panel->height, begin, end, x);
  else
    forward_float(panel->rough, panel->height, begin, end, x);
}

void fem_sweep_backward(const FemSweepPanel *panel, int begin, int end, double *x) {
  if (panel->values)
    backward_double(panel->values, panel->height, begin, end, x);
  else
    backward_float(panel->rough, panel->height, begin, end, x);
}

void fem_sweep_subtract(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *x,
                        double *y) {
  size_t at = place(panel, first, begin);
  if (panel->values)
    subtract_double(panel->values + at, panel->height, end - begin, last - first, x + begin, y);
  else
    subtract_float(panel->rough + at, panel->height, end - begin, last - first, x + begin, y);
}

void fem_sweep_project(const FemSweepPanel *panel, int begin, int end, int first, int last, const double *y,
                       double *x) {
  size_t at = place(panel, first, begin);
  if (panel->values)
    project_double(panel->values + at, panel->height, end - begin, last - first, y, x + begin);
  else
    project_float(panel->rough + at, panel->height, end - begin, last - first, y, x + begin);
}
