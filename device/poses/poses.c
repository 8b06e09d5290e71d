// SPDX-License-Identifier: Apache-2.0
#include "device/poses/poses.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "device/kernels/language_host.h"
#include "overlap/clip/clip.h"

#include "device/kernels/clip/pose.inc"

enum { CLIP, MEND, SUM };                        // kernels of the program
enum { ITEMS_AT_ONCE = 1 << 21, PORTION = 512 }; // (pose, pair)s of a launch; pairs of a batch

// --- With the processor's vectors.

// A thread's memory.
typedef struct Workspace {
  double *moved; // all vertices in the pose            (vertex_count, 3)
  double pairs[PORTION][24], gradient[PORTION][24], volume[PORTION];
  unsigned flags[PORTION];
  double partial[POSE_PARTS][POSE_PARTIALS];
} Workspace;

static void gather(const DevicePoses *poses, const double *moved, const int pair[2], double x[24]) {
  for (int v = 0; v < 8; v++) {
    const int vertex = poses->def.tets[pair[v / 4]][v % 4];
    memcpy(x + 3 * v, (v < 4 ? moved : poses->def.positions) + 3 * (size_t)vertex, 3 * sizeof *x);
  }
}

static void move_first(const DevicePoses *poses, const double *pose, double *moved) {
  for (int k = 0; k < poses->pair_count; k++)
    for (int v = 0; v < 4; v++) {
      // pairs are sorted by their first
      if (k > 0 && poses->pair_list[k][0] == poses->pair_list[k - 1][0]) break;
      const size_t at = 3 * (size_t)poses->def.tets[poses->pair_list[k][0]][v];
      pose_apply(pose, poses->def.positions + at, moved + at);
    }
}

static void add_parts(Workspace *work, int first, int count, const double centre[3]) {
  for (int k = 0; k < count; k++) {
    if (work->volume[k] == 0) continue; // adds zeros
    double parts[POSE_PARTS];
    pose_parts(work->pairs[k], centre, work->volume[k], work->gradient[k], parts);
    for (int p = 0; p < POSE_PARTS; p++) work->partial[p][(first + k) % POSE_PARTIALS] += parts[p];
  }
}

static Status pose_with_vectors(const DevicePoses *poses, Workspace *work, const double *pose, double *sums) {
  double centre[3];
  memset(work->partial, 0, sizeof work->partial);
  pose_apply(pose, poses->def.centre, centre);
  move_first(poses, pose, work->moved);
  for (int first = 0; first < poses->pair_count; first += PORTION) {
    const int count = poses->pair_count - first < PORTION ? poses->pair_count - first : PORTION;
    for (int k = 0; k < count; k++) gather(poses, work->moved, poses->pair_list[first + k], work->pairs[k]);
    const OverlapBatch batch = {.pair_count = count,
                                .pairs = work->pairs[0],
                                .volume = work->volume,
                                .gradient = work->gradient[0],
                                .flags = work->flags};
    TRY(overlap_clip_ops.eval_batch(NULL, &batch));
    add_parts(work, first, count, centre);
  }
  for (int p = 0; p < POSE_PARTS; p++) {
    sums[p] = 0;
    for (int k = 0; k < POSE_PARTIALS; k++) sums[p] += work->partial[p][k];
  }
  return STATUS_OK;
}

static Status create_workspace(const DevicePoses *poses, Workspace **work) {
  *work = memory_zeroed(1, sizeof **work);
  if (*work) (*work)->moved = memory_zeroed(3 * (size_t)poses->def.vertex_count, sizeof(double));
  if (*work && (*work)->moved) return STATUS_OK;
  memory_free(*work);
  *work = NULL;
  return status_no_memory("a pose");
}

static void destroy_workspace(Workspace *work) {
  if (!work) return;
  memory_free(work->moved);
  memory_free(work);
}

static Status run_with_vectors(DevicePoses *poses, int count, const double *pose_list, double *sums) {
  int first_failed = INT_MAX;
  bool has_memory = true;
#pragma omp parallel reduction(min : first_failed) reduction(&& : has_memory)
  {
    Workspace *work;
    has_memory = create_workspace(poses, &work) == STATUS_OK;
#pragma omp for schedule(dynamic)
    for (int i = 0; i < count; i++) {
      if (!work) continue;
      Status status = pose_with_vectors(poses, work, pose_list + DEVICE_POSE_SIZE * (size_t)i,
                                        sums + DEVICE_POSE_SUMS * (size_t)i);
      if (status != STATUS_OK && i < first_failed) first_failed = i;
    }
    destroy_workspace(work);
  }
  if (!has_memory) return status_no_memory("a pose");
  return first_failed == INT_MAX ? STATUS_OK
                                 : status_fail(STATUS_SOLVER, "clipping failed in pose %d", first_failed);
}

