// SPDX-License-Identifier: GPL-3.0-or-later
// What a run measures and shows: frames by its recorder, the trajectory where it is kept, extremes.
#ifndef TETLAP_FEM_RUN_RUN_FRAMES_H
#define TETLAP_FEM_RUN_RUN_FRAMES_H

#include "fem/run/run_state.h"

// Opens the recorder, and room for the trajectory, where the run's checkpoint left off.
Status fem_run_frames_open(FemRunState *run);

// Measures the state under trial. RETRY: it, or an energy, is not made of numbers, or it is too far for the
// contact lists.
Status fem_run_frames_measure(FemRunState *run, FemMeasures *measures);

void fem_run_frames_keep_extremes(FemRunResult *result, const FemMeasures *measures);

// Writes the state that was measured last as the frame of that time.
Status fem_run_frames_write(FemRunState *run, double time, const FemMeasures *measures);

// Writes the frames within the last step. RETRY as of measuring.
Status fem_run_frames_write_until(FemRunState *run, double time);

// The row of the step in the history, kept before frames within the step are measured in its place.
Status fem_run_frames_take_row(FemRunState *run, const FemMeasures *measures, const FemAudit *audit);

#endif
