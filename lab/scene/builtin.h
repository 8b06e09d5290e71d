// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of the benches that need no file.
#ifndef TETLAP_LAB_SCENE_BUILTIN_H
#define TETLAP_LAB_SCENE_BUILTIN_H

#include "fem/scene/scene.h"

// A beam of about `nodes` (≥ 24) vertices, `slenderness` times as long as thick (0.1 m), of cubes cut into
// tetrahedra, clamped at one end, that falls under gravity: neo-Hookean, E 1 MPa, ν 0.4, 1000 kg/m³, damped;
// 1 s. The more slender, the sparser are the factors. The caller destroys the scene.
Status lab_scene_builtin_beam(int nodes, double slenderness, FemSceneDef *scene);

// A block of 0.2 m, 4³ cells, that falls 5 cm flat onto the ground and is not damped: neo-Hookean, E 1 MPa,
// ν 0.4, 1000 kg/m³; 0.3 s. `stiffness` κ [Pa], `tolerance` of the time integration as in a scene file.
Status lab_scene_builtin_drop(double stiffness, double tolerance, FemSceneDef *scene);

// Two blocks of 0.1 m whose meshes do not match, about `nodes` (≥ 60) vertices together, the upper one turned
// about the vertical and pressed 2 % of an edge into the lower one, which stands on the ground: contact from
// the first step. E 0.1 and 0.2 MPa, damped, gravity; 0.1 s.
Status lab_scene_builtin_blocks(int nodes, FemSceneDef *scene);

// Scenes for large meshes, of about `nodes` (≥ 60) vertices, in contact from the first step.
enum { LAB_SCENE_LARGE_COUNT = 5 };
typedef struct LabSceneLarge {
  const char *name, *help;
  Status (*read)(int nodes, FemSceneDef *scene);
} LabSceneLarge;
extern const LabSceneLarge lab_scene_builtin_large[LAB_SCENE_LARGE_COUNT];

#endif
