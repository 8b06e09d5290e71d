// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene_keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contact/overlap.h"
#include "fem/solver.h"

// A field of a struct: offset and size.
#define AT(Type, field) offsetof(Type, field), sizeof(((Type *)0)->field)
// What a key marks when it is given.
#define MARK(Type, field, to) .mark = {AT(Type, field), to}
#define PLACE(Type, field) .has_place = true, .place_offset = offsetof(Type, field)

// The names that other layers own.

static const char *law_name(int i) {
  return i < FEM_MATERIAL_LAW_COUNT ? fem_material_name((FemMaterialLaw)i) : NULL;
}
static const char *law_help(int i) {
  return fem_material_help((FemMaterialLaw)i);
}
static const char *potential_name(int i) {
  return i < CONTACT_POTENTIAL_COUNT ? contact_potential_name((ContactPotential)i) : NULL;
}
static const char *potential_help(int i) {
  return contact_potential_help((ContactPotential)i);
}
static const char *solver_name(int i) {
  return i <= FEM_SOLVER_PCG ? fem_solver_name((FemSolverKind)i) : NULL;
}
static const char *solver_help(int i) {
  return fem_solver_help((FemSolverKind)i);
}
static const char *overlap_name(int i) {
  int count;
  const ContactOverlapOps *const *models = contact_overlap_list(&count);
  return i < count ? models[i]->name : NULL;
}
static const char *overlap_help(int i) {
  int count;
  return contact_overlap_list(&count)[i]->help;
}
static const char *hessian_name(int i) { // the number is FemContactDef.use_full_hessian
  static const char *const names[] = {"gauss_newton", "full"};
  return i < 2 ? names[i] : NULL;
}
static const char *hessian_help(int i) {
  return i == 0 ? "products of the first derivatives only: cheaper, more iterations"
                : "the second derivatives of the overlap volumes as well, where the model has them";
}

static const char *element_name(int i) {
  static const char *const names[] = {"linear", "nodal"};
  return i < 2 ? names[i] : NULL;
}
static const char *element_help(int i) {
  return i == 0 ? "constant strain; too stiff from about ν = 0.45"
                : "linear, the volume change averaged at the vertices: for ν up to 0.499";
}

static const char *following_name(int i) { // the number is FemLoadDef.is_dead
  static const char *const names[] = {"surface", "nothing"};
  return i < 2 ? names[i] : NULL;
}
static const char *following_help(int i) {
  return i == 0 ? "the surface as it is now: direction and area change with it"
                : "the surface as it was at rest: a dead load";
}

static const SceneChoices followings = {following_name, following_help};
static const SceneChoices elements = {element_name, element_help};
// The numbers are those of contact/net_options.h.
static const char *ghosts_name(int i) {
  static const char *const names[] = {"auto", "keep", "cut", "fade"};
  return i < 4 ? names[i] : NULL;
}
static const char *ghosts_help(int i) {
  static const char *const helps[] = {
      "as the model has it: tpn keep, tpn-scene fade", "pairs that share no volume get what the network says",
      "an exact test finds them: they get none, and V jumps where a pair begins to touch",
      "they get none, and V is faded in over the first overlap"};
  return helps[i];
}
static const char *gate_name(int i) {
  static const char *const names[] = {"auto", "none", "status"};
  return i < 3 ? names[i] : NULL;
}
static const char *gate_help(int i) {
  static const char *const helps[] = {"as the model has it: tpn-scene status, others none",
                                      "V is what the volume head says",
                                      "V is multiplied by the probability that the status head says"};
  return helps[i];
}
static const char *orders_name(int i) {
  static const char *const names[] = {"auto", "one", "both"};
  return i < 3 ? names[i] : NULL;
}
static const char *orders_help(int i) {
  static const char *const helps[] = {"as the model has it: tpn one, others both",
                                      "V(A, B) and V(B, A) differ",
                                      "the mean of V(A, B) and V(B, A), at twice the cost"};
  return helps[i];
}
static const char *beyond_name(int i) {
  static const char *const names[] = {"auto", "count", "exact"};
  return i < 3 ? names[i] : NULL;
}
static const char *beyond_help(int i) {
  static const char *const helps[] = {"as the model has it: hybrid exact, others count",
                                      "they are counted in summary.json",
                                      "and answered by the exact model, blended over a band"};
  return helps[i];
}

static const SceneChoices laws = {law_name, law_help};
static const SceneChoices potentials = {potential_name, potential_help};
static const SceneChoices solvers = {solver_name, solver_help};
static const SceneChoices overlaps = {overlap_name, overlap_help};
static const SceneChoices hessians = {hessian_name, hessian_help};
static const SceneChoices ghosts = {ghosts_name, ghosts_help};
static const SceneChoices gates = {gate_name, gate_help};
static const SceneChoices orders = {orders_name, orders_help};
static const SceneChoices beyond = {beyond_name, beyond_help};

