// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/mesh/faces.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/tet.h"

static void swap(FemMeshFace *face, int i, int j) {
  if (face->vertices[i] <= face->vertices[j]) return;
  int kept = face->vertices[i];
  face->vertices[i] = face->vertices[j];
  face->vertices[j] = kept;
  face->is_even = !face->is_even;
}

static FemMeshFace face_of(const int tet[4], int index, int local) {
  const int *corners = tet_faces[local];
  FemMeshFace face = {{tet[corners[0]], tet[corners[1]], tet[corners[2]]}, index, local, true};
  swap(&face, 0, 1), swap(&face, 1, 2), swap(&face, 0, 1);
  return face;
}

static int compare(const void *left, const void *right) {
  const FemMeshFace *a = left, *b = right;
  for (int k = 0; k < 3; k++)
    if (a->vertices[k] != b->vertices[k]) return a->vertices[k] < b->vertices[k] ? -1 : 1;
  return (a->tet > b->tet) - (a->tet < b->tet);
}

// Counting sort by the first vertex, then each of the short buckets by comparison: linear in practice.
Status fem_mesh_faces_list(FemMeshFace **faces, int vertex_count, int tet_count, const int (*tets)[4]) {
  size_t count = 4 * (size_t)tet_count;
  FemMeshFace *list = memory_zeroed(count, sizeof *list);
  size_t *begin = memory_zeroed((size_t)vertex_count + 2, sizeof *begin);
  if (!list || !begin) {
    memory_free(list), memory_free(begin);
    return status_no_memory("the faces of a mesh");
  }
  // begin[v + 2] counts bucket v; summed up, begin[v + 1] is where it starts, and after filling where it
  // ends.
  for (int t = 0; t < tet_count; t++)
    for (int k = 0; k < 4; k++) begin[face_of(tets[t], t, k).vertices[0] + 2]++;
  for (int v = 0; v < vertex_count; v++) begin[v + 2] += begin[v + 1];
  for (int t = 0; t < tet_count; t++)
    for (int k = 0; k < 4; k++) {
      FemMeshFace face = face_of(tets[t], t, k);
      list[begin[face.vertices[0] + 1]++] = face;
    }
  for (int v = 0; v < vertex_count; v++)
    qsort(list + begin[v], begin[v + 1] - begin[v], sizeof *list, compare);
  memory_free(begin);
  *faces = list;
  return STATUS_OK;
}

int fem_mesh_faces_end(const FemMeshFace *faces, int face_count, int begin) {
  const int *first = faces[begin].vertices;
  int end = begin + 1;
  while (end < face_count && faces[end].vertices[0] == first[0] && faces[end].vertices[1] == first[1] &&
         faces[end].vertices[2] == first[2])
    end++;
  return end;
}
