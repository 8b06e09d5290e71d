// SPDX-License-Identifier: GPL-3.0-or-later
// What stays constant in a run: all bodies' meshes one after another, masses, elements, materials,
// constraints, and which of the 3·vertex_count coordinates are unknowns. Built from a scene definition.
#ifndef TETLAP_FEM_MODEL_H
#define TETLAP_FEM_MODEL_H

#include "contact/system.h"
#include "fem/element.h"
#include "fem/scene.h"

typedef struct FemModelBody {
  const char *name; // borrowed from the scene
  int vertex_begin, vertex_end;
  int tet_begin, tet_end;
  FemMaterial material; // obstacles: zeroed
  double damping;       // β [s]
  double mass;          // [kg]
  bool is_obstacle;
} FemModelBody;

// Vertices whose motion is prescribed, by one constraint.
typedef struct FemModelDriver {
  const FemConstraintDef *def; // borrowed from the scene; fixed ones have zero motion
  int *dofs;                   // 3·vertex + component   (dof_count)
  int dof_count;
} FemModelDriver;

// Tetrahedra in groups within which no two share a vertex: a group's contributions can be added in parallel,
// and the order of summation does not depend on the number of threads.
typedef struct FemColouring {
  int colour_count;
  int *begin; // of each colour in `tets`        (colour_count + 1)
  int *tets;  // elastic tetrahedra by colour
} FemColouring;

typedef struct FemModel {
  const FemSceneDef *scene;                // borrowed
  int vertex_count, tet_count, body_count; // obstacles included, after the bodies
  double *rest;                            // [m]                                       (vertex_count, 3)
  int (*tets)[4];                          //                                           (tet_count)
  int *tet_body;                           //                                           (tet_count)
  FemElement *elements;                    //                                           (tet_count)
  FemModelBody *bodies;                    //                                           (body_count)
  double *mass;                            // lumped, obstacles 0 [kg]                  (vertex_count)
  double *initial_velocity;                // [m/s]                                     (vertex_count, 3)
  int unknown_count;                       // n
  int *unknown_of_dof;                     // number of the unknown, −1: prescribed     (3·vertex_count)
  int *dof_of_unknown;                     //                                           (unknown_count)
  FemModelDriver *drivers;                 //                                           (driver_count)
  int driver_count;
  FemColouring colouring;
  double length; // the smallest body's bounding box diagonal [m]
  double edge;   // the smallest mean edge of a body [m]
} FemModel;

// Reads the meshes (relative to the scene file), places, checks and numbers. STATUS_INPUT names the body and
// what is wrong: a selection that is empty, a vertex fixed and driven in the same component, an unknown
// group.
Status fem_model_create(FemModel *model, const FemSceneDef *scene);
void fem_model_destroy(FemModel *model);

// Positions and velocities of all prescribed coordinates at time t; the others are left alone.
void fem_model_drive(const FemModel *model, double time, double *positions, double *velocities);

// The memory that a run of this model will take, roughly [bytes].
double fem_model_memory_estimate(const FemModel *model);

#endif
