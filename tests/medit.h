// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh as a MEDIT .mesh file, without groups.
#ifndef TETLAP_TESTS_MEDIT_H
#define TETLAP_TESTS_MEDIT_H

#include "suite.h"

#include "fem/mesh/mesh.h"

static inline void medit_write(const FemMesh *mesh, const char *path) {
  FILE *stream = fopen(path, "w");
  ck_assert_ptr_nonnull(stream);
  fprintf(stream, "MeshVersionFormatted 2\nDimension 3\nVertices\n%d\n", mesh->vertex_count);
  for (int v = 0; v < mesh->vertex_count; v++) {
    const double *x = mesh->rest + 3 * (size_t)v;
    fprintf(stream, "%.17g %.17g %.17g 0\n", x[0], x[1], x[2]);
  }
  fprintf(stream, "Tetrahedra\n%d\n", mesh->tet_count);
  for (int t = 0; t < mesh->tet_count; t++) {
    const int *tet = mesh->tets[t];
    fprintf(stream, "%d %d %d %d 1\n", tet[0] + 1, tet[1] + 1, tet[2] + 1, tet[3] + 1);
  }
  fprintf(stream, "End\n");
  ck_assert_int_eq(fclose(stream), 0);
}

#endif