// What no single key says.

static const char *finish_select_box(void *self, const char **key) {
  const FemSelectDef *select = self;
  *key = "max";
  for (int c = 0; c < 3; c++)
    if (!(select->box_min[c] <= select->box_max[c])) return "max must not be below min";
  return NULL;
}

static const char *finish_fixed(void *self, const char **key) {
  (void)key;
  ((FemConstraintDef *)self)->until = INFINITY;
  return NULL;
}

static const char *finish_ogden(void *self, const char **key) {
  const FemMaterial *material = self;
  double sum = 0;
  *key = "exponents";
  for (int p = 0; p < 3; p++) {
    if (material->shares[p] > 0 && material->exponents[p] == 0)
      return "an exponent with a share must not be 0";
    sum += material->shares[p];
  }
  *key = "shares";
  return sum > 0 ? NULL : "one share at least must be positive";
}

static const char *finish_material(void *self, const char **key) {
  const FemMaterial *material = self;
  *key = "plasticity";
  if (material->yield_stress > 0 && material->law != FEM_MATERIAL_STVK)
    return "plasticity is in the Green strain; write law: stvk beside it";
  *key = "fibre";
  if (material->fibre_stiffness > 0 && material->law == FEM_MATERIAL_LINEAR)
    return "fibres turn with the body, which the law linear cannot; write law: corotational, or another";
  return NULL;
}

static const char *finish_driven(void *self, const char **key) {
  const FemConstraintDef *def = self;
  *key = "release";
  if (def->release > 0 && isfinite(def->until) && def->release < def->until)
    return "the vertices are released before their motion ends; take away `until`, or release them later";
  return NULL;
}

static const char *finish_obstacle(void *self, const char **key) {
  FemObstacleDef *obstacle = self;
  for (int c = 0; c < 3; c++) obstacle->motion.components[c] = true;
  *key = "motion";
  bool turns = obstacle->kind == FEM_OBSTACLE_HALFSPACE && obstacle->motion.spin != 0;
  return turns ? "a half-space does not turn; use a mesh, a box for example" : NULL;
}

static const char *finish_time(void *self, const char **key) {
  const FemSceneDef *scene = self;
  *key = "min_step";
  if (scene->max_step > 0 && scene->min_step > scene->max_step) return "min_step must not exceed max_step";
  *key = "initial_step";
  if (scene->max_step > 0 && scene->initial_step > scene->max_step)
    return "initial_step must not exceed max_step";
  if (scene->initial_step > 0 && scene->min_step > scene->initial_step)
    return "initial_step must not be below min_step";
  return NULL;
}

// The tables: name, type, where the value goes, and what there is to say of it. A section without a place of
// its own has its keys in the same struct.

// Bodies and obstacles keep these fields in the same order, so one table serves both.
#define IN_MESH(field)                                                                                       \
  offsetof(FemBodyDef, field) - offsetof(FemBodyDef, mesh_path), sizeof(((FemBodyDef *)0)->field)
#define SAME_IN_MESH(field)                                                                                  \
  _Static_assert(offsetof(FemBodyDef, field) - offsetof(FemBodyDef, mesh_path) ==                            \
                     offsetof(FemObstacleDef, field) - offsetof(FemObstacleDef, mesh_path),                  \
                 "bodies and obstacles must lay out their meshes alike")
SAME_IN_MESH(box_size);
SAME_IN_MESH(box_cells);
SAME_IN_MESH(mesh_options);

static const SceneKey mesh_box_keys[] = {
    {"size", SCENE_VECTOR, IN_MESH(box_size), .unit = "m", .range = "(0, inf)", .required = "[0.2, 0.2, 0.2]",
     .help = "edges; the box is [0, size] before it is placed"},
    {"cells", SCENE_COUNTS, IN_MESH(box_cells), .range = "[1, 10000]", .required = "[4, 4, 4]",
     .help = "cubes along each edge, of six tetrahedra each; one number stands for three"},
    {0},
};
static const SceneSection mesh_box = {.help = "a box cut into tetrahedra", .keys = mesh_box_keys};

static const SceneKey mesh_keys[] = {
    {"file", SCENE_TEXT, IN_MESH(mesh_path),
     .help = "path from the scene file: .msh, .mesh, .vtk, .node/.ele; .stl and .geo are meshed in place"},
    {"size", SCENE_NUMBER, IN_MESH(mesh_options.size), .range = "(0, inf)", .absent_help = "gmsh's choice",
     .needs = "file", .help = "edge length for meshing .stl and .geo, in the file's units"},
    {"box", SCENE_SECTION, .section = &mesh_box, .help = "a box in place of a file"},
    {0},
};
static const SceneSection mesh = {
    .help = "tetrahedra: a file, or a box", .keys = mesh_keys, .shorthand = "file", .one_of = "file box"};

