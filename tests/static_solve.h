// SPDX-License-Identifier: GPL-3.0-or-later
// Linear statics for tests: one factorisation of K at rest, loads by the scene; the bending of a cantilever.
// And scenes from a text.
#ifndef TETLAP_TESTS_STATIC_SOLVE_H
#define TETLAP_TESTS_STATIC_SOLVE_H

#include <stdlib.h>
#include <string.h>

#include "fem/effect/system.h"
#include "fem/model/build.h"
#include "fem/sparse/solver.h"
#include "scene.h"
#include "scene_text.h"

// Reads and builds; `format` as printf's.
static inline void scene_open_text(SceneRun *run, const char *text) {
  *run = (SceneRun){0};
  ck_assert_ok(scene_text_read("test.yaml", text, strlen(text), &run->scene));
  ck_assert_ok(fem_model_create(&run->model, &run->scene));
}

// Displacements (vertex_count, 3) under the loads at t = 0, by one linear solve from rest; the caller frees.
static inline double *solve_linear_static(const FemModel *model) {
  FemSystem system;
  void *solver;
  size_t n = (size_t)model->free_count, values = 3 * (size_t)model->vertex_count;
  double *right = calloc(n, sizeof *right), *u = calloc(n, sizeof *u), *all = calloc(values, sizeof *all);
  ck_assert_ok(fem_system_create(&system, model));
  ck_assert_ok(fem_system_forces(&system, &system.accepted));
  for (size_t i = 0; i < n; i++) right[i] = system.forces[system.numbering.dof_of_unknown[i]];
  ck_assert_ok(fem_system_assemble(&system, &system.accepted, 1, 0, 0, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.create(&solver, 1, 1e-8));
  ck_assert_ok(fem_solver_cholmod.analyse(solver, &system.matrix));
  ck_assert_ok(fem_solver_cholmod.factorise(solver, &system.matrix, NULL, NULL, 0));
  ck_assert_ok(fem_solver_cholmod.solve(solver, right, u));
  for (size_t i = 0; i < n; i++) all[system.numbering.dof_of_unknown[i]] = u[i];
  fem_solver_cholmod.destroy(solver);
  fem_system_destroy(&system);
  free(right);
  free(u);
  return all;
}

// Tip deflection of a cantilever over Timoshenko's P L³/(3 E I) + P L/(k G A), k = 10(1 + ν)/(12 + 11 ν)
// (Cowper 1966), with `through` cubes through its thickness.
static inline double cantilever_deflection(const char *element, double nu, int through) {
  const double L = 5, P = 1e-4;
  char text[1024];
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: beam\n"
           "    element: %s\n"
           "    mesh: {box: {size: [5, 0.5, 1], cells: [%d, %d, %d]}}\n"
           "    material: {law: linear, young: 1, poisson: %g, density: 1}\n"
           "    fixed: [{group: x_min}]\n"
           "    loads: [{group: x_max, traction: [0, 0, -2e-4]}]\n",
           element, 5 * through, through / 2, through, nu);
  SceneRun run;
  scene_open_text(&run, text);
  double *u = solve_linear_static(&run.model), tip = 0;
  int count = 0;
  for (int a = 0; a < run.model.vertex_count; a++)
    if (run.model.rest[3 * a] == L) tip -= u[3 * a + 2], count++;
  free(u);
  scene_close(&run);
  double I = 0.5 / 12, A = 0.5, k = 10 * (1 + nu) / (12 + 11 * nu), G = 1 / (2 * (1 + nu));
  return tip / count / (P * L * L * L / (3 * I) + P * L / (k * G * A));
}

#endif
