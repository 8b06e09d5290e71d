// SPDX-License-Identifier: GPL-3.0-or-later
// fem/run/check/choice.h: which solver `auto` takes, and why.
#include "suite.h"

#include <string.h>

#include "fem/model/build.h"
#include "fem/run/check/choice.h"

// A box of length `length` (0: 1), 1 and 1, neo-Hookean with ν = 0.3 unless it says otherwise.
typedef struct Case {
  int cells[3];
  FemSolverKind expected;
  const char *why; // a word of the reason
  double length, poisson;
  bool is_static, is_linear;
  FemSolverKind said; // by the scene
} Case;

static const Case cases_of[] = {
    {.cells = {6, 6, 6}, .expected = FEM_SOLVER_CHOLMOD, .why = "cheap"},
    {.cells = {18, 18, 18}, .expected = FEM_SOLVER_AMG, .why = "longer"},
    {.cells = {18, 18, 18}, .expected = FEM_SOLVER_CHOLMOD, .why = "cheap", .is_static = true},
    {.cells = {18, 18, 18}, .expected = FEM_SOLVER_CHOLMOD, .why = "cheap", .is_linear = true},
    {.cells = {18, 18, 18}, .expected = FEM_SOLVER_CHOLMOD, .why = "incompressible", .poisson = 0.49},
    {.cells = {140, 6, 6}, .expected = FEM_SOLVER_CHOLMOD, .why = "cheap", .length = 20},
    {.cells = {40, 40, 3}, .expected = FEM_SOLVER_CHOLMOD, .why = "cheap"}, // a plate
    {.cells = {18, 18, 18}, .expected = FEM_SOLVER_PCG, .why = "", .said = FEM_SOLVER_PCG},
};

START_TEST(the_solver_follows_size_shape_and_what_is_solved) {
  const Case *c = &cases_of[_i];
  FemBodyDef body = {.name = "box",
                     .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
                     .box_size = {c->length > 0 ? c->length : 1, 1, 1},
                     .material = {.law = c->is_linear ? FEM_MATERIAL_LINEAR : FEM_MATERIAL_NEO_HOOKEAN,
                                  .young = 1,
                                  .poisson = c->poisson > 0 ? c->poisson : 0.3,
                                  .density = 1,
                                  .damping = -1}};
  memcpy(body.box_cells, c->cells, sizeof body.box_cells);
  FemSceneDef scene = {.bodies = &body, .body_count = 1, .is_static = c->is_static, .solver = c->said};
  FemModel model;
  ck_assert_ok(fem_model_create(&model, &scene));
  FemRunChoice choice = fem_run_choice(&model, NULL);
  ck_assert_msg(choice.kind == c->expected, "%s, because: %s", fem_solver_name(choice.kind), choice.why);
  ck_assert_ptr_nonnull(strstr(choice.why, c->why));
  ck_assert(choice.bytes > fem_model_memory_estimate(&model));
  fem_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("choice");
  tcase_add_loop_test(cases, the_solver_follows_size_shape_and_what_is_solved, 0,
                      (int)(sizeof cases_of / sizeof *cases_of));
  return suite_run("choice", cases, 20);
}
