// SPDX-License-Identifier: GPL-3.0-or-later
// What the effects that a scene does not call for cost it: two programs of this source, one with the registry
// of fem/effect/effect.c, the other (FRAME_COST_FEW) with elasticity alone, run one scene and print the
// processor time of a step [s]. tools/measure/frame_cost builds both and compares them in turns.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "app/scene/read.h"
#include "fem/effect/effect.h"
#include "fem/model/build.h"
#include "fem/model/model.h"
#include "fem/run/run.h"

#ifdef FRAME_COST_FEW
static const FemEffectOps *const few[] = {&fem_effect_elasticity};

const FemEffectOps *const *fem_effect_list(int *count) {
  *count = 1;
  return few;
}
#endif

static int fail(void) {
  fprintf(stderr, "%s\n", status_message());
  return EXIT_FAILURE;
}

int main(int argument_count, char **arguments) {
  FemSceneDef scene;
  FemModel model;
  FemRunResult result;
  if (argument_count != 2) return fprintf(stderr, "usage: %s SCENE\n", arguments[0]), EXIT_FAILURE;
  if (app_scene_read(arguments[1], NULL, 0, &scene) || fem_model_create(&model, &scene)) return fail();
  clock_t start = clock();
  if (fem_run(&model, &(FemRunOptions){0}, &result)) return fail();
  printf("%.9g %lld\n", (double)(clock() - start) / CLOCKS_PER_SEC / (double)result.integrator.steps,
         (long long)result.integrator.steps);
  fem_run_result_destroy(&result);
  fem_model_destroy(&model);
  fem_scene_destroy(&scene);
  return EXIT_SUCCESS;
}
