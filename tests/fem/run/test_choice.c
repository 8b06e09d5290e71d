// SPDX-License-Identifier: GPL-3.0-or-later
// fem/run/choice: which solver `auto` takes, and why.
#include "suite.h"

#include <string.h>

#include "fem/model/build.h"
#include "fem/run/choice.h"

typedef struct Case {
  int cells[3];
  double size[3], poisson;
  bool is_static;
  FemMaterialLaw law;
  FemSolverKind said, expected;
  const char *why;
} Case;

static const Case cases_of[] = {
    {{6, 6, 6},
     {1, 1, 1},
     0.3,
     false,
     FEM_MATERIAL_NEO_HOOKEAN,
     FEM_SOLVER_AUTO,
     FEM_SOLVER_CHOLMOD,
     "cheap"},
    {{18, 18, 18},
     {1, 1, 1},
     0.3,
     false,
     FEM_MATERIAL_NEO_HOOKEAN,
     FEM_SOLVER_AUTO,
     FEM_SOLVER_AMG,
     "longer"},
    {{18, 18, 18},
     {1, 1, 1},
     0.3,
     true,
     FEM_MATERIAL_NEO_HOOKEAN,
     FEM_SOLVER_AUTO,
     FEM_SOLVER_CHOLMOD,
     "cheap"},
    {{18, 18, 18}, {1, 1, 1}, 0.3, false, FEM_MATERIAL_LINEAR, FEM_SOLVER_AUTO, FEM_SOLVER_CHOLMOD, "cheap"},
    {{18, 18, 18},
     {1, 1, 1},
     0.49,
     false,
     FEM_MATERIAL_NEO_HOOKEAN,
     FEM_SOLVER_AUTO,
     FEM_SOLVER_CHOLMOD,
     "incompressible"},
    {{140, 6, 6},
     {20, 1, 1},
     0.3,
     false,
     FEM_MATERIAL_NEO_HOOKEAN,
     FEM_SOLVER_AUTO,
     FEM_SOLVER_CHOLMOD,
     "cheap"},
    {{18, 18, 18}, {1, 1, 1}, 0.3, false, FEM_MATERIAL_NEO_HOOKEAN, FEM_SOLVER_PCG, FEM_SOLVER_PCG, ""},
};

START_TEST(the_solver_follows_size_shape_and_what_is_solved) {
  const Case *c = &cases_of[_i];
  FemBodyDef body = {
      .name = "box",
      .placement = fem_mesh_placement_identity(),
      .material = {.law = c->law, .young = 1, .poisson = c->poisson, .density = 1, .damping = -1}};
  memcpy(body.box_size, c->size, sizeof body.box_size);
  memcpy(body.box_cells, c->cells, sizeof body.box_cells);
  FemSceneDef scene = {.bodies = &body, .body_count = 1, .is_static = c->is_static, .solver = c->said};
  FemModel model;
  ck_assert_ok(fem_model_create(&model, &scene));
  FemRunChoice choice = fem_run_choice(&model);
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
