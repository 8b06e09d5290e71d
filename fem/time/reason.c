// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/reason.h"

#include <math.h>
#include <stdio.h>

#include "base/vec3.h"
#include "fem/model/limits.h"

// Of a tetrahedron, its volume over that at rest.
static double share_of(const FemModel *model, const double *positions, int tet) {
  Vec3 rest[4], now[4];
  for (int k = 0; k < 4; k++) {
    rest[k] = vec3_at(model->rest + 3 * (size_t)model->tets[tet][k]);
    now[k] = vec3_at(positions + 3 * (size_t)model->tets[tet][k]);
  }
  return vec3_det4(now[0], now[1], now[2], now[3]) / vec3_det4(rest[0], rest[1], rest[2], rest[3]);
}

// How many elements are flat or inside out, and what to do about them, as text; nothing where there are none.
static void name_inverted(const FemModel *model, const double *positions, char *text, size_t size) {
  int count = 0, first = -1;
  text[0] = 0;
  for (int e = 0; e < model->tet_count; e++)
    if (share_of(model, positions, e) <= FEM_ROUNDING && count++ == 0) first = e;
  if (first < 0) return;
  const FemModelBody *body = &model->bodies[model->tet_body[first]];
  snprintf(text, size, ". Elements flat or inside out: %d, element %d of body '%s' first: %s", count, first,
           body->name, fem_material_limit(fem_model_law(model, first)));
}

// The element with this vertex that is squeezed most, as text; nothing where there are no elements.
static void name_element(const FemModel *model, const double *positions, int vertex, char *text,
                         size_t size) {
  double least = INFINITY;
  text[0] = 0;
  for (int e = 0; e < model->tet_count; e++) {
    const int *v = model->tets[e];
    if (v[0] != vertex && v[1] != vertex && v[2] != vertex && v[3] != vertex) continue;
    double share = share_of(model, positions, e);
    if (!(share < least)) continue;
    least = share;
    snprintf(text, size, ", in element %d, which has %.3g of its rest volume", e, share);
  }
}

Status fem_reason_fail(const FemReason *reason, const FemSystem *system, const FemReasonPlace *place) {
  const FemModel *model = system->model;
  int dof = system->numbering.dof_of_unknown[place->unknown], vertex = dof / 3;
  const double *x = place->positions + 3 * vertex;
  const char *retry = place->retry, *advice = reason->advice;
  char element[96], inverted[400], worst[64] = "position";
  name_inverted(model, place->positions, inverted, sizeof inverted);
  name_element(model, place->positions, vertex, element, sizeof element);
  if (!place->is_position) snprintf(worst, sizeof worst, "velocity (%.3g m/s)", place->velocities[dof]);
  return status_fail(
      STATUS_SOLVER,
      "at t = %.9g s, step %.3g s: %s%s%s%s. Worst: %s of vertex %d of body '%s', now at (%.6g, %.6g, "
      "%.6g) m, %c%s%s. Try %s",
      place->time, place->step, reason->what, retry[0] ? " (last: " : "", retry, retry[0] ? ")" : "", worst,
      vertex, fem_model_body_name(model, vertex), x[0], x[1], x[2], "xyz"[dof % 3], element, inverted,
      advice);
}
