// SPDX-License-Identifier: GPL-3.0-or-later
// What lines through bodies show (fem/scene/probe/line.h), a file a frame: lines_NNNNN.csv. docs/output.md
// describes its columns.
#ifndef TETLAP_FEM_OUTPUT_LINES_H
#define TETLAP_FEM_OUTPUT_LINES_H

#include "fem/effect/system.h"

// Writes all lines at a state whose pressures at the surface are given (vertex_count; NULL: there are none).
Status fem_lines_write(const FemSystem *system, const FemState *state, const double *pressures,
                       const char *directory, int frame);

#endif
