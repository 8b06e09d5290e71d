// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/run.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "app/scene/read.h"
#include "base/files/data.h"
#include "base/machine/clock.h"
#include "base/vec3.h"
#include "fem/model/build.h"

Status app_stress_run_open(AppStressRun *run, const char *file, const char *const *overrides, int count) {
  char path[PATH_MAX], name[128];
  *run = (AppStressRun){0};
  snprintf(name, sizeof name, "app/stress/scenes/%s.yaml", file);
  TRY(data_find(name, path, sizeof path));
  Status status = app_scene_read(path, overrides, count, &run->scene);
  if (!status) status = fem_model_create(&run->model, &run->scene);
  if (status) app_stress_run_close(run);
  return status;
}

void app_stress_run_close(AppStressRun *run) {
  fem_run_result_destroy(&run->result);
  fem_model_destroy(&run->model);
  fem_scene_destroy(&run->scene);
  *run = (AppStressRun){0};
}

static Status watch(void *self, const FemRunProgress *progress) {
  AppStressRun *run = self;
  const FemModel *model = progress->system->model;
  const double *velocities = progress->system->accepted.velocities;
  int which = progress->step_count <= 1 ? 0 : 1;
  for (int c = 0; c < 3; c++) {
    run->momentum[which][c] = progress->measures->momentum[c];
    run->angular[which][c] = progress->measures->angular_momentum[c];
  }
  for (int a = 0; a < model->bodies[model->scene->body_count - 1].vertex_end; a++)
    run->flight = fmax(run->flight, progress->step * vec3_length(vec3_at(velocities + 3 * a)));
  run->is_cut = clock_cpu_s() - run->began_s > run->limit_s;
  if (run->is_cut || (run->asked_to_stop && *run->asked_to_stop)) run->stop = 1;
  return STATUS_OK;
}

Status app_stress_run_scene(AppStressRun *run) {
  run->began_s = clock_cpu_s();
  FemRunOptions options = {.stop = &run->stop,
                           .observe = watch,
                           .observer = run,
                           .initial_displacement = run->initial_displacement,
                           .keep_trajectory = true};
  run->status = fem_run(&run->model, &options, &run->result);
  run->cpu_s = clock_cpu_s() - run->began_s;
  run->is_cut = run->is_cut && run->result.end_time < run->scene.end;
  if (run->status) snprintf(run->message, sizeof run->message, "%s", status_message());
  if (run->is_cut)
    snprintf(run->message, sizeof run->message, "cut after %.0f s of processor time at t = %.4g of %g s",
             run->cpu_s, run->result.end_time, run->scene.end);
  return run->status == STATUS_MEMORY ? run->status : STATUS_OK;
}

int app_stress_run_frames(const AppStressRun *run) {
  return run->result.trajectory.frame_count;
}

static int frame_of(const AppStressRun *run, int frame) {
  int found = frame < 0 ? run->result.trajectory.frame_count + frame : frame;
  assert(found >= 0 && found < run->result.trajectory.frame_count);
  return found;
}

const double *app_stress_run_position(const AppStressRun *run, int frame, int vertex) {
  size_t at = (size_t)frame_of(run, frame) * (size_t)run->result.trajectory.vertex_count + (size_t)vertex;
  return run->result.trajectory.positions + 3 * at;
}

void app_stress_run_centre(const AppStressRun *run, int frame, int body, double centre[3]) {
  const FemModelBody *b = &run->model.bodies[body];
  Vec3 sum = {0, 0, 0};
  for (int a = b->vertex_begin; a < b->vertex_end; a++)
    sum = vec3_add(sum,
                   vec3_scale(run->model.mass[a] / b->mass, vec3_at(app_stress_run_position(run, frame, a))));
  vec3_store(centre, sum);
}

double app_stress_run_lowest(const AppStressRun *run, int frame, int body, int axis) {
  double lowest = INFINITY;
  for (int a = run->model.bodies[body].vertex_begin; a < run->model.bodies[body].vertex_end; a++)
    lowest = fmin(lowest, app_stress_run_position(run, frame, a)[axis]);
  return lowest;
}

double app_stress_run_highest(const AppStressRun *run, int frame, int body, int axis) {
  double highest = -INFINITY;
  for (int a = run->model.bodies[body].vertex_begin; a < run->model.bodies[body].vertex_end; a++)
    highest = fmax(highest, app_stress_run_position(run, frame, a)[axis]);
  return highest;
}

bool app_stress_run_force(const AppStressRun *run, int frame, const char *name, double force[3]) {
  const FemRunResult *result = &run->result;
  for (int i = 0; i < result->trajectory.interface_count; i++) {
    if (strcmp(result->trajectory.interface_names[i], name) != 0) continue;
    size_t at = (size_t)frame_of(run, frame) * (size_t)result->trajectory.interface_count + (size_t)i;
    memcpy(force, result->trajectory.interface_forces + 3 * at, 3 * sizeof *force);
    return true;
  }
  return false;
}

bool app_stress_run_is_finite(const AppStressRun *run) {
  size_t count = 3 * (size_t)run->result.trajectory.vertex_count * (size_t)run->result.trajectory.frame_count;
  for (size_t i = 0; i < count; i++)
    if (!isfinite(run->result.trajectory.positions[i])) return false;
  return count > 0;
}

double app_stress_run_distortion(const AppStressRun *run) {
  double worst = 0;
  for (int e = 0; e < run->model.tet_count; e++) {
    if (run->model.bodies[run->model.tet_body[e]].is_obstacle) continue;
    Vec3 x[4];
    for (int k = 0; k < 4; k++) x[k] = vec3_at(app_stress_run_position(run, -1, run->model.tets[e][k]));
    double det = vec3_det4(x[0], x[1], x[2], x[3]) / (6 * run->model.volumes[e]);
    worst = fmax(worst, fabs(det - 1));
  }
  return worst;
}

// The vertex whose place at rest is the mirror image of that of `a`.
static int find_mirrored(const AppStressRun *run, const FemModelBody *body, int a, int axis) {
  Vec3 image = vec3_at(run->model.rest + 3 * a);
  double *component = axis == 0 ? &image.x : axis == 1 ? &image.y : &image.z;
  *component = -*component;
  int nearest = body->vertex_begin;
  double least = INFINITY;
  for (int b = body->vertex_begin; b < body->vertex_end; b++) {
    double distance = vec3_length(vec3_sub(vec3_at(run->model.rest + 3 * b), image));
    if (distance < least) least = distance, nearest = b;
  }
  return nearest;
}

double app_stress_run_asymmetry(const AppStressRun *run, int frame, int axis) {
  const FemModelBody *b = &run->model.bodies[1];
  double worst = 0, size = 0;
  for (int a = b->vertex_begin; a < b->vertex_end; a++) {
    int m = find_mirrored(run, b, a, axis);
    const double *here = app_stress_run_position(run, frame, a),
                 *there = app_stress_run_position(run, frame, m);
    for (int c = 0; c < 3; c++) {
      double image = c == axis ? -there[c] : there[c];
      worst = fmax(worst, fabs(here[c] - image));
    }
    size = fmax(size, vec3_length(vec3_sub(vec3_at(run->model.rest + 3 * a),
                                           vec3_at(run->model.rest + 3 * b->vertex_begin))));
  }
  return worst / size;
}
