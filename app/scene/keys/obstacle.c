// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "fem/scene/scene.h"

static const char *finish_obstacle(void *self, const char **key) {
  FemObstacleDef *obstacle = self;
  for (int c = 0; c < 3; c++) obstacle->motion.components[c] = true;
  *key = "motion";
  bool turns = obstacle->motion.spin != 0 || obstacle->motion.turns;
  return turns && obstacle->kind == FEM_OBSTACLE_HALFSPACE ? "a half-space does not turn; use a box" : NULL;
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

static const SceneKey box_turn_keys[] = {
    {"axis", SCENE_DIRECTION, AT(FemPlacement, axis), .required = "[0, 0, 1]", .help = "through the centre"},
    {"degrees", SCENE_NUMBER, AT(FemPlacement, angle_degrees), .unit = "°", .required = "30",
     .help = "counter-clockwise seen against the axis"},
    {0},
};
static const SceneSection box_turn = {.help = "a rotation about the centre", .keys = box_turn_keys};

static const SceneKey box_keys[] = {
    {"centre", SCENE_VECTOR, AT(FemObstacleDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "at t = 0"},
    {"size", SCENE_VECTOR, AT(FemObstacleDef, size), .unit = "m", .range = "(0, inf)",
     .required = "[1, 1, 0.1]", .help = "edges; a half-space has no end"},
    {"rotate", SCENE_SECTION, .offset = offsetof(FemObstacleDef, turn), .absent_help = "along x, y, z",
     .section = &box_turn, .help = "how it stands at t = 0"},
    {0},
};
static const SceneSection box = {.help = "everything within a box", .keys = box_keys};

static const SceneKey cylinder_keys[] = {
    {"centre", SCENE_VECTOR, AT(FemObstacleDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "at t = 0"},
    {"axis", SCENE_DIRECTION, AT(FemObstacleDef, axis), .required = "[0, 0, 1]", .help = "at t = 0"},
    {"radius", SCENE_NUMBER, AT(FemObstacleDef, radius), .unit = "m", .range = "(0, inf)", .required = "0.1",
     .help = "of its section"},
    {"length", SCENE_NUMBER, AT(FemObstacleDef, length), .unit = "m", .range = "(0, inf)", .required = "0.5",
     .help = "along the axis; its ends are flat"},
    {0},
};
static const SceneSection cylinder = {.help = "everything within a cylinder", .keys = cylinder_keys};

static const SceneKey obstacle_keys[] = {
    {"name", SCENE_LABEL, AT(FemObstacleDef, name), .required = "ground",
     .help = "its name in messages and outputs"},
    {"halfspace", SCENE_SECTION, .section = &halfspace, MARK(FemObstacleDef, kind, FEM_OBSTACLE_HALFSPACE),
     .help = "a solid with an infinite plane surface"},
    {"sphere", SCENE_SECTION, .section = &sphere, MARK(FemObstacleDef, kind, FEM_OBSTACLE_BALL),
     .help = "or a ball, exactly round"},
    {"box", SCENE_SECTION, .section = &box, MARK(FemObstacleDef, kind, FEM_OBSTACLE_BOX),
     .help = "or a box without elements"},
    {"cylinder", SCENE_SECTION, .section = &cylinder, MARK(FemObstacleDef, kind, FEM_OBSTACLE_CYLINDER),
     .help = "or a cylinder, exactly round"},
    {"velocity", SCENE_VECTOR, AT(FemObstacleDef, motion.velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .excludes = "mesh motion", .help = "short for a `motion` of that velocity; for a mesh write `motion`"},
    {"mesh", SCENE_SECTION, .offset = offsetof(FemObstacleDef, mesh_path), .section = &app_scene_keys_mesh,
     .help = "or a solid of tetrahedra: a file, or a box (`cells: 1` is enough)"},
    {"place", SCENE_SECTION, AT(FemObstacleDef, placement), .section = &app_scene_keys_mesh_place,
     .needs = "mesh", .excludes = "halfspace sphere box cylinder", .help = "position of the mesh"},
    {"motion", SCENE_SECTION, AT(FemObstacleDef, motion), .absent_help = "it stands still",
     .section = &app_scene_keys_motion, .help = "how it moves; a half-space must not turn"},
    {0},
};
const SceneSection app_scene_keys_obstacle = {.help = "a rigid solid in contact with bodies",
                                              .size = sizeof(FemObstacleDef),
                                              .keys = obstacle_keys,
                                              .one_of = "halfspace sphere box cylinder mesh",
                                              .finish = finish_obstacle,
                                              PLACE(FemObstacleDef, place)};
