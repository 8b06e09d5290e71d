// SPDX-License-Identifier: GPL-3.0-or-later
// A load of the scene on a body's vertices. All kinds but a pressure that follows its surface and a torque
// (fem/scene/torque.h, weighted by the volume at rest around a vertex) are dead: fixed nodal forces times the
// factor of time; those of a surface are the integrals of the shape functions, also on the faces of quadratic
// tetrahedra, whose corners get nothing; a body force is distributed as the mass is. The following pressure p
// on a triangle with the area vector A = ½ (b − a) × (c − a), outward, gives each corner −p A/3; it is −p
// ∂V/∂x of the volume that the surface bounds.
#ifndef TETLAP_FEM_SCENE_LOAD_H
#define TETLAP_FEM_SCENE_LOAD_H

#include "fem/mesh/mesh.h"
#include "fem/scene/scene.h"
#include "fem/scene/signal.h"

typedef struct FemLoad {
  const FemLoadDef *def; // borrowed from the scene
  int *vertices;         // of the model, that carry a dead load or a torque          (vertex_count)
  double *force;         // on each at factor 1 [N]                                   (vertex_count, 3)
  double *weight;        // in place of `force`, of a torque [m³]                     (vertex_count)
  int vertex_count;
  double *from;        // of an external load: at factor 0 [N]; else NULL                (vertex_count, 3)
  int (*triangles)[3]; // of the model, outward, that carry a following pressure      (triangle_count)
  int triangle_count;
  int (*faces)[6]; // the same of quadratic tetrahedra (fem/element/quadratic_face.h)         (face_count)
  int face_count;
} FemLoad;

// Finds vertices and triangles in `mesh`, whose first vertex has the number `vertex_begin` in the model.
// STATUS_INPUT: a selection without a vertex, for a surface load without a triangle, for a torque on a line.
Status fem_load_create(FemLoad *load, const FemLoadDef *def, const FemMesh *mesh, int vertex_begin);
void fem_load_destroy(FemLoad *load); // also of a zeroed one
// Like fem_load_create, but on the vertices of `of`, whatever the selection would find in this mesh: the same
// load where the mesh has another shape. No torques and loads from outside.
Status fem_load_create_like(FemLoad *load, const FemLoad *of, const FemMesh *mesh, int vertex_begin);

// What the load's values are multiplied with at a time. STATUS_INPUT: not a number.
Status fem_load_factor(const FemLoadDef *def, double time, double *factor);

// Of an external load, and its `def`: from what it is at `time` it becomes these forces [N] (vertex_count,
// 3), straight on until `end` [s]; at once where that is `time`. STATUS_MEMORY.
Status fem_load_set(FemLoad *load, FemLoadDef *def, double time, double end, const double *force);

// From a time on, when the load begins to change: that time itself if it is changing, INFINITY if never
// again.
double fem_load_next_change(const FemLoadDef *def, double time);

// How far a step may go along the factor (signal.h); `acceleration` [m/s²]: the largest that the load at
// factor 1 gives a vertex.
double fem_load_horizon(const FemLoadDef *def, double acceleration, const FemForesight *foresight,
                        double time, double farthest);

// Whether the forces depend on positions.
bool fem_load_follows(const FemLoad *load);

// Adds factor × load at these positions to `force` (vertex_count, 3) [N].
void fem_load_add_force(const FemLoad *load, double factor, const double *positions, double *force);

// −∂f/∂x of one triangle of a following pressure p, the symmetric part, (9, 9): over a surface that is closed
// or held at its rim the parts left out cancel.
void fem_load_triangle_stiffness(double pressure, const double a[3], const double b[3], const double c[3],
                                 double stiffness[81]);

#endif
