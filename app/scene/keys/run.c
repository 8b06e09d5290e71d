// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/table.h"

#include "app/scene/keys/choices.h"
#include "fem/scene/scene.h"

static const char *finish_time(void *self, const char **key) {
  static const double SHORTEST_SHARE = 1e-9; // of the end: a run of that many steps has no end
  const FemSceneDef *scene = self;
  *key = "max_step";
  if (scene->max_step > 0 && scene->max_step < SHORTEST_SHARE * scene->end)
    return "max_step is below 1e-9 of end: the run would take more than a billion steps";
  *key = "min_step";
  if (scene->max_step > 0 && scene->min_step > scene->max_step) return "min_step must not exceed max_step";
  *key = "initial_step";
  if (scene->max_step > 0 && scene->initial_step > scene->max_step)
    return "initial_step must not exceed max_step";
  if (scene->initial_step > 0 && scene->min_step > scene->initial_step)
    return "initial_step must not be below min_step";
  return NULL;
}

static const SceneKey time_keys[] = {
    {"end", SCENE_NUMBER, AT(FemSceneDef, end), .unit = "s", .range = "(0, inf)", .required = "0.5",
     .help = "the run goes from 0 to here"},
    {"static", SCENE_SWITCH, AT(FemSceneDef, is_static), .fallback = "false",
     .help =
         "equilibria at the times of the frames: no velocities, no mass; time is a parameter of the loads"},
    {"tolerance", SCENE_NUMBER, AT(FemSceneDef, tolerance), .range = "(0, 1)", .fallback = "1e-4",
     .help = "error of the positions per step, as a share of the smallest body's size; without contact 0.03 "
             "of that"},
    {"velocity_tolerance", SCENE_NUMBER, AT(FemSceneDef, velocity_tolerance), .unit = "m/s",
     .range = "(0, inf)",
     .absent_help =
         "0.03 · `tolerance` · √(E/ρ) of the slowest body (factor 1 with friction in self-contact) or, if "
         "smaller, 0.3 · `tolerance` times the fastest speed at t = 0 or, with gravity, √(g L), L the "
         "smallest body's size; with contact, if larger, 5 · `tolerance` times the present speed of the "
         "fastest body that it has pressed, at most `tolerance` · √(E/ρ) of the body itself; without contact "
         "33 times as much",
     .help = "error of the velocities per step"},
    {"max_step", SCENE_NUMBER, AT(FemSceneDef, max_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "0.1 of `end`", .help = "longest step"},
    {"initial_step", SCENE_NUMBER, AT(FemSceneDef, initial_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "the integrator's choice", .help = "first step"},
    {"min_step", SCENE_NUMBER, AT(FemSceneDef, min_step), .unit = "s", .range = "(0, inf)",
     .absent_help = "1e-12 of `end`",
     .help = "a run that needs shorter steps is given up; rows of tables closer than this count as one"},
    {"max_order", SCENE_INTEGER, AT(FemSceneDef, max_order), .range = "[1, 2]", .fallback = "2",
     .help = "of the backward differentiation formula; 1 damps more"},
    {0},
};
const SceneSection app_scene_keys_run_time = {
    .help = "duration and accuracy", .keys = time_keys, .finish = finish_time};

static const SceneKey start_keys[] = {
    {"run", SCENE_TEXT, AT(FemSceneDef, start), .required = "out/press",
     .help = "the folder that it wrote into, from the scene file; of the same bodies, with the same meshes"},
    {"outcome", SCENE_CHOICE, AT(FemSceneDef, starts_anyhow), .fallback = "finished",
     .choices = &app_scene_choices_outcomes, .help = "how it must have ended"},
    {0},
};
const SceneSection app_scene_keys_run_start = {
    .help = "the end state of another run", .keys = start_keys, .shorthand = "run"};

// The other names are of solvers that there are.
static const char *finish_solver(void *self, const char **key) {
  FemSceneDef *scene = self;
  int name = (int)scene->solver;
  *key = "linear";
  if (name == FEM_SOLVER_MUMPS) scene->solver = FEM_SOLVER_CHOLMOD;
  if (name == FEM_SOLVER_BLOCK_JACOBI) scene->solver = FEM_SOLVER_PCG;
  return NULL;
}

static const SceneKey solver_keys[] = {
    {"linear", SCENE_CHOICE, AT(FemSceneDef, solver), .fallback = "auto",
     .choices = &app_scene_choices_solvers, .help = "of the linear systems"},
    {"tolerance", SCENE_NUMBER, AT(FemSceneDef, solver_tolerance), .range = "(0, 1)",
     .absent_help =
         "1e-8 for `pcg`; for `amg` and `gamg` what Newton's method needs, 1e-4 to 0.03, in statics 1e-4",
     .help = "of iterative solvers: the residual over the right-hand side; a larger one costs Newton "
             "iterations, but no accuracy of the result"},
    {"threads", SCENE_INTEGER, AT(FemSceneDef, threads), .range = "[0, 4096]", .fallback = "0",
     .help = "0: one for each core"},
    {0},
};
const SceneSection app_scene_keys_run_solver = {
    .help = "linear algebra", .keys = solver_keys, .finish = finish_solver};

static const SceneKey checkpoint_keys[] = {
    {"frames", SCENE_INTEGER, AT(FemSceneDef, checkpoint_frames), .range = "[0, 1000000]", .absent = -1,
     .absent_help =
         "after 1e6 over the number of unknowns steps, at least 200, so that the cost is negligible",
     .help = "frames between two checkpoints, at each of which the integrator restarts; 0: none"},
    {"seconds", SCENE_NUMBER, AT(FemSceneDef, checkpoint_seconds), .unit = "s", .range = "[0, inf)",
     .fallback = "30",
     .help = "wall time: a checkpoint is written to disk when the last one is older than this"},
    {0},
};
static const SceneSection checkpoint = {
    .help = "what `tetlap resume` continues from", .keys = checkpoint_keys, .shorthand = "frames"};

static const SceneKey output_keys[] = {
    {"frames", SCENE_INTEGER, AT(FemSceneDef, frames), .range = "[1, 1000000]", .fallback = "50",
     .help = "written at i · end/frames, i = 0 … frames"},
    {"checkpoint", SCENE_SECTION, .section = &checkpoint, .help = "what `tetlap resume` continues from"},
    {"vtu", SCENE_SWITCH, AT(FemSceneDef, write_vtu), .fallback = "true",
     .help = "a VTU file per frame, for ParaView"},
    {"pieces", SCENE_SWITCH, AT(FemSceneDef, write_pieces), .fallback = "false",
     .help = "each rank writes a VTU file of its own elements, and a PVTU file per frame lists them"},
    {"history", SCENE_CHOICE, AT(FemSceneDef, history), .fallback = "frames",
     .choices = &app_scene_choices_histories,
     .help =
         "history.csv: energies, momentum, contact forces per frame or per step; true: frames, false: none"},
    {"status", SCENE_NAME, AT(FemSceneDef, status_reference), .choices = &app_scene_choices_overlaps,
     .absent_help = "not classified",
     .help = "which elements overlap by the scene's overlap model and by this one, at every frame"},
    {0},
};
const SceneSection app_scene_keys_run_output = {.help = "what is written", .keys = output_keys};
