// SPDX-License-Identifier: Apache-2.0
// The faces of a tetrahedron.
#ifndef TETLAP_BASE_TET_H
#define TETLAP_BASE_TET_H

// The vertices of face f, the one opposite to vertex f: counter-clockwise as seen from outside, if the
// tetrahedron is positively oriented.
static const int tet_faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

#endif
