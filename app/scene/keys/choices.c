// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/choices.h"

#include <stddef.h>

#include "contact/def.h"
#include "fem/material/material.h"
#include "fem/sparse/solver.h"
#include "overlap/model.h"
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
  const OverlapOps *const *models = overlap_model_list(&count);
  return i < count ? models[i]->name : NULL;
}
static const char *overlap_help(int i) {
  int count;
  return overlap_model_list(&count)[i]->help;
}
const SceneChoices app_scene_choices_overlaps = {
    .name = overlap_name,
    .help = overlap_help,
    .accepts = overlap_source_has_form,
    .accepts_help = "a file NET.safetensors, MINE.so, MINE.py:NAME, or hybrid=NETWORK, exec:COMMAND"};

// Names of numbers and switches in a scene's definition.

static const char *hessian_name(int i) { // the number is FemContactDef.use_full_hessian
  static const char *const names[] = {"gauss_newton", "full"};
  return i < 2 ? names[i] : NULL;
}
static const char *hessian_help(int i) {
  return i == 0 ? "products of the first derivatives only: cheaper, more iterations"
                : "the second derivatives of the overlap volumes as well, where the model has them";
}
const SceneChoices app_scene_choices_hessians = {.name = hessian_name, .help = hessian_help};

static const char *element_name(int i) {
  static const char *const names[] = {"linear", "nodal", "quadratic"};
  return i < 3 ? names[i] : NULL;
}
static const char *element_help(int i) {
  static const char *const helps[] = {
      "constant strain; too stiff in bending, and above about ν = 0.45 altogether",
      "linear, the volume change averaged at the vertices: for ν up to 0.499",
      "ten nodes, linear strain: bending with few elements, for ν up to 0.499; keeps the curved edges of "
      "second-order files"};
  return helps[i];
}
const SceneChoices app_scene_choices_elements = {.name = element_name, .help = element_help};

static const char *following_name(int i) { // the number is FemLoadDef.is_dead
  static const char *const names[] = {"surface", "nothing"};
  return i < 2 ? names[i] : NULL;
}
static const char *following_help(int i) {
  return i == 0 ? "the surface as it is now: direction and area change with it"
                : "the surface as it was at rest: a dead load";
}
const SceneChoices app_scene_choices_followings = {.name = following_name, .help = following_help};

// The numbers are those of overlap/options.h.

static const char *ghosts_name(int i) {
  static const char *const names[] = {"auto", "keep", "cut", "fade"};
  return i < 4 ? names[i] : NULL;
}
static const char *ghosts_help(int i) {
  static const char *const helps[] = {"as the model has it: tpn keep, tpn-scene fade",
                                      "disjoint pairs have the volume that the network predicts",
                                      "an exact test sets it to 0, and V jumps at first contact",
                                      "an exact test sets it to 0, and V is faded in over the first overlap"};
  return helps[i];
}
const SceneChoices app_scene_choices_ghosts = {.name = ghosts_name, .help = ghosts_help};

static const char *gate_name(int i) {
  static const char *const names[] = {"auto", "none", "status"};
  return i < 3 ? names[i] : NULL;
}
static const char *gate_help(int i) {
  static const char *const helps[] = {"as the model has it: tpn-scene status, others none",
                                      "V is the output of the volume head",
                                      "V is multiplied by the probability from the status head"};
  return helps[i];
}
const SceneChoices app_scene_choices_gates = {.name = gate_name, .help = gate_help};

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
const SceneChoices app_scene_choices_orders = {.name = orders_name, .help = orders_help};

static const char *beyond_name(int i) {
  static const char *const names[] = {"auto", "count", "exact"};
  return i < 3 ? names[i] : NULL;
}
static const char *beyond_help(int i) {
  static const char *const helps[] = {"as the model has it: hybrid exact, others count",
                                      "they are counted in summary.json",
                                      "they are evaluated by the exact model, blended over a band"};
  return helps[i];
}
const SceneChoices app_scene_choices_beyond = {.name = beyond_name, .help = beyond_help};

static const char *coplanar_name(int i) {
  static const char *const names[] = {"auto", "keep", "clip"};
  return i < 3 ? names[i] : NULL;
}
static const char *coplanar_help(int i) {
  static const char *const helps[] = {
      "as the model has it: hybrid clip, others keep", "the network evaluates them like any other",
      "they are blended with clipping, the more the closer the faces are to coplanar"};
  return helps[i];
}
const SceneChoices app_scene_choices_coplanar = {.name = coplanar_name, .help = coplanar_help};

static const char *history_name(int i) { // the number is FemSceneDef.history
  static const char *const names[] = {"none", "frames", "steps"};
  return i < 3 ? names[i] : NULL;
}
static const char *history_help(int i) {
  static const char *const helps[] = {"no history", "a row per frame", "a row per accepted step"};
  return helps[i];
}
const SceneChoices app_scene_choices_histories = {history_name, history_help, .takes_switch = true};
