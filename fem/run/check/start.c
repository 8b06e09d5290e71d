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

int fem_run_start_overlap(const FemSystem *system, const ContactEvaluation *contact, int from, char *text,
                          size_t size) {
  void *effect = fem_system_effect(system, &fem_effect_contact);
  if (!contact) return -1;
  int count = contact_system_layout(fem_effect_contact_system(effect))->interface_count;
  const ContactInterface *interfaces = contact->interfaces;
  const double *covered = contact->given_covered;
  double least = FEM_ROUNDING * pow(system->model->edge, 3);
  for (int i = from; i < count; i++) {
    if (!(interfaces[i].volume > least)) continue;
    double deepest = fmax(deepest_of(system->model, covered, interfaces[i].a),
                          deepest_of(system->model, covered, interfaces[i].b));
    snprintf(
        text, size,
        "'%s' and '%s' overlap at the start: %.3g m³ in %d pairs, up to %.3g %% of an element; they will "
        "be pushed apart at once: move them apart if that is not meant",
        fem_effect_contact_name(effect, interfaces[i].a), fem_effect_contact_name(effect, interfaces[i].b),
        interfaces[i].volume, interfaces[i].active_count, 100 * deepest);
    return i;
  }
  return -1;
}