static const SceneKey rotate_keys[] = {
    {"axis", SCENE_DIRECTION, AT(FemPlacement, axis), .required = "[0, 0, 1]", .help = "through the origin"},
    {"degrees", SCENE_NUMBER, AT(FemPlacement, angle_degrees), .unit = "°", .required = "30",
     .help = "counter-clockwise seen against the axis"},
    {0},
};
static const SceneSection rotate = {.help = "a turn about an axis", .keys = rotate_keys};

static const SceneKey place_keys[] = {
    {"scale", SCENE_FACTORS, AT(FemPlacement, scale), .fallback = "1",
     .help = "first: a factor, or one for each axis; negative ones mirror"},
    {"rotate", SCENE_SECTION, .absent_help = "no turn", .section = &rotate, .help = "then"},
    {"translate", SCENE_VECTOR, AT(FemPlacement, translate), .unit = "m", .fallback = "[0, 0, 0]",
     .help = "last"},
    {0},
};
static const SceneSection place = {.help = "scaled, then turned, then moved", .keys = place_keys};

static const SceneKey ogden_keys[] = {
    {"exponents", SCENE_VECTOR, AT(FemMaterial, exponents), .fallback = "[2, -2, 4]",
     .help = "α of three terms; one with a share may not be 0"},
    {"shares", SCENE_VECTOR, AT(FemMaterial, shares), .range = "[0, inf)", .fallback = "[1, 0, 0]",
     .help = "of μ that the terms carry, taken by their sum"},
    {0},
};
static const SceneSection ogden = {
    .help = "powers of the principal stretches", .keys = ogden_keys, .finish = finish_ogden};

static const SceneKey fibre_keys[] = {
    {"modulus", SCENE_NUMBER, AT(FemMaterial, fibre_stiffness), .unit = "Pa", .range = "(0, inf)",
     .required = "1e6", .help = "k of the energy k/2 E² with E the Green strain along the fibres"},
    {"direction", SCENE_DIRECTION, AT(FemMaterial, fibre_direction), .required = "[1, 0, 0]",
     .help = "at rest, as placed"},
    {"buckle", SCENE_SWITCH, AT(FemMaterial, fibres_buckle), .fallback = "false",
     .help = "they resist tension only"},
    {0},
};
static const SceneSection fibre = {.help = "transverse isotropy", .keys = fibre_keys};

static const SceneKey plasticity_keys[] = {
    {"yield", SCENE_NUMBER, AT(FemMaterial, yield_stress), .unit = "Pa", .range = "(0, inf)",
     .required = "2e5", .help = "yield stress in tension"},
    {"hardening", SCENE_NUMBER, AT(FemMaterial, hardening), .unit = "Pa", .range = "[0, inf)",
     .fallback = "0", .help = "isotropic: rise of the yield stress by plastic strain"},
    {0},
};
static const SceneSection plasticity = {.help = "J2 plasticity (von Mises)", .keys = plasticity_keys};

static const SceneKey material_keys[] = {
    {"law", SCENE_CHOICE, AT(FemMaterial, law), .fallback = "neo_hookean", .choices = &laws,
     .help = "constitutive law"},
    {"young", SCENE_NUMBER, AT(FemMaterial, young), .unit = "Pa", .range = "(0, inf)", .required = "1e6",
     .help = "Young's modulus E"},
    {"poisson", SCENE_NUMBER, AT(FemMaterial, poisson), .range = "(-1, 0.5)", .required = "0.4",
     .help = "Poisson's ratio ν; linear tetrahedra lock from about 0.45, `element: nodal` does not"},
    {"density", SCENE_NUMBER, AT(FemMaterial, density), .unit = "kg/m³", .range = "(0, inf)",
     .required = "1000", .help = "ρ at rest"},
    {"damping", SCENE_NUMBER, AT(FemMaterial, damping), .unit = "s", .range = "[0, inf)", .absent = -1,
     .absent_help = "`effects.damping`", .help = "stiffness-proportional damping β"},
    {"viscosity", SCENE_NUMBER, AT(FemMaterial, viscosity), .unit = "Pa s", .range = "[0, inf)",
     .fallback = "0",
     .help = "η of a Kelvin-Voigt solid: viscous stress 2η times the strain rate's deviator"},
    {"bulk_viscosity", SCENE_NUMBER, AT(FemMaterial, bulk_viscosity), .unit = "Pa s", .range = "[0, inf)",
     .fallback = "0", .help = "ζ: viscous pressure by the rate of volume change"},
    {"mooney", SCENE_NUMBER, AT(FemMaterial, mooney), .range = "[0, 1]", .fallback = "0.2",
     .help = "of mooney_rivlin: the second invariant's share c2/(c1 + c2) of μ"},
    {"ogden", SCENE_SECTION, .section = &ogden, .help = "terms of the law ogden"},
    {"plasticity", SCENE_SECTION, .section = &plasticity, .absent_help = "elastic",
     .help = "beside the law stvk"},
    {"fibre", SCENE_SECTION, .section = &fibre, .absent_help = "no fibres",
     .help = "fibres along one direction"},
    {0},
};
static const SceneSection material = {
    .help = "an elastic solid", .keys = material_keys, .finish = finish_material};

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
static const SceneSection select_more = {.keys = select_keys};

