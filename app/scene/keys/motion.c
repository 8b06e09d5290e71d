// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include <math.h>

#include "app/scene/keys/choices.h"
#include "fem/scene/scene.h"

static const char *finish_fixed(void *self, const char **key) {
  (void)key;
  ((FemConstraintDef *)self)->until = INFINITY;
  return NULL;
}

static const char *finish_driven(void *self, const char **key) {
  const FemConstraintDef *def = self;
  *key = "release";
  if (def->release > 0 && isfinite(def->until) && def->release < def->until)
    return "the vertices are released before their motion ends; take away `until`, or release them later";
  return NULL;
}

static const SceneKey prescribed_keys[] = {
    {"components", SCENE_AXES, AT(FemConstraintDef, components), .fallback = "[x, y, z]",
     .help = "the coordinates that are prescribed; the others stay free"},
    {"release", SCENE_NUMBER, AT(FemConstraintDef, release), .unit = "s", .range = "(0, inf)",
     .absent_help = "never", .help = "from then on the vertices are free, with the velocity that they have"},
    {0},
};
static const SceneSection prescribed_more = {.keys = prescribed_keys, .more = &app_scene_keys_select};
const SceneSection app_scene_keys_motion_fixed = {.help = "vertices that do not move",
                                                  .size = sizeof(FemConstraintDef),
                                                  .keys = prescribed_keys,
                                                  .more = &app_scene_keys_select,
                                                  .one_of = "box halfspace radius normal group all",
                                                  .finish = finish_fixed,
                                                  PLACE(FemConstraintDef, select.place)};

static const SceneKey formula_keys[] = {
    {"x", SCENE_FORMULA, AT(FemConstraintDef, formula[0]), .absent_help = "0",
     .help = "displacement along x"},
    {"y", SCENE_FORMULA, AT(FemConstraintDef, formula[1]), .absent_help = "0", .help = "along y"},
    {"z", SCENE_FORMULA, AT(FemConstraintDef, formula[2]), .absent_help = "0", .help = "along z"},
    {0},
};
static const SceneSection formula = {
    .help = "displacements [m] as functions of t [s]: + - * / ^, pi, sin cos tan exp log sqrt abs floor step "
            "smooth min max",
    .keys = formula_keys,
    .some_of = "x y z"};

static const SceneKey turn_keys[] = {
    {"axis", SCENE_DIRECTION, AT(FemConstraintDef, axis), .required = "[0, 0, 1]", .help = "of the turn"},
    {"centre", SCENE_VECTOR, AT(FemConstraintDef, centre), .unit = "m", .fallback = "[0, 0, 0]",
     .help = "a point on the axis"},
    {"angle", SCENE_FORMULA, AT(FemConstraintDef, angle), .unit = "rad", .help = "as a function of t [s]"},
    {"table", SCENE_PROFILE, AT(FemConstraintDef, angles), .unit = "s, rad",
     .count_offset = offsetof(FemConstraintDef, angle_count),
     .help = "or rows [t, angle], linear between them, constant before and after"},
    {0},
};
static const SceneSection turn = {
    .help = "a turn about an axis by an angle [rad], counter-clockwise seen against the axis",
    .keys = turn_keys,
    .one_of = "angle table"};

static const SceneKey motion_keys[] = {
    {"velocity", SCENE_VECTOR, AT(FemConstraintDef, velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .excludes = "table external", .help = "constant velocity"},
    {"amplitude", SCENE_VECTOR, AT(FemConstraintDef, amplitude), .unit = "m", .fallback = "[0, 0, 0]",
     .needs = "frequency", .excludes = "table external",
     .help = "of an oscillation amplitude · sin(2π frequency t)"},
    {"frequency", SCENE_NUMBER, AT(FemConstraintDef, frequency), .unit = "Hz", .range = "(0, inf)",
     .needs = "amplitude", .excludes = "table external", .help = "of the oscillation"},
    {"table", SCENE_ROWS, AT(FemConstraintDef, table), .unit = "s, m",
     .count_offset = offsetof(FemConstraintDef, table_count), .excludes = "external",
     .help = "rows [t, dx, dy, dz] of time and displacement, linear between them"},
    {"formula", SCENE_SECTION, .section = &formula, .excludes = "table external",
     .help = "displacements by formulas, added to velocity and amplitude"},
    {"spin", SCENE_NUMBER, AT(FemConstraintDef, spin), .unit = "rad/s", .fallback = "0", .needs = "axis",
     .excludes = "turn external", .help = "angular velocity about an axis"},
    {"axis", SCENE_DIRECTION, AT(FemConstraintDef, axis), .needs = "spin", .excludes = "turn",
     .help = "of the spin"},
    {"centre", SCENE_VECTOR, AT(FemConstraintDef, centre), .unit = "m", .fallback = "[0, 0, 0]",
     .needs = "spin", .excludes = "turn", .help = "a point on the axis"},
    {"turn", SCENE_SECTION, .section = &turn, MARK(FemConstraintDef, turns, true),
     .help = "or a turn by a formula or a table"},
    {"order", SCENE_CHOICE, AT(FemConstraintDef, moves_first), .fallback = "turn_first",
     .choices = &app_scene_choices_orders_of_motion, .help = "of a turn or spin and a displacement"},
    {"external", SCENE_TRUE, MARK(FemConstraintDef, is_external, true),
     .excludes = "velocity amplitude frequency table formula spin turn until",
     .help = "a displacement that whoever steps the run sets (docs/python.md); zero until then"},
    {"until", SCENE_NUMBER, AT(FemConstraintDef, until), .unit = "s", .range = "(0, inf]", .fallback = ".inf",
     .excludes = "external", .help = "when the motion stops; the position is then held"},
    {0},
};
const SceneSection app_scene_keys_motion = {.help = "a prescribed motion, from t = 0",
                                            .keys = motion_keys,
                                            .some_of = "velocity amplitude table formula spin turn external"};

const SceneSection app_scene_keys_motion_driven = {.help = "vertices with prescribed motion",
                                                   .size = sizeof(FemConstraintDef),
                                                   .keys = motion_keys,
                                                   .more = &prescribed_more,
                                                   .one_of = "box halfspace radius normal group all",
                                                   .some_of =
                                                       "velocity amplitude table formula spin turn external",
                                                   .finish = finish_driven,
                                                   PLACE(FemConstraintDef, select.place)};
