// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/run/check/start.h"

#include <math.h>
#include <stdio.h>

#include "fem/model/limits.h"

// The largest covered share of an element of a body; 0 for what has no elements.
static double deepest_of(const FemModel *model, const double *covered, int body) {
  double deepest = 0;
  if (body >= model->scene->body_count) return 0;
  for (int e = model->bodies[body].tet_begin; e < model->bodies[body].tet_end; e++)
    deepest = fmax(deepest, covered[e] / model->volumes[e]);
  return deepest;
}

int fem_run_start_overlaps(const FemSystem *system, const ContactEvaluation *contact,
                           char texts[FEM_RUN_START_TOLD_COUNT][FEM_RUN_START_TEXT_SIZE]) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  if (!contact) return 0;
  int interface_count = contact_system_layout(fem_effect_contact_system(effect))->interface_count, count = 0;
  const ContactInterface *interfaces = contact->interfaces;
  const double *covered = contact->given_covered;
  double least = FEM_ROUNDING * pow(system->model->edge, 3), deepest_left = 0;
  for (int i = 0; i < interface_count; i++) {
    if (!(interfaces[i].volume > least)) continue;
    double deepest = fmax(deepest_of(system->model, covered, interfaces[i].a),
                          deepest_of(system->model, covered, interfaces[i].b));
    if (++count >= FEM_RUN_START_TOLD_COUNT) deepest_left = fmax(deepest_left, deepest);
    if (count > FEM_RUN_START_TOLD_COUNT) continue;
    snprintf(
        texts[count - 1], FEM_RUN_START_TEXT_SIZE,
        "'%s' and '%s' overlap at the start: %.3g m³ in %d pairs, up to %.3g %% of an element; they will "
        "be pushed apart at once: move them apart if that is not meant",
        fem_effect_contact_name(effect, interfaces[i].a), fem_effect_contact_name(effect, interfaces[i].b),
        interfaces[i].volume, interfaces[i].active_count, 100 * deepest);
  }
  if (count <= FEM_RUN_START_TOLD_COUNT) return count;
  snprintf(texts[FEM_RUN_START_TOLD_COUNT - 1], FEM_RUN_START_TEXT_SIZE,
           "%d more such pairs of bodies overlap at the start, by up to %.3g %% of an element",
           count - FEM_RUN_START_TOLD_COUNT + 1, 100 * deepest_left);
  return FEM_RUN_START_TOLD_COUNT;
}
