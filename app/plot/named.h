// SPDX-License-Identifier: GPL-3.0-or-later
// A quantity along a line of the scene (bodies[].lines), from lines_NNNNN.csv of a run.
#ifndef TETLAP_APP_PLOT_NAMED_H
#define TETLAP_APP_PLOT_NAMED_H

#include "app/plot/sample.h"
#include "fem/output/vtk/pvd.h"

// The times of these files in `directory`; without files. STATUS_INPUT: there are none, or one is no such
// file.
Status app_plot_named_frames(const char *directory, FemPvdList *frames);
// Fills zeroed points with the values of `quantity` ("NAME" or "NAME:COMPONENT"; of a vector without one its
// length) along line `name` in the file of that frame; `nan` is left out. Owned by the caller, also after a
// failure. STATUS_INPUT: no such line or quantity, with those there are.
Status app_plot_named_read(AppPlotPoints *points, const char *directory, int frame, const char *name,
                           const char *quantity);

#endif
