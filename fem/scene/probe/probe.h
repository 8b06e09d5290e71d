// SPDX-License-Identifier: GPL-3.0-or-later
// A part of a body whose force and motion the scene asks for: vertices, and the triangles of its surface all
// of whose corners are among them.
#ifndef TETLAP_FEM_SCENE_PROBE_PROBE_H
#define TETLAP_FEM_SCENE_PROBE_PROBE_H

#include "fem/mesh/mesh.h"
#include "fem/scene/scene.h"

typedef struct FemProbe {
  const FemProbeDef *def; // borrowed from the scene
  int body;
  int *vertices; // of the model                            (vertex_count)
  int vertex_count;
  int (*triangles)[3]; // of the model, outward             (triangle_count)
  int triangle_count;
} FemProbe;

// Finds vertices and triangles in `mesh`, that of body `body`, whose first vertex has the number
// `vertex_begin` in the model. STATUS_INPUT: a selection without a vertex.
Status fem_probe_create(FemProbe *probe, const FemProbeDef *def, const FemMesh *mesh, int body,
                        int vertex_begin);
void fem_probe_destroy(FemProbe *probe); // also of a zeroed one

#endif
