// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/precision.h"

#include <math.h>

#include "base/memory.h"
#include "base/vec3.h"

static int own_bodies(const FemModel *model) {
  int count = 0;
  while (count < model->body_count && !model->bodies[count].is_obstacle) count++;
  return count;
}

static Vec3 centre_of(const FemModel *model, const FemModelBody *body, const double *positions) {
  Vec3 sum = {0, 0, 0};
  for (int v = body->vertex_begin; v < body->vertex_end; v++)
    sum = vec3_add(sum, vec3_scale(model->mass[v], vec3_at(positions + 3 * (size_t)v)));
  return vec3_scale(1 / body->mass, sum);
}

Status app_precision_course_create(AppPrecisionCourse *course, const FemModel *model,
                                   const FemRunResult *result) {
  int bodies = own_bodies(model);
  size_t frames = (size_t)result->frame_count;
  *course = (AppPrecisionCourse){
      .frame_count = result->frame_count, .body_count = bodies, .interface_count = result->interface_count};
  course->centres = memory_zeroed(frames * (size_t)bodies * 3, sizeof *course->centres);
  course->forces = memory_copy(result->interface_forces, frames * (size_t)result->interface_count * 3,
                               sizeof *course->forces);
  if (!course->centres || !course->forces) {
    app_precision_course_destroy(course);
    return status_no_memory("a run's course");
  }
  double *centre = course->centres;
  for (size_t f = 0; f < frames; f++)
    for (int b = 0; b < bodies; b++, centre += 3)
      vec3_store(centre, centre_of(model, &model->bodies[b],
                                   result->trajectory + f * (size_t)result->vertex_count * 3));
  return STATUS_OK;
}

void app_precision_course_destroy(AppPrecisionCourse *course) {
  memory_free(course->centres), memory_free(course->forces);
  *course = (AppPrecisionCourse){0};
}

typedef struct Sums {
  double difference, size;
  size_t count;
} Sums;

static Sums sum(const double *a, const double *reference, size_t count) {
  Sums sums = {.count = count};
  for (size_t i = 0; i < 3 * count; i++) {
    double change = a[i] - reference[i];
    sums.difference += change * change;
    sums.size += reference[i] * reference[i];
  }
  return sums;
}

static size_t common_frames(const AppPrecisionCourse *a, const AppPrecisionCourse *b) {
  return (size_t)(a->frame_count < b->frame_count ? a->frame_count : b->frame_count);
}

double app_precision_course_centre_error(const AppPrecisionCourse *course,
                                         const AppPrecisionCourse *reference) {
  Sums sums = sum(course->centres, reference->centres,
                  common_frames(course, reference) * (size_t)reference->body_count);
  return sums.count > 0 ? sqrt(sums.difference / (double)sums.count) : NAN;
}

double app_precision_course_force_error(const AppPrecisionCourse *course,
                                        const AppPrecisionCourse *reference) {
  Sums sums = sum(course->forces, reference->forces,
                  common_frames(course, reference) * (size_t)reference->interface_count);
  if (sums.difference == 0) return 0;
  return sqrt(sums.difference / sums.size);
}