// --- On a device.

static void release(const DevicePoses *poses, DeviceMemory *memory) {
  poses->device->ops->release(poses->device->self, memory);
}

static Status begin_on_device(DevicePoses *poses) {
  const Device *device = poses->device;
  const DevicePosesDef *def = &poses->def;
  TRY(device_build(device, &device_program_poses, &poses->module, poses->kernels));
  TRY(device_take(device, 3 * (size_t)def->vertex_count, sizeof(double), def->positions, &poses->positions));
  TRY(device_take(device, 4 * (size_t)def->tet_count, sizeof(int), def->tets, &poses->tets));
  return device_take(device, 1, sizeof(int), NULL, &poses->doubtful_count);
}

Status device_poses_create(DevicePoses *poses, const Device *device, const DevicePosesDef *def) {
  *poses = (DevicePoses){.device = device, .def = *def};
  return device ? begin_on_device(poses) : STATUS_OK;
}

static void release_chunk(DevicePoses *poses) {
  release(poses, &poses->poses), release(poses, &poses->parts), release(poses, &poses->doubtful);
  release(poses, &poses->sums);
  poses->pose_capacity = 0;
}

void device_poses_destroy(DevicePoses *poses) {
  if (poses->device) {
    release_chunk(poses);
    release(poses, &poses->positions), release(poses, &poses->tets), release(poses, &poses->pairs);
    release(poses, &poses->doubtful_count), release(poses, &poses->rows);
    poses->device->ops->discard(poses->device->self, poses->module);
  }
  memory_free(poses->pair_list);
  *poses = (DevicePoses){0};
}

static Status make_room(DevicePoses *poses) {
  const Device *device = poses->device;
  const int capacity = poses->pair_count < ITEMS_AT_ONCE ? ITEMS_AT_ONCE / poses->pair_count : 1;
  const size_t items = (size_t)capacity * (size_t)poses->pair_count, n = (size_t)capacity;
  release_chunk(poses);
  TRY(device_take(device, n * DEVICE_POSE_SIZE, sizeof(double), NULL, &poses->poses));
  TRY(device_take(device, n * POSE_PARTS, sizeof(double), NULL, &poses->sums));
  TRY(device_take(device, items * POSE_PARTS, sizeof(double), NULL, &poses->parts));
  TRY(device_take(device, items, sizeof(int), NULL, &poses->doubtful));
  poses->pose_capacity = capacity;
  return STATUS_OK;
}

Status device_poses_set_pairs(DevicePoses *poses, int count, const int (*pairs)[2]) {
  memory_free(poses->pair_list);
  poses->pair_count = 0;
  if (!(poses->pair_list = memory_copy(pairs, (size_t)count, sizeof *pairs)))
    return status_no_memory("pairs of tetrahedra");
  poses->pair_count = count;
  if (!poses->device || count == 0) return STATUS_OK;
  release(poses, &poses->pairs);
  TRY(device_take(poses->device, 2 * (size_t)count, sizeof(int), pairs, &poses->pairs));
  return make_room(poses);
}

static Status answer_doubtful(const DevicePoses *poses, const double *pose_list, int item, double *row) {
  const double *pose = pose_list + DEVICE_POSE_SIZE * (size_t)(item / poses->pair_count);
  const int *pair = poses->pair_list[item % poses->pair_count];
  double x[24], centre[3], volume, gradient[24];
  unsigned flags;
  for (int v = 0; v < 8; v++) {
    const double *rest = poses->def.positions + 3 * (size_t)poses->def.tets[pair[v / 4]][v % 4];
    if (v < 4)
      pose_apply(pose, rest, x + 3 * v);
    else
      memcpy(x + 3 * v, rest, 3 * sizeof *x);
  }
  const OverlapAnswer answer = {.volume = &volume, .gradient = gradient, .flags = &flags};
  TRY(overlap_clip_scalar_ops.eval_pair(NULL, x, &answer));
  pose_apply(pose, poses->def.centre, centre);
  pose_parts(x, centre, volume, gradient, row);
  return STATUS_OK;
}

