// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/choices.h"

#include <stddef.h>

#include "contact/def.h"
#include "fem/material/material.h"
#include "fem/sparse/solver.h"
#include "overlap/models.h"
#include "overlap/source.h"

// The names that other layers own.

static const char *law_name(int i) {
  return i < FEM_MATERIAL_LAW_COUNT ? fem_material_name((FemMaterialLaw)i) : NULL;
}
static const char *law_help(int i) {
  return fem_material_help((FemMaterialLaw)i);
}
const SceneChoices app_scene_choices_laws = {.name = law_name, .help = law_help};

static const char *potential_name(int i) {
  return i < CONTACT_POTENTIAL_COUNT ? contact_def_potential_name((ContactPotential)i) : NULL;
}
static const char *potential_help(int i) {
  return contact_def_potential_help((ContactPotential)i);
}
const SceneChoices app_scene_choices_potentials = {.name = potential_name, .help = potential_help};

// Behind the kinds stand their other names (FemSolverAlias).
static const char *solver_name(int i) {
  static const char *const others[] = {"mumps", "block_jacobi"};
  if (i >= FEM_SOLVER_NAMES) return NULL;
  return i < FEM_SOLVER_COUNT ? fem_solver_name((FemSolverKind)i) : others[i - FEM_SOLVER_COUNT];
}
static const char *solver_help(int i) {
  static const char *const others[] = {
      "an exact factor, by MUMPS over ranks; in one process `cholmod`",
      "incomplete factors of each rank's block over ranks; in one process `pcg`"};
  return i < FEM_SOLVER_COUNT ? fem_solver_help((FemSolverKind)i) : others[i - FEM_SOLVER_COUNT];
}
const SceneChoices app_scene_choices_solvers = {.name = solver_name, .help = solver_help};

static const char *overlap_name(int i) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  return i < count ? models[i]->name : NULL;
}
static const char *overlap_help(int i) {
  int count;
  return overlap_models_list(&count)[i]->help;
}
const SceneChoices app_scene_choices_overlaps = {
    .name = overlap_name,
    .help = overlap_help,
    .accepts = overlap_source_has_form,
    .accepts_help = "a file NET.safetensors, MINE.so, MINE.py:NAME, MINE.onnx, or exec:COMMAND; each may have wrappers "
                    "before it, as in hybrid=geo and both=MINE.so"};

// Names of numbers and switches in a scene's definition.

const SceneChoices app_scene_choices_elements = {
    .listed = (const SceneChoice[]){
        {"linear", "constant strain; too stiff in bending, and above about ν = 0.45 altogether"},
        {"nodal", "linear, the volume change averaged at the vertices: for ν up to 0.499"},
        {"quadratic", "ten nodes, linear strain: bending with few elements, for ν up to 0.499; keeps the "
                      "curved edges of second-order files"},
        {0}}};

// The number is FemLoadDef.is_dead.
const SceneChoices app_scene_choices_followings = {
    .listed =
        (const SceneChoice[]){{"surface", "the surface as it is now: direction and area change with it"},
                              {"nothing", "the surface as it was at rest: a dead load"},
                              {0}}};

static const char *order_of_motion_name(int i) { // the number is FemConstraintDef.moves_first
  static const char *const names[] = {"turn_first", "move_first"};
  return i < 2 ? names[i] : NULL;
}
static const char *order_of_motion_help(int i) {
  return i == 0
             ? "turned about the axis, then displaced: the axis goes along"
             : "displaced, then turned about the axis, which stays where it is: the displacement turns, too";
}
const SceneChoices app_scene_choices_orders_of_motion = {.name = order_of_motion_name,
                                                         .help = order_of_motion_help};

// The number is FemSceneDef.starts_anyhow.
const SceneChoices app_scene_choices_outcomes = {
    .listed = (const SceneChoice[]){
        {"finished", "it reached its end"},
        {"any", "also one that failed or was interrupted: from the last state that it left"},
        {0}}};

// The number is FemSceneDef.history.
const SceneChoices app_scene_choices_histories = {
    .listed =
        (const SceneChoice[]){
            {"none", "no history"}, {"frames", "a row per frame"}, {"steps", "a row per accepted step"}, {0}},
    .takes_switch = true};
