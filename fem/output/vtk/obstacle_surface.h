// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces of obstacles without a mesh, to be looked at: triangles that follow the obstacle's motion. Contact
// knows nothing of them (contact/shape/shape.h).
#ifndef TETLAP_FEM_OUTPUT_VTK_OBSTACLE_SURFACE_H
#define TETLAP_FEM_OUTPUT_VTK_OBSTACLE_SURFACE_H

#include <stdbool.h>

#include "fem/model/model.h"

// Of a box its faces; of a cylinder a prism whose section has the circle's area; of a ball triangles with
// corners on it. Contact computes with the round ones. Of a half-space a square below the bodies at rest; it
// moves along its normal only, so it stays there.
typedef struct FemObstacleSurface {
  int vertex_count;
  double *rest;                   // before any motion [m]                            (vertex_count, 3)
  double *positions, *velocities; // when they were placed last [m], [m/s]            (vertex_count, 3)
  const FemObstacleDef **defs;    // whose it is; borrowed from the scene             (vertex_count)
  int triangle_count;
  int (*triangles)[3]; // vertices, counter-clockwise from outside         (triangle_count)
  int *bodies;         // the obstacle, counted on from the model's bodies (triangle_count)
  int *faces;          // parts that can be told apart when it turns: a box has 6, a ball 8 octants, a
                       // cylinder 4 quarters of each face                 (triangle_count)
} FemObstacleSurface;

// Of the scene's obstacles those that move, or those that stand; owned by the caller. STATUS_MEMORY.
Status fem_obstacle_surface_create(FemObstacleSurface *surface, const FemModel *model, bool are_moving);
void fem_obstacle_surface_destroy(FemObstacleSurface *surface); // a zeroed one, too

// Fills positions and velocities for that time [s].
void fem_obstacle_surface_place(FemObstacleSurface *surface, double time);

// Writes what was placed last as a frame of triangles (fem/output/vtk/vtu.h) with the arrays `velocity`,
// `body` and `face`. `time` NaN: at all times. Fails as fem_vtu_write.
Status fem_obstacle_surface_write(const FemObstacleSurface *surface, const char *path, double time);

#endif