static const SceneKey prescribed_keys[] = {
    {"components", SCENE_AXES, AT(FemConstraintDef, components), .fallback = "[x, y, z]",
     .help = "the coordinates that are prescribed; the others stay free"},
    {"release", SCENE_NUMBER, AT(FemConstraintDef, release), .unit = "s", .range = "(0, inf)",
     .absent_help = "never", .help = "from then on the vertices are free, with the velocity that they have"},
    {0},
};
static const SceneSection prescribed_more = {.keys = prescribed_keys, .more = &select_more};
static const SceneSection fixed = {.help = "vertices that do not move",
                                   .size = sizeof(FemConstraintDef),
                                   .keys = prescribed_keys,
                                   .more = &select_more,
                                   .one_of = "box halfspace group all",
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

static const SceneKey motion_keys[] = {
    {"velocity", SCENE_VECTOR, AT(FemConstraintDef, velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .excludes = "table", .help = "steady motion"},
    {"amplitude", SCENE_VECTOR, AT(FemConstraintDef, amplitude), .unit = "m", .fallback = "[0, 0, 0]",
     .needs = "frequency", .excludes = "table", .help = "of a swing amplitude · sin(2π frequency t)"},
    {"frequency", SCENE_NUMBER, AT(FemConstraintDef, frequency), .unit = "Hz", .range = "(0, inf)",
     .needs = "amplitude", .excludes = "table", .help = "of the swing"},
    {"table", SCENE_ROWS, AT(FemConstraintDef, table), .unit = "s, m",
     .count_offset = offsetof(FemConstraintDef, table_count),
     .help = "rows [t, dx, dy, dz] of time and displacement, linear between them"},
    {"formula", SCENE_SECTION, .section = &formula, .excludes = "table",
     .help = "displacements by formulas, added to velocity and amplitude"},
    {"spin", SCENE_NUMBER, AT(FemConstraintDef, spin), .unit = "rad/s", .fallback = "0", .needs = "axis",
     .help = "turning about an axis"},
    {"axis", SCENE_DIRECTION, AT(FemConstraintDef, axis), .needs = "spin", .help = "of the spin"},
    {"centre", SCENE_VECTOR, AT(FemConstraintDef, centre), .unit = "m", .fallback = "[0, 0, 0]",
     .needs = "spin", .help = "a point on the axis"},
    {"until", SCENE_NUMBER, AT(FemConstraintDef, until), .unit = "s", .range = "(0, inf]", .fallback = ".inf",
     .help = "when the motion stops; what was reached is held"},
    {0},
};
static const SceneSection motion = {.help = "a prescribed motion, from t = 0",
                                    .keys = motion_keys,
                                    .some_of = "velocity amplitude table formula spin"};

static const SceneSection driven = {.help = "vertices that move as told",
                                    .size = sizeof(FemConstraintDef),
                                    .keys = motion_keys,
                                    .more = &prescribed_more,
                                    .one_of = "box halfspace group all",
                                    .some_of = "velocity amplitude table formula spin",
                                    .finish = finish_driven,
                                    PLACE(FemConstraintDef, select.place)};

static const SceneKey load_keys[] = {
    {"force", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "body_force traction pressure", .unit = "N",
     MARK(FemLoadDef, kind, FEM_LOAD_FORCE), .help = "in all, shared evenly by the selected vertices"},
    {"body_force", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "force traction pressure",
     .unit = "N/m³", MARK(FemLoadDef, kind, FEM_LOAD_BODY_FORCE),
     .help = "on the volume (at rest) around the selected vertices"},
    {"traction", SCENE_VECTOR, AT(FemLoadDef, vector), .excludes = "force body_force pressure",
     .unit = "N/m²", MARK(FemLoadDef, kind, FEM_LOAD_TRACTION),
     .help = "on the area (at rest) of the surface triangles whose three corners are selected"},
    {"pressure", SCENE_NUMBER, AT(FemLoadDef, pressure), .unit = "Pa",
     MARK(FemLoadDef, kind, FEM_LOAD_PRESSURE),
     .help = "on the same triangles, against their outward normal"},
    {"follows", SCENE_CHOICE, AT(FemLoadDef, is_dead), .fallback = "surface", .choices = &followings,
     .needs = "pressure", .help = "what a pressure acts on"},
    {"factor", SCENE_FORMULA, AT(FemLoadDef, factor), .absent_help = "1", .excludes = "table",
     .help = "the load is this function of t [s] times the value above"},
    {"table", SCENE_PROFILE, AT(FemLoadDef, table), .count_offset = offsetof(FemLoadDef, table_count),
     .absent_help = "1", .excludes = "factor",
     .help = "or rows [t, factor], linear between them, constant before and after"},
    {0},
};
static const SceneSection load = {.help = "a load from outside",
                                  .size = sizeof(FemLoadDef),
                                  .keys = load_keys,
                                  .more = &select_more,
                                  .one_of = "box halfspace group all",
                                  .some_of = "force body_force traction pressure",
                                  PLACE(FemLoadDef, select.place)};

static const SceneKey body_keys[] = {
    {"name", SCENE_LABEL, AT(FemBodyDef, name), .required = "block",
     .help = "how messages and outputs call it"},
    {"mesh", SCENE_SECTION, .offset = offsetof(FemBodyDef, mesh_path), .required = "block.msh",
     .section = &mesh, .help = "its tetrahedra: a file's path, or more in a mapping"},
    {"place", SCENE_SECTION, AT(FemBodyDef, placement), .section = &place, .help = "where the mesh stands"},
    {"material", SCENE_SECTION, AT(FemBodyDef, material),
     .required = "{young: 1e6, poisson: 0.4, density: 1000}", .section = &material,
     .help = "what it is made of"},
    {"element", SCENE_CHOICE, AT(FemBodyDef, element), .fallback = "linear", .choices = &elements,
     .help = "how its tetrahedra resist"},
    {"self_contact", SCENE_SWITCH, AT(FemBodyDef, self_contact), .fallback = "false",
     .help =
         "its parts may touch each other; needs `contact`. Elements that share a vertex or overlap at rest "
         "never touch"},
    {"velocity", SCENE_VECTOR, AT(FemBodyDef, velocity), .unit = "m/s", .fallback = "[0, 0, 0]",
     .help = "at t = 0"},
    {"spin", SCENE_VECTOR, AT(FemBodyDef, spin), .unit = "rad/s", .fallback = "[0, 0, 0]",
     .help = "angular velocity about the centre of mass at t = 0"},
    {"fixed", SCENE_LIST, AT(FemBodyDef, fixed), .section = &fixed,
     .count_offset = offsetof(FemBodyDef, fixed_count), .help = "vertices that do not move"},
    {"driven", SCENE_LIST, AT(FemBodyDef, driven), .section = &driven,
     .count_offset = offsetof(FemBodyDef, driven_count), .help = "vertices that move as told"},
    {"loads", SCENE_LIST, AT(FemBodyDef, loads), .section = &load,
     .count_offset = offsetof(FemBodyDef, load_count), .help = "forces and pressures from outside"},
    {0},
};
static const SceneSection body = {
    .help = "an elastic body", .size = sizeof(FemBodyDef), .keys = body_keys, PLACE(FemBodyDef, place)};

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
    {"mesh", SCENE_SECTION, .offset = offsetof(FemObstacleDef, mesh_path), .section = &mesh,
     .help = "or a solid of tetrahedra: a file, or a box (`cells: 1` will do)"},
    {"place", SCENE_SECTION, AT(FemObstacleDef, placement), .section = &place, .needs = "mesh",
     .excludes = "halfspace sphere", .help = "where the mesh stands"},
    {"motion", SCENE_SECTION, AT(FemObstacleDef, motion), .absent_help = "it stands still",
     .section = &motion, .help = "how it moves; a half-space must not spin"},
    {0},
};
static const SceneSection obstacle = {.help = "a rigid solid that bodies run into",
                                      .size = sizeof(FemObstacleDef),
                                      .keys = obstacle_keys,
                                      .one_of = "halfspace sphere mesh",
                                      .finish = finish_obstacle,
                                      PLACE(FemObstacleDef, place)};

static const SceneKey time_keys[] = {
    {"end", SCENE_NUMBER, AT(FemSceneDef, end), .unit = "s", .range = "(0, inf)", .required = "0.5",
     .help = "the run goes from 0 to here"},
    {"static", SCENE_SWITCH, AT(FemSceneDef, is_static), .fallback = "false",
     .help =
         "equilibria at the times of the frames: no velocities, no mass; time is a parameter of the loads"},
    {"tolerance", SCENE_NUMBER, AT(FemSceneDef, tolerance), .range = "(0, 1)", .fallback = "1e-4",
     .help = "error of the positions per step, as a share of the smallest body's size"},
    {"velocity_tolerance", SCENE_NUMBER, AT(FemSceneDef, velocity_tolerance), .unit = "m/s",
     .range = "(0, inf)",
     .absent_help =
         "`tolerance` times √(E/ρ) of the slowest body, with friction at most 5 of its slip speeds",
     .help = "error of the velocities per step"},
    {"max_step", SCENE_NUMBER, AT(FemSceneDef, max_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "0.1 of `end`", .help = "longest step"},
    {"initial_step", SCENE_NUMBER, AT(FemSceneDef, initial_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "the integrator's choice", .help = "first step"},
    {"min_step", SCENE_NUMBER, AT(FemSceneDef, min_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "1e-11 of `end`", .help = "a run that needs shorter steps gives up"},
    {"max_order", SCENE_INTEGER, AT(FemSceneDef, max_order), .range = "[1, 2]", .fallback = "2",
     .help = "of the backward differentiation formula; 1 damps more"},
    {0},
};
static const SceneSection time_section = {
    .help = "how long, and how exactly", .keys = time_keys, .finish = finish_time};

static const SceneKey effect_keys[] = {
    {"gravity", SCENE_VECTOR, AT(FemSceneDef, gravity), .unit = "m/s²", .absent_help = "no gravity",
     MARK(FemSceneDef, has_gravity, true), .help = "acceleration of free fall"},
    {"damping", SCENE_NUMBER, AT(FemSceneDef, stiffness_damping), .unit = "s", .range = "[0, inf)",
     .fallback = "0", .help = "stiffness-proportional damping β of the bodies whose material gives none"},
    {0},
};
static const SceneSection effects = {.help = "what acts on all bodies", .keys = effect_keys};

static const SceneKey friction_keys[] = {
    {"coefficient", SCENE_NUMBER, AT(FemContactDef, friction), .range = "[0, inf)", .required = "0.3",
     .help = "Coulomb's μ: sliding resists with μ times the normal force"},
    {"slip_speed", SCENE_NUMBER, AT(FemContactDef, slip_speed), .unit = "m/s", .range = "(0, inf)",
     .absent_help = "1e-3 of the smallest body's size over `end`",
     .help = "slower slip counts as sticking: what sticks creeps, more slowly than this"},
    {0},
};
static const SceneSection friction = {
    .help = "Coulomb friction", .keys = friction_keys, .shorthand = "coefficient"};

static const SceneKey net_keys[] = {
    {"weights", SCENE_TEXT, AT(FemContactDef, net), .absent_help = "those that ship with the model",
     .help =
         "of a learned model: a .safetensors file, path from the scene file, or a name; taken in place of "
         "`overlap`, or by `hybrid` as its network"},
    {"ghosts", SCENE_CHOICE, AT(FemContactDef, net_options.ghosts), .fallback = "auto", .choices = &ghosts,
     .help = "tpn: volumes of pairs that share none"},
    {"gate", SCENE_CHOICE, AT(FemContactDef, net_options.gate), .fallback = "auto", .choices = &gates,
     .help = "tpn: whether the status head has a say in V"},
    {"orders", SCENE_CHOICE, AT(FemContactDef, net_options.orders), .fallback = "auto", .choices = &orders,
     .help = "tpn, hybrid: in which order the two tetrahedra are shown to the network"},
    {"out_of_range", SCENE_CHOICE, AT(FemContactDef, net_options.beyond), .fallback = "auto",
     .choices = &beyond, .help = "tpn: pairs unlike those of the network's training"},
    {"touch", SCENE_NUMBER, AT(FemContactDef, net_options.touch), .range = "(0, 1)", .fallback = "0.02",
     .help = "share of overlap up to which V is faded in; `hybrid` takes exact up to there, the network from "
             "twice "
             "that"},
    {"deep", SCENE_NUMBER, AT(FemContactDef, net_options.deep), .range = "(0, 2]", .fallback = "0.3",
     .help =
         "hybrid: share of overlap up to which the network is taken, exact from one and a half times that"},
    {"confidence", SCENE_NUMBER, AT(FemContactDef, net_options.confidence), .range = "(0.5, 1)",
     .fallback = "0.95", .help = "hybrid: probability of the status head from which the network is taken"},
    {0},
};
static const SceneSection net = {
    .help = "how networks that follow the paper are used", .keys = net_keys, .shorthand = "weights"};

static const SceneKey contact_keys[] = {
    {"stiffness", SCENE_NUMBER, AT(FemContactDef, stiffness), .unit = "Pa", .range = "(0, inf)",
     .absent_help = "E of the softest body (with `body` over its smallest mean element volume)",
     .help = "penalty κ; higher: less overlap, shorter steps (Pa/m³ with the potential `body`)"},
    {"potential", SCENE_CHOICE, AT(FemContactDef, potential), .fallback = "nodal", .choices = &potentials,
     .help = "how overlap volumes become pressure"},
    {"overlap", SCENE_NAME, AT(FemContactDef, overlap), .fallback = "geo", .choices = &overlaps,
     .help = "the model that gives the overlap volume of two tetrahedra"},
    {"net", SCENE_SECTION, .section = &net, .help = "of a learned model: its weights, or more in a mapping"},
    {"margin", SCENE_NUMBER, AT(FemContactDef, margin), .unit = "m", .range = "(0, inf)",
     .absent_help = "half the shortest mean edge of a body",
     .help = "pairs nearer than this are listed; a step that moves farther is tried again smaller"},
    {"hessian", SCENE_CHOICE, AT(FemContactDef, use_full_hessian), .fallback = "full", .choices = &hessians,
     .help = "derivatives of the contact force for Newton's method"},
    {"friction", SCENE_SECTION, .section = &friction, .absent_help = "no friction",
     .help = "what touches resists sliding; a number alone is its coefficient"},
    {"viscosity", SCENE_NUMBER, AT(FemContactDef, viscosity), .unit = "Pa s", .range = "(0, inf)",
     .absent_help = "none",
     .help =
         "η: a pressure η w dw/dt beside κ w, w the covered share of a vertex; takes energy out of impacts"},
    {0},
};
static const char *finish_contact(void *self, const char **key) {
  const FemContactDef *contact = self;
  if (contact->viscosity > 0 && contact->potential != CONTACT_POTENTIAL_NODAL) {
    *key = "viscosity";
    return "viscosity builds on the potential nodal; take one of the two keys away";
  }
  return NULL;
}
static const SceneSection contact = {
    .help = "bodies push each other apart", .keys = contact_keys, .finish = finish_contact};

static const SceneKey solver_keys[] = {
    {"linear", SCENE_CHOICE, AT(FemSceneDef, solver), .fallback = "auto", .choices = &solvers,
     .help = "of the linear systems"},
    {"tolerance", SCENE_NUMBER, AT(FemSceneDef, solver_tolerance), .range = "(0, 1)", .fallback = "1e-8",
     .help = "relative residual of `pcg`"},
    {"threads", SCENE_INTEGER, AT(FemSceneDef, threads), .range = "[0, 4096]", .fallback = "0",
     .help = "0: one for each core"},
    {0},
};
static const SceneSection solver = {.help = "linear algebra", .keys = solver_keys};

static const SceneKey checkpoint_keys[] = {
    {"frames", SCENE_INTEGER, AT(FemSceneDef, checkpoint_frames), .range = "[0, 1000000]", .absent = -1,
     .absent_help =
         "a checkpoint after so many steps that it is not felt: 1e6 over the unknowns, 200 at least",
     .help = "so many frames lie between two checkpoints, at each of which the integrator begins anew; 0: "
             "none"},
    {"seconds", SCENE_NUMBER, AT(FemSceneDef, checkpoint_seconds), .unit = "s", .range = "[0, inf)",
     .fallback = "30", .help = "wall time: a checkpoint is written to the disk when the last one is so old"},
    {0},
};
static const SceneSection checkpoint = {
    .help = "what `tetlap resume` goes on from", .keys = checkpoint_keys, .shorthand = "frames"};

static const SceneKey output_keys[] = {
    {"frames", SCENE_INTEGER, AT(FemSceneDef, frames), .range = "[1, 1000000]", .fallback = "50",
     .help = "written at i · end/frames, i = 0 … frames"},
    {"checkpoint", SCENE_SECTION, .section = &checkpoint, .help = "what `tetlap resume` goes on from"},
    {"vtu", SCENE_SWITCH, AT(FemSceneDef, write_vtu), .fallback = "true",
     .help = "a VTU file a frame, for ParaView"},
    {"history", SCENE_SWITCH, AT(FemSceneDef, write_history), .fallback = "true",
     .help = "history.csv: energies, momentum, contact forces per frame"},
    {"status", SCENE_NAME, AT(FemSceneDef, status_reference), .choices = &overlaps,
     .absent_help = "not asked",
     .help = "which elements overlap by the scene's overlap model and by this one, at every frame"},
    {0},
};
static const SceneSection output = {.help = "what is written", .keys = output_keys};

static const SceneKey scene_keys[] = {
    {"title", SCENE_TEXT, AT(FemSceneDef, title), .help = "a line for people"},
    {"time", SCENE_SECTION, .required = "{end: 0.5}", .section = &time_section,
     .help = "how long, and how exactly"},
    {"effects", SCENE_SECTION, .section = &effects, .help = "what acts on all bodies"},
    {"bodies", SCENE_LIST, AT(FemSceneDef, bodies),
     .required = "[{name: block, mesh: block.msh, material: {young: 1e6, poisson: 0.4, density: 1000}}]",
     .section = &body, .count_offset = offsetof(FemSceneDef, body_count),
     .help = "the elastic bodies, one at least"},
    {"obstacles", SCENE_LIST, AT(FemSceneDef, obstacles), .section = &obstacle,
     .count_offset = offsetof(FemSceneDef, obstacle_count), .help = "rigid solids that bodies run into"},
    {"contact", SCENE_SECTION, AT(FemSceneDef, contact), .absent_help = "no contact", .section = &contact,
     MARK(FemSceneDef, contact.is_on, true), .help = "bodies push each other apart; `{}` for the defaults"},
    {"solver", SCENE_SECTION, .section = &solver, .help = "linear algebra"},
    {"output", SCENE_SECTION, .section = &output, .help = "what is written"},
    {0},
};
const SceneSection app_scene_keys_root = {
    .help = "A scene.", .size = sizeof(FemSceneDef), .keys = scene_keys};

// Looking things up.

const SceneKey *app_scene_keys_at(const SceneSection *section, int index) {
  int count = 0;
  while (section->keys[count].name) {
    if (count == index) return &section->keys[index];
    count++;
  }
  return section->more ? app_scene_keys_at(section->more, index - count) : NULL;
}

const SceneKey *app_scene_keys_find(const SceneSection *section, const char *name) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++)
    if (strcmp(key->name, name) == 0) return key;
  return NULL;
}

bool app_scene_keys_locate(const SceneSection *section, const char *name, char *path, size_t size) {
  if (app_scene_keys_find(section, name)) {
    snprintf(path, size, "%s", name);
    return true;
  }
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    char below[128];
    if (!key->section || !app_scene_keys_locate(key->section, name, below, sizeof below)) continue;
    snprintf(path, size, "%s%s.%s", key->name, key->type == SCENE_LIST ? "[]" : "", below);
    return true;
  }
  return false;
}

int app_scene_keys_row_width(const SceneKey *key) {
  return key->type == SCENE_PROFILE ? 2 : 4;
}

SceneRange app_scene_keys_range(const SceneKey *key) {
  if (!key->range) return (SceneRange){-INFINITY, INFINITY, true, true};
  char *end;
  SceneRange range = {.is_min_open = key->range[0] == '('};
  range.min = strtod(key->range + 1, &end);
  range.max = strtod(end + 1, &end);
  range.is_max_open = end[0] == ')';
  return range;
}

bool app_scene_keys_allows(const SceneKey *key, double number) {
  SceneRange range = app_scene_keys_range(key);
  bool is_above = range.is_min_open ? number > range.min : number >= range.min;
  bool is_below = range.is_max_open ? number < range.max : number <= range.max;
  return is_above && is_below;
}

int app_scene_keys_choice(const SceneKey *key, const char *name) {
  const char *known;
  for (int i = 0; (known = key->choices->name(i)); i++)
    if (strcmp(known, name) == 0) return i;
  return -1;
}

static const char *type_text(SceneType type) {
  switch (type) {
  case SCENE_NUMBER:
    return "a number";
  case SCENE_INTEGER:
    return "a whole number";
  case SCENE_SWITCH:
    return "true or false";
  case SCENE_TRUE:
    return "true";
  case SCENE_TEXT:
    return "text";
  case SCENE_LABEL:
    return "a name of letters, digits, '_' and '-'";
  case SCENE_NAME:
  case SCENE_CHOICE:
    return "one of ";
  case SCENE_VECTOR:
    return "three numbers [x, y, z]";
  case SCENE_DIRECTION:
    return "a direction [x, y, z], not zero";
  case SCENE_FACTORS:
    return "a number or three [x, y, z], none zero";
  case SCENE_COUNTS:
    return "a whole number or three [x, y, z]";
  case SCENE_AXES:
    return "a list of some of x, y, z";
  case SCENE_ROWS:
    return "rows [t, x, y, z] of four numbers, t increasing";
  case SCENE_PROFILE:
    return "rows [t, value] of two numbers, t increasing";
  case SCENE_FORMULA:
    return "a number or a formula of t, like 'sin(2*pi*t)'";
  case SCENE_SECTION:
    return "a mapping {key: value}";
  case SCENE_LIST:
    return "a list of mappings";
  }
  return "";
}

void app_scene_keys_expect(const SceneKey *key, char *text, size_t size) {
  size_t used = 0;
  text_append(text, size, &used, "%s", type_text(key->type));
  const char *name;
  for (int i = 0; key->choices && (name = key->choices->name(i)); i++)
    text_append(text, size, &used, "%s%s", i ? ", " : "", name);
  if (key->section && key->section->shorthand)
    text_append(text, size, &used, " or %s (its '%s')",
                type_text(app_scene_keys_find(key->section, key->section->shorthand)->type),
                key->section->shorthand);
  if (key->range) text_append(text, size, &used, " in %s", key->range);
  if (key->unit) text_append(text, size, &used, " [%s]", key->unit);
}
