// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/error_weights.h"

#include <math.h>

#include "base/ranks.h"

static int dof_of(const FemModel *model, const FemPart *part, int i) {
  return model->dof_of_unknown[fem_part_unknown(part, i)];
}

// This rank's unknowns of a body: begin … *end, in the order of the bodies.
static void find_end(const FemModel *model, const FemPart *part, int body, int begin, int *end) {
  *end = begin;
  while (*end < part->count && dof_of(model, part, *end) / 3 < model->bodies[body].vertex_end) (*end)++;
}

// √(Σ m v² / Σ m) over unknowns of a body; 0 without any, INFINITY where a velocity is no number.
static double speed_of(const FemModel *model, const FemPart *part, const double *v, int begin, int end) {
  double sums[2] = {0}; // Σ m v², Σ m
  for (int i = begin; i < end; i++) {
    double m = model->mass[dof_of(model, part, i) / 3];
    sums[0] += m * v[i] * v[i];
    sums[1] += m;
  }
  ranks()->sum(sums, 2);
  // A coordinate's mean square is a third of a vertex's.
  double square = sums[1] > 0 ? 3 * sums[0] / sums[1] : 0;
  return isfinite(square) ? sqrt(square) : INFINITY;
}

static double fastest(const FemModel *model, const FemPart *part, const double *v) {
  double speed = 0;
  for (int b = 0, begin = 0, end; b < model->body_count; b++, begin = end) {
    find_end(model, part, b, begin, &end);
    speed = fmax(speed, speed_of(model, part, v, begin, end));
  }
  return speed;
}

void fem_error_weights(const FemErrorTolerance *tolerance, const FemModel *model, const FemPart *part,
                       const double *v, double *weights) {
  double wanted = tolerance->speed_share > 0 ? tolerance->speed_share * fastest(model, part, v) : 0;
  for (int b = 0, begin = 0, end; b < model->body_count; b++, begin = end) {
    find_end(model, part, b, begin, &end);
    const FemMaterial *material = &model->bodies[b].material;
    double most = tolerance->wave_share * sqrt(material->young / material->density);
    double velocity = fmax(tolerance->velocity, fmin(wanted, most));
    for (int i = begin; i < end; i++) {
      weights[i] = 1 / tolerance->displacement;
      weights[part->count + i] = 1 / velocity;
    }
  }
}
