// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/error_weights.h"

#include <math.h>

// The unknowns of a body: begin … *end, in the order of the bodies.
static void find_end(const FemModel *model, int body, int begin, int *end) {
  *end = begin;
  while (*end < model->unknown_count && model->dof_of_unknown[*end] / 3 < model->bodies[body].vertex_end)
    (*end)++;
}

// √(Σ m v² / Σ m) over unknowns of a body; 0 without any, INFINITY where a velocity is no number.
static double speed_of(const FemModel *model, const double *v, int begin, int end) {
  double momentum = 0, mass = 0;
  for (int i = begin; i < end; i++) {
    double m = model->mass[model->dof_of_unknown[i] / 3];
    momentum += m * v[i] * v[i];
    mass += m;
  }
  // A coordinate's mean square is a third of a vertex's.
  double square = mass > 0 ? 3 * momentum / mass : 0;
  return isfinite(square) ? sqrt(square) : INFINITY;
}

static double fastest(const FemModel *model, const double *v) {
  double speed = 0;
  for (int b = 0, begin = 0, end; b < model->body_count; b++, begin = end) {
    find_end(model, b, begin, &end);
    speed = fmax(speed, speed_of(model, v, begin, end));
  }
  return speed;
}

void fem_error_weights(const FemErrorTolerance *tolerance, const FemModel *model, const double *v,
                       double *weights) {
  int n = model->unknown_count;
  double wanted = tolerance->speed_share > 0 ? tolerance->speed_share * fastest(model, v) : 0;
  for (int b = 0, begin = 0, end; b < model->body_count; b++, begin = end) {
    find_end(model, b, begin, &end);
    const FemMaterial *material = &model->bodies[b].material;
    double most = tolerance->wave_share * sqrt(material->young / material->density);
    double velocity = fmax(tolerance->velocity, fmin(wanted, most));
    for (int i = begin; i < end; i++) {
      weights[i] = 1 / tolerance->displacement;
      weights[n + i] = 1 / velocity;
    }
  }
}
