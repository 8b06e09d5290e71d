// SPDX-License-Identifier: GPL-3.0-or-later
// Frames read back, in one file (.vtu) or in pieces (.pvtu, fem/output/vtk/pieces.h).
#ifndef TETLAP_FEM_OUTPUT_VTK_PIECES_READ_H
#define TETLAP_FEM_OUTPUT_VTK_PIECES_READ_H

#include "fem/output/vtk/vtu_read.h"

// As fem_vtu_read; of pieces the whole, without their numbers.
Status fem_vtu_pieces_read(const char *path, FemVtuContent *content);

#endif
