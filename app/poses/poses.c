// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/poses/poses.h"

#include <limits.h>
#include <math.h>

#include "app/poses/candidates.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/vec3.h"

void app_poses_centre(const FemModel *model, int body, double centre[3]) {
  const FemModelBody *moved = &model->bodies[body];
  Vec3 sum = {0, 0, 0};
  double total = 0;
  for (int t = moved->tet_begin; t < moved->tet_end; t++) {
    Vec3 x[4];
    for (int v = 0; v < 4; v++) x[v] = vec3_at(model->rest + 3 * (size_t)model->tets[t][v]);
    double volume =
        fabs(vec3_dot(vec3_sub(x[1], x[0]), vec3_cross(vec3_sub(x[2], x[0]), vec3_sub(x[3], x[0]))));
    Vec3 mean = vec3_scale(0.25, vec3_add(vec3_add(x[0], x[1]), vec3_add(x[2], x[3])));
    sum = vec3_add(sum, vec3_scale(volume, mean));
    total += volume;
  }
  vec3_store(centre, vec3_scale(1 / total, sum));
}

static Status run_block(AppPosesResult *result, AppPosesCandidates *candidates, DevicePoses *poses, int count,
                        const double *list, double *sums) {
  const double began = clock_wall_s();
  TRY(app_poses_candidates_find(candidates, count, list));
  if (candidates->found.count > INT_MAX)
    return status_fail(STATUS_INPUT, "more than %d pairs of tetrahedra may meet in %d poses", INT_MAX, count);
  TRY(device_poses_set_pairs(poses, (int)candidates->found.count, (const int(*)[2])candidates->found.pairs));
  const double found = clock_wall_s(), found_cpu = clock_cpu_s();
  TRY(device_poses_run(poses, count, list, sums));
  result->find_s += found - began;
  result->eval_s += clock_wall_s() - found;
  result->eval_cpu_s += clock_cpu_s() - found_cpu;
  result->pair_count += (long long)poses->pair_count * count;
  result->handed_on = poses->handed_on;
  return STATUS_OK;
}

static Status run_blocks(AppPosesResult *result, AppPosesCandidates *candidates, DevicePoses *poses,
                         const AppPosesList *list) {
  for (int first = 0; first < list->count; first += APP_POSES_BLOCK) {
    const int left = list->count - first, count = left < APP_POSES_BLOCK ? left : APP_POSES_BLOCK;
    TRY(run_block(result, candidates, poses, count, list->poses + DEVICE_POSE_SIZE * (size_t)first,
                  result->sums + DEVICE_POSE_SUMS * (size_t)first));
  }
  return STATUS_OK;
}

Status app_poses_run(AppPosesResult *result, const FemModel *model, int body, const AppPosesList *list,
                     const Device *device) {
  DevicePosesDef def = {.vertex_count = model->vertex_count,
                        .tet_count = model->tet_count,
                        .positions = model->rest,
                        .tets = (const int(*)[4])model->tets};
  DevicePoses poses = {0};
  AppPosesCandidates candidates = {0};
  *result = (AppPosesResult){0};
  result->sums = memory_zeroed((size_t)list->count * DEVICE_POSE_SUMS, sizeof *result->sums);
  if (!result->sums) return status_no_memory("the answers to the poses");
  app_poses_centre(model, body, def.centre);
  Status status = device_poses_create(&poses, device, &def);
  if (!status) status = app_poses_candidates_create(&candidates, model, body);
  if (!status) status = run_blocks(result, &candidates, &poses, list);
  app_poses_candidates_destroy(&candidates);
  device_poses_destroy(&poses);
  return status;
}

void app_poses_destroy(AppPosesResult *result) {
  memory_free(result->sums);
  *result = (AppPosesResult){0};
}
