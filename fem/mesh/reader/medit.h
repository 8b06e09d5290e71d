// SPDX-License-Identifier: GPL-3.0-or-later
// MEDIT files with a word and its count on one line ("Vertices 4"). The format allows that, but gmsh looks
// for the count on the next line and misreads them.
#ifndef TETLAP_FEM_MESH_READER_MEDIT_H
#define TETLAP_FEM_MESH_READER_MEDIT_H

#include "base/status.h"

// `*copy`: a temporary file with each count on a line of its own, for the caller to remove and free; NULL:
// the file needs none.
Status fem_mesh_medit_split(const char *path, char **copy);

#endif
