// SPDX-License-Identifier: GPL-3.0-or-later
// A frame in pieces, one of each rank with its own elements, and a list of them (.pvtu) that ParaView opens
// as one. Each piece has the numbers of its vertices and elements in the whole, by which the whole is put
// together again.
#ifndef TETLAP_FEM_OUTPUT_VTK_PIECES_H
#define TETLAP_FEM_OUTPUT_VTK_PIECES_H

#include "base/status.h"
#include "fem/output/vtk/vtu.h"
#include "fem/sparse/share.h"

// The arrays with those numbers.
#define FEM_VTU_VERTEX "vertex"
#define FEM_VTU_ELEMENT "element"

// What this rank writes: elements whose lowest vertex it owns, their vertices, and its own that no element
// has.
typedef struct FemVtuPart {
  int vertex_count, cell_count;
  int *vertices; // in the whole, ascending              (vertex_count)
  int *elements; // in the whole, ascending              (cell_count)
  int *cells;    // places in `vertices`                 (cell_count, 4)
} FemVtuPart;

// `share` NULL: all.
Status fem_vtu_part_create(FemVtuPart *part, int vertex_count, int cell_count, const int (*cells)[4],
                           const FemShare *share);
void fem_vtu_part_destroy(FemVtuPart *part);

// By all ranks: NAME_0.vtu, NAME_1.vtu …, then by the first NAME.pvtu, which lists them. `frame` is the
// whole. All ranks are given the worst status of any, and there is no list then.
Status fem_vtu_pieces_write(const char *directory, const char *name, const FemVtuFrame *frame,
                            const FemVtuPart *part);

#endif
