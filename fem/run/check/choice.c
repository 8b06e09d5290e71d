// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/check/choice.h"

#include <math.h>

#include "fem/model/work.h"

// Vertices of two cubes in contact from which on `amg` takes less processor time than `cholmod` in motion,
// PETSc's start of 0.2 s included; in statics from twice as many.
static const double AMG_IS_FASTER_FROM = FEM_WORK_UNCOUNTED;
// Twice that, since a factor cannot fail to converge.
static const double MOST_IN_MOTION = 2 * AMG_IS_FASTER_FROM, MOST_IN_STATICS = 2 * MOST_IN_MOTION;
// A scene whose matrix never changes is factorised once a step size.
static const double MOST_IF_LINEAR = 40000;
// As volumes become incompressible multigrid takes ever more iterations.
static const double SOFTEST_POISSON = 0.47;

// Vertices of a cube whose factor costs as much, beside multigrid, as those of all bodies that move.
static double equivalent_cube(const FemModel *model, const FemNumbering *now) {
  double sum = 0;
  for (int b = 0; b < model->body_count; b++)
    if (!model->bodies[b].is_obstacle && !(now && now->is_held[b]))
      sum += model->bodies[b].cube * model->bodies[b].cube;
  return sqrt(sum);
}

static bool is_nearly_incompressible(const FemModel *model) {
  for (int p = 0; p < model->part_count; p++)
    if (model->parts[p].material.poisson > SOFTEST_POISSON) return true;
  return false;
}

static FemSolverKind choose(const FemModel *model, const FemNumbering *now, const char **why) {
  const FemSceneDef *scene = model->scene;
  bool is_large = (now ? now->count : model->free_count) > FEM_WORK_UNKNOWNS;
  bool is_linear = fem_model_has_linear_materials(model) && !scene->contact.is_on;
  double cube = equivalent_cube(model, now);
  double most = is_linear ? MOST_IF_LINEAR : scene->is_static ? MOST_IN_STATICS : MOST_IN_MOTION;
  *why = "its factor is cheap";
  if (!is_large && cube <= most) return FEM_SOLVER_CHOLMOD;
  *why = "nearly incompressible";
  if (!is_large && is_nearly_incompressible(model)) return FEM_SOLVER_CHOLMOD;
  *why = "a factor would take longer";
  if (fem_solver_has_multigrid()) return FEM_SOLVER_AMG;
  *why = "PETSc, which amg needs, is not installed";
  return is_large ? FEM_SOLVER_PCG : FEM_SOLVER_CHOLMOD;
}

static double solver_bytes(const FemModel *model, FemSolverKind kind) {
  double unknowns = model->free_count;
  switch (kind) {
  case FEM_SOLVER_AMG:
  case FEM_SOLVER_GAMG: // measured: PETSc itself, and what the levels take beyond what assembly took before
    return 2.7e7 + 400 * unknowns; // not chosen: measured
  case FEM_SOLVER_PCG:
    return 15 * sizeof(double) * unknowns;
  default:
    // Nested dissection in three dimensions: O(n^{4/3}) factor entries (George 1973); the constant is
    // measured, with what CHOLMOD needs beside the factor.
    return 25 * pow(unknowns, 4.0 / 3) * sizeof(double); // not chosen: measured
  }
}

// Measured, a ball in a block of 22,000 vertices on two and four ranks (a beam of 47,000 on two: 3 % less):
// what each rank has at its start, of the whole, and of its share with the levels of BoomerAMG [bytes].
static const double RANK_BYTES = 5.2e7;             // not chosen: measured
static const double WHOLE_BYTES_A_VERTEX = 1750;    // not chosen: measured
static const double SHARED_BYTES_AN_UNKNOWN = 1670; // not chosen: measured
// Without the solver's.
static const double ADDED_BYTES_AN_UNKNOWN = 1200; // not chosen: measured

FemRunChoice fem_run_choice_over(const FemModel *model, int rank_count) {
  FemRunChoice choice = {.kind = model->scene->solver, .why = ""};
  if (choice.kind == FEM_SOLVER_AUTO) choice.kind = FEM_SOLVER_AMG, choice.why = "ranks share it";
  double shared = choice.kind == FEM_SOLVER_CHOLMOD
                      ? ADDED_BYTES_AN_UNKNOWN * model->free_count + solver_bytes(model, choice.kind)
                      : SHARED_BYTES_AN_UNKNOWN * model->free_count;
  choice.bytes = RANK_BYTES + WHOLE_BYTES_A_VERTEX * model->vertex_count + shared / rank_count;
  return choice;
}

FemRunChoice fem_run_choice(const FemModel *model, const FemNumbering *now) {
  if (model->share) return fem_run_choice_over(model, model->share->rank_count);
  FemRunChoice choice = {.kind = model->scene->solver, .why = ""};
  if (choice.kind == FEM_SOLVER_AUTO) choice.kind = choose(model, now, &choice.why);
  choice.bytes = fem_model_memory_estimate(model) + solver_bytes(model, choice.kind);
  return choice;
}
