// SPDX-License-Identifier: GPL-3.0-or-later
// Linear statics for tests: one factorisation of K at rest, loads by the scene. And scenes from a text.
#ifndef TETLAP_TESTS_STATIC_SOLVE_H
#define TETLAP_TESTS_STATIC_SOLVE_H

#include <stdlib.h>
#include <string.h>

#include "fem/solver.h"
#include "fem/system.h"
#include "scene.h"

// Reads and builds; `format` as printf's.
static inline void scene_open_text(SceneRun *run, const char *text) {
  *run = (SceneRun){0};
  ck_assert_ok(app_scene_read_text("test.yaml", text, strlen(text), &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
}

// Displacements (vertex_count, 3) under the loads at t = 0, by one linear solve from rest; the caller frees.
static inline double *solve_linear_static(const FemModel *model) {
  FemSystem system;
  void *solver;
  size_t n = (size_t)model->unknown_count, values = 3 * (size_t)model->vertex_count;
  double *right = calloc(n, sizeof *right), *u = calloc(n, sizeof *u), *all = calloc(values, sizeof *all);
  ck_assert_ok(fem_system_create(&system, model));
  fem_system_scatter(&system, 0, u, u);
  ck_assert_ok(fem_system_forces(&system, 0));
  for (size_t i = 0; i < n; i++) right[i] = system.forces[model->dof_of_unknown[i]];
  ck_assert_ok(fem_system_assemble(&system, 0, 1, 0, 0, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.create(&solver, 1, 1e-8));
  ck_assert_ok(fem_solver_cholmod.analyse(solver, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.factorise(solver, &system.matrix, NULL, NULL, 0));
  ck_assert_ok(fem_solver_cholmod.solve(solver, right, u));
  for (size_t i = 0; i < n; i++) all[model->dof_of_unknown[i]] = u[i];
  fem_solver_cholmod.destroy(solver);
  fem_system_destroy(&system);
  free(right);
  free(u);
  return all;
}

#endif