static Status answer_all(const DevicePoses *poses, const double *pose_list, int count, const int *items,
                         double *rows) {
  int first_failed = INT_MAX;
#pragma omp parallel for schedule(dynamic, 16) reduction(min : first_failed) if (count > 64)
  for (int k = 0; k < count; k++)
    if (answer_doubtful(poses, pose_list, items[k], rows + POSE_PARTS * (size_t)k) != STATUS_OK &&
        k < first_failed)
      first_failed = k;
  if (first_failed == INT_MAX) return STATUS_OK;
  return answer_doubtful(poses, pose_list, items[first_failed], rows); // its message
}

static Status send_rows(DevicePoses *poses, int count, int stride, const double *rows) {
  const Device *device = poses->device;
  if (poses->row_capacity < count) {
    release(poses, &poses->rows), poses->row_capacity = 0;
    TRY(device_take(device, (size_t)count * POSE_PARTS, sizeof(double), NULL, &poses->rows));
    poses->row_capacity = count;
  }
  TRY(device->ops->put(device->self, &poses->rows, 0, (size_t)count * POSE_PARTS * sizeof *rows, rows));
  const DeviceArgument arguments[] = {device_int(count), device_int(stride), device_memory(&poses->doubtful),
                                      device_memory(&poses->rows), device_memory(&poses->parts)};
  return device_launch(device, &poses->kernels[MEND], count, arguments, 5);
}

static Status mend(DevicePoses *poses, const double *pose_list, int stride) {
  const Device *device = poses->device;
  int count;
  TRY(device->ops->get(device->self, &poses->doubtful_count, 0, sizeof count, &count));
  poses->handed_on += count;
  if (count == 0) return STATUS_OK;
  int *items = memory_zeroed((size_t)count, sizeof *items);
  double *rows = memory_zeroed((size_t)count * POSE_PARTS, sizeof *rows);
  Status status = items && rows ? STATUS_OK : status_no_memory("pairs that the device leaves to the host");
  if (!status)
    status = device->ops->get(device->self, &poses->doubtful, 0, (size_t)count * sizeof *items, items);
  if (!status) status = answer_all(poses, pose_list, count, items, rows);
  if (!status) status = send_rows(poses, count, stride, rows);
  memory_free(items), memory_free(rows);
  return status;
}

// At most pose_capacity of them.
static Status run_chunk(DevicePoses *poses, int count, const double *pose_list, double *sums) {
  const Device *device = poses->device;
  const int stride = count * poses->pair_count, none = 0;
  const double *c = poses->def.centre;
  const size_t pose_bytes = (size_t)count * DEVICE_POSE_SIZE * sizeof *pose_list;
  TRY(device->ops->put(device->self, &poses->poses, 0, pose_bytes, pose_list));
  TRY(device->ops->put(device->self, &poses->doubtful_count, 0, sizeof none, &none));
  const DeviceArgument clip[] = {device_int(poses->pair_count),
                                 device_int(stride),
                                 device_int(stride),
                                 device_memory(&poses->positions),
                                 device_memory(&poses->tets),
                                 device_memory(&poses->pairs),
                                 device_memory(&poses->poses),
                                 device_double(c[0]),
                                 device_double(c[1]),
                                 device_double(c[2]),
                                 device_memory(&poses->parts),
                                 device_memory(&poses->doubtful),
                                 device_memory(&poses->doubtful_count)};
  TRY(device_launch(device, &poses->kernels[CLIP], stride, clip, sizeof clip / sizeof *clip));
  TRY(mend(poses, pose_list, stride));
  const DeviceArgument sum[] = {device_int(poses->pair_count), device_int(stride),
                                device_memory(&poses->parts), device_memory(&poses->sums)};
  TRY(device->ops->launch(device->self, &poses->kernels[SUM], count, sum, 4));
  return device->ops->get(device->self, &poses->sums, 0, (size_t)count * POSE_PARTS * sizeof *sums, sums);
}

Status device_poses_run(DevicePoses *poses, int count, const double *pose_list, double *sums) {
  if (poses->pair_count == 0) {
    memset(sums, 0, (size_t)count * DEVICE_POSE_SUMS * sizeof *sums);
    return STATUS_OK;
  }
  if (!poses->device) return run_with_vectors(poses, count, pose_list, sums);
  for (int first = 0; first < count; first += poses->pose_capacity) {
    const int left = count - first, now = left < poses->pose_capacity ? left : poses->pose_capacity;
    TRY(run_chunk(poses, now, pose_list + DEVICE_POSE_SIZE * (size_t)first,
                  sums + DEVICE_POSE_SUMS * (size_t)first));
  }
  return STATUS_OK;
}
