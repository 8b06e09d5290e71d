// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/time/error_weights.h"

#include <math.h>

#include "base/ranks.h"
#include "fem/model/floating.h"
#include "fem/model/parts.h"

// This rank's unknowns of a body: begin … *end, in the order of the bodies.
static void find_end(const FemModel *model, const FemPart *part, int body, int begin, int *end) {
  *end = begin;
  while (*end < part->count && fem_part_dof(part, *end) / 3 < model->bodies[body].vertex_end) (*end)++;
}

Vec3 fem_error_weights_common(const FemModel *model, const FemPart *part, const double *v) {
  double momentum[3] = {0};
  if (vec3_length(fem_model_common_part(model, part->numbering->released, (Vec3){1, 1, 1})) == 0)
    return (Vec3){0, 0, 0};
  for (int i = 0; i < part->count; i++) {
    int dof = fem_part_dof(part, i);
    momentum[dof % 3] += model->mass[dof / 3] * v[i];
  }
  ranks()->sum(momentum, 3);
  return fem_model_common_part(model, part->numbering->released,
                               vec3_scale(1 / fem_model_mass(model), vec3_at(momentum)));
}

// √(Σ m (v − v̂)² / Σ m) over unknowns of a body, v̂ the common velocity; 0 without any, INFINITY where a
// velocity is no number.
static double speed_of(const FemModel *model, const FemPart *part, const double *v, const double common[3],
                       int begin, int end) {
  double sums[2] = {0}; // Σ m (v − v̂)², Σ m
  for (int i = begin; i < end; i++) {
    int dof = fem_part_dof(part, i);
    double m = model->mass[dof / 3], relative = v[i] - common[dof % 3];
    sums[0] += m * relative * relative;
    sums[1] += m;
  }
  ranks()->sum(sums, 2);
  // A coordinate's mean square is a third of a vertex's.
  double square = sums[1] > 0 ? 3 * sums[0] / sums[1] : 0;
  return isfinite(square) ? sqrt(square) : INFINITY;
}

static FemErrorGroup *group_of(FemErrorGroup *all, const int *groups, int body) {
  return &all[groups ? groups[body] : 0];
}

// The momenta and masses of the groups.
static void find_momenta(const FemModel *model, const FemPart *part, const int *groups, const double *v,
                         FemErrorGroup *all) {
  for (int b = 0, begin = 0, end; b < model->scene->body_count; b++, begin = end) {
    FemErrorGroup *group = group_of(all, groups, b);
    find_end(model, part, b, begin, &end);
    for (int i = begin; i < end; i++) {
      int dof = fem_part_dof(part, i);
      group->p[dof % 3] += model->mass[dof / 3] * v[i];
    }
  }
  ranks()->sum(&all->mass, sizeof *all / sizeof all->mass * (size_t)model->scene->body_count); // numbers only
  for (int b = 0; b < model->scene->body_count; b++) group_of(all, groups, b)->mass += model->bodies[b].mass;
}

static void find_speeds(const FemModel *model, const FemPart *part, const int *groups, const double *v,
                        FemErrorGroup *all) {
  const double released = part->numbering->released;
  for (int b = 0; b < model->scene->body_count; b++) all[b] = (FemErrorGroup){0};
  if (vec3_length(fem_model_common_part(model, released, (Vec3){1, 1, 1})) > 0)
    find_momenta(model, part, groups, v, all);
  for (int b = 0, begin = 0, end; b < model->scene->body_count; b++, begin = end) {
    FemErrorGroup *group = group_of(all, groups, b);
    double common[3] = {0};
    if (group->mass > 0)
      vec3_store(common,
                 fem_model_common_part(model, released, vec3_scale(1 / group->mass, vec3_at(group->p))));
    find_end(model, part, b, begin, &end);
    group->speed = fmax(group->speed, speed_of(model, part, v, common, begin, end));
  }
}

void fem_error_weights(const FemErrorTolerance *tolerance, const FemModel *model, const FemPart *part,
                       const int *groups, const double *v, FemErrorGroup *scratch, double *weights) {
  if (tolerance->speed_share > 0) find_speeds(model, part, groups, v, scratch);
  for (int b = 0, begin = 0, end; b < model->scene->body_count; b++, begin = end) {
    find_end(model, part, b, begin, &end);
    double velocity = tolerance->velocity;
    if (tolerance->speed_share > 0) {
      double wave = fem_model_parts_least(model, b, fem_model_wave);
      velocity = fmax(velocity, tolerance->speed_share * fmin(group_of(scratch, groups, b)->speed, wave));
    }
    for (int i = begin; i < end; i++) {
      weights[i] = 1 / tolerance->displacement;
      weights[part->count + i] = 1 / velocity;
    }
  }
}
