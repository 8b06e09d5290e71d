// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene_table.h"

#include "fem/scene.h"

static const char *finish_obstacle(void *self, const char **key) {
  FemObstacleDef *obstacle = self;
  for (int c = 0; c < 3; c++) obstacle->motion.components[c] = true;
  *key = "motion";
  bool turns = obstacle->kind == FEM_OBSTACLE_HALFSPACE && obstacle->motion.spin != 0;
  return turns ? "a half-space does not turn; use a mesh, a box for example" : NULL;
}

static const SceneKey halfspace_keys[] = {
    {"point", SCENE_VECTOR, AT(FemObstacleDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "on its surface"},
    {"normal", SCENE_DIRECTION, AT(FemObstacleDef, normal), .required = "[0, 0, 1]",
     .help = "points out of the solid"},
    {0},
};
static const SceneSection halfspace = {.help = "everything below a plane", .keys = halfspace_keys};

static const SceneKey sphere_keys[] = {
    {"centre", SCENE_VECTOR, AT(FemObstacleDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "at t = 0"},
    {"radius", SCENE_NUMBER, AT(FemObstacleDef, radius), .unit = "m", .range = "(0, inf)", .required = "0.1",
     .help = "of the ball"},
    {0},
};
static const SceneSection sphere = {.help = "everything within a sphere", .keys = sphere_keys};

static const SceneKey obstacle_keys[] = {
    {"name", SCENE_LABEL, AT(FemObstacleDef, name), .required = "ground",
     .help = "how messages and outputs call it"},
    {"halfspace", SCENE_SECTION, .section = &halfspace, MARK(FemObstacleDef, kind, FEM_OBSTACLE_HALFSPACE),
     .help = "a solid with a flat surface, without end"},
    {"sphere", SCENE_SECTION, .section = &sphere, MARK(FemObstacleDef, kind, FEM_OBSTACLE_BALL),
     .help = "or a ball, exactly round"},
    {"velocity", SCENE_VECTOR, AT(FemObstacleDef, motion.velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .excludes = "mesh motion", .help = "of the half-space or sphere; short for a `motion` of that velocity"},
    {"mesh", SCENE_SECTION, .offset = offsetof(FemObstacleDef, mesh_path), .section = &app_scene_keys_mesh,
     .help = "or a solid of tetrahedra: a file, or a box (`cells: 1` will do)"},
    {"place", SCENE_SECTION, AT(FemObstacleDef, placement), .section = &app_scene_keys_mesh_place,
     .needs = "mesh", .excludes = "halfspace sphere", .help = "where the mesh stands"},
    {"motion", SCENE_SECTION, AT(FemObstacleDef, motion), .absent_help = "it stands still",
     .section = &app_scene_keys_motion, .help = "how it moves; a half-space must not spin"},
    {0},
};
const SceneSection app_scene_keys_obstacle = {.help = "a rigid solid that bodies run into",
                                              .size = sizeof(FemObstacleDef),
                                              .keys = obstacle_keys,
                                              .one_of = "halfspace sphere mesh",
                                              .finish = finish_obstacle,
                                              PLACE(FemObstacleDef, place)};
