// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "fem/scene/scene.h"

static const char *finish_select_box(void *self, const char **key) {
  const FemSelectDef *select = self;
  *key = "max";
  for (int c = 0; c < 3; c++)
    if (!(select->box_min[c] <= select->box_max[c])) return "max must not be below min";
  return NULL;
}

// Whatever selects vertices has its selection first, so one table serves all.
_Static_assert(offsetof(FemConstraintDef, select) == 0 && offsetof(FemLoadDef, select) == 0,
               "a selection must be the first member");

static const SceneKey select_box_keys[] = {
    {"min", SCENE_VECTOR, AT(FemSelectDef, box_min), .unit = "m", .required = "[0, 0, 0]",
     .help = "lower corner"},
    {"max", SCENE_VECTOR, AT(FemSelectDef, box_max), .unit = "m", .required = "[1, 1, 0]",
     .help = "upper corner; the faces count as inside"},
    {0},
};
const SceneSection app_scene_keys_select_box = {
    .help = "what lies in a box", .keys = select_box_keys, .finish = finish_select_box};

static const SceneKey select_halfspace_keys[] = {
    {"point", SCENE_VECTOR, AT(FemSelectDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "on the plane"},
    {"normal", SCENE_DIRECTION, AT(FemSelectDef, normal), .required = "[0, 0, 1]",
     .help = "points away from the selected side"},
    {0},
};
const SceneSection app_scene_keys_select_halfspace = {.help = "what lies on one side of a plane",
                                                      .keys = select_halfspace_keys};

static const char *finish_select_radius(void *self, const char **key) {
  const FemSelectDef *select = self;
  *key = "max";
  return select->radius_min <= select->radius_max ? NULL : "max must not be below min";
}

static const SceneKey select_radius_keys[] = {
    {"centre", SCENE_VECTOR, AT(FemSelectDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "from which the distance counts"},
    {"axis", SCENE_DIRECTION, AT(FemSelectDef, normal), .absent_help = "none: a ball",
     .help = "the distance is from the line through the centre along it"},
    {"min", SCENE_NUMBER, AT(FemSelectDef, radius_min), .unit = "m", .range = "[0, inf)", .fallback = "0",
     .help = "least distance"},
    {"max", SCENE_NUMBER, AT(FemSelectDef, radius_max), .unit = "m", .range = "[0, inf]", .fallback = ".inf",
     .help = "largest distance; both count as inside"},
    {0},
};
const SceneSection app_scene_keys_select_radius = {.help = "what lies at a distance from a point or an axis",
                                                   .keys = select_radius_keys,
                                                   .some_of = "min max",
                                                   .finish = finish_select_radius};

static const SceneKey select_normal_keys[] = {
    {"direction", SCENE_DIRECTION, AT(FemSelectDef, normal), .required = "[0, 0, 1]",
     .help = "of outward normals"},
    {"degrees", SCENE_NUMBER, AT(FemSelectDef, degrees), .unit = "°", .range = "(0, 180]", .fallback = "1",
     .help = "largest angle of a normal with it"},
    {0},
};
static const SceneSection select_normal = {.help = "vertices of the surface by its normal",
                                           .keys = select_normal_keys};

static const SceneKey select_keys[] = {
    {"box", SCENE_SECTION, .section = &app_scene_keys_select_box, MARK(FemSelectDef, kind, FEM_SELECT_BOX),
     .help = "the vertices in a box, as placed, at rest"},
    {"halfspace", SCENE_SECTION, .section = &app_scene_keys_select_halfspace,
     MARK(FemSelectDef, kind, FEM_SELECT_HALFSPACE), .help = "the vertices x with normal·(x − point) ≤ 0"},
    {"radius", SCENE_SECTION, .section = &app_scene_keys_select_radius,
     MARK(FemSelectDef, kind, FEM_SELECT_RADIUS),
     .help = "the vertices at a distance from an axis or a point: rims, holes, balls"},
    {"normal", SCENE_SECTION, .section = &select_normal, MARK(FemSelectDef, kind, FEM_SELECT_NORMAL),
     .help = "the corners of the surface triangles that face a direction, as placed, at rest"},
    {"group", SCENE_TEXT, AT(FemSelectDef, group), MARK(FemSelectDef, kind, FEM_SELECT_GROUP),
     .help = "a named group of the mesh (`tetlap mesh FILE` lists them)"},
    {"all", SCENE_TRUE, MARK(FemSelectDef, kind, FEM_SELECT_ALL), .help = "every vertex of the body"},
    {0},
};
const SceneSection app_scene_keys_select = {.keys = select_keys};
