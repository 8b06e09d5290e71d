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
static const SceneSection select_box = {
    .help = "vertices in a box", .keys = select_box_keys, .finish = finish_select_box};

static const SceneKey select_halfspace_keys[] = {
    {"point", SCENE_VECTOR, AT(FemSelectDef, point), .unit = "m", .required = "[0, 0, 0]",
     .help = "on the plane"},
    {"normal", SCENE_DIRECTION, AT(FemSelectDef, normal), .required = "[0, 0, 1]",
     .help = "points away from the selected side"},
    {0},
};
static const SceneSection select_halfspace = {.help = "vertices on one side of a plane",
                                              .keys = select_halfspace_keys};

static const SceneKey select_keys[] = {
    {"box", SCENE_SECTION, .section = &select_box, MARK(FemSelectDef, kind, FEM_SELECT_BOX),
     .help = "the vertices in a box, as placed, at rest"},
    {"halfspace", SCENE_SECTION, .section = &select_halfspace, MARK(FemSelectDef, kind, FEM_SELECT_HALFSPACE),
     .help = "the vertices x with normal·(x − point) ≤ 0"},
    {"group", SCENE_TEXT, AT(FemSelectDef, group), MARK(FemSelectDef, kind, FEM_SELECT_GROUP),
     .help = "a named group of the mesh (`tetlap mesh FILE` lists them)"},
    {"all", SCENE_TRUE, MARK(FemSelectDef, kind, FEM_SELECT_ALL), .help = "every vertex of the body"},
    {0},
};
const SceneSection app_scene_keys_select = {.keys = select_keys};
