// SPDX-License-Identifier: Apache-2.0
// The C API's poses: for blocks of them the boxes that the moved tetrahedra sweep, the pairs that may overlap
// in one of them (overlap/api/sweep.h), and the sums (device/poses/poses.h).
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "device/poses/poses.h"
#include "overlap/api/argument.h"
#include "overlap/api/handle.h"
#include "overlap/api/sweep.h"
#include "overlap/clip/clip.h"

enum { BLOCK = 1024 }; // poses that share a list of pairs

// Rounding of a posed vertex never matters to this part of the bodies' extent.
static const double SLACK = 1e-9;

// Both meshes as one, the moved one first.
typedef struct Scene {
  int vertex_count, tet_count, own_vertices, own_tets;
  double *points;                     // owned                 (vertex_count, 3)
  int (*tets)[4];                     // owned                 (tet_count)
  double slack;                       // [m]
  OverlapApiBox *swept, *own, *other; // owned, of vertices over a block, and of tetrahedra
} Scene;

static void destroy_scene(Scene *scene) {
  memory_free(scene->points), memory_free(scene->tets);
  memory_free(scene->swept), memory_free(scene->own), memory_free(scene->other);
}

static const OverlapApiBox empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void include(OverlapApiBox *box, const double low[3], const double high[3]) {
  for (int c = 0; c < 3; c++) {
    box->low[c] = fmin(box->low[c], low[c]);
    box->high[c] = fmax(box->high[c], high[c]);
  }
}

static void copy_mesh(Scene *scene, const TetlapOverlapMesh *mesh, int first_vertex, int first_tet) {
  if (mesh->point_count > 0)
    memcpy(scene->points + 3 * (size_t)first_vertex, mesh->points, 3 * mesh->point_count * sizeof(double));
  for (size_t t = 0; t < mesh->tet_count; t++)
    for (size_t v = 0; v < 4; v++)
      scene->tets[(size_t)first_tet + t][v] = first_vertex + mesh->tets[4 * t + v];
}

static Status make_scene(Scene *scene, const TetlapOverlapMesh meshes[2]) {
  const size_t vertices = meshes[0].point_count + meshes[1].point_count,
               tets = meshes[0].tet_count + meshes[1].tet_count;
  if (vertices > INT_MAX || tets > INT_MAX)
    return status_fail(STATUS_INPUT, "poses: at most %d points and tetrahedra are expected in both meshes",
                       INT_MAX);
  *scene = (Scene){.vertex_count = (int)vertices,
                   .tet_count = (int)tets,
                   .own_vertices = (int)meshes[0].point_count,
                   .own_tets = (int)meshes[0].tet_count,
                   .points = memory_zeroed(3 * vertices, sizeof(double)),
                   .tets = memory_zeroed(tets, sizeof(int[4])),
                   .swept = memory_zeroed(meshes[0].point_count, sizeof(OverlapApiBox)),
                   .own = memory_zeroed(meshes[0].tet_count, sizeof(OverlapApiBox)),
                   .other = memory_zeroed(meshes[1].tet_count, sizeof(OverlapApiBox))};
  if (!scene->points || !scene->tets || !scene->swept || !scene->own || !scene->other)
    return status_no_memory("the meshes of poses");
  copy_mesh(scene, &meshes[0], 0, 0);
  copy_mesh(scene, &meshes[1], scene->own_vertices, scene->own_tets);
  OverlapApiBox all = empty;
  for (int v = 0; v < scene->vertex_count; v++)
    include(&all, scene->points + 3 * (size_t)v, scene->points + 3 * (size_t)v);
  for (int c = 0; c < 3 && scene->vertex_count > 0; c++)
    scene->slack = fmax(scene->slack, SLACK * (all.high[c] - all.low[c]));
  for (int t = scene->own_tets; t < scene->tet_count; t++) {
    OverlapApiBox *box = &scene->other[t - scene->own_tets];
    *box = empty;
    for (int v = 0; v < 4; v++) {
      const double *x = scene->points + 3 * (size_t)scene->tets[t][v];
      include(box, x, x);
    }
  }
  return STATUS_OK;
}

// Where a vertex is over the poses.
static OverlapApiBox sweep(const Scene *scene, int vertex, int count, const double *poses) {
  const double *x = scene->points + 3 * (size_t)vertex;
  OverlapApiBox box = empty;
  for (int i = 0; i < count; i++) {
    const double *pose = poses + DEVICE_POSE_SIZE * (size_t)i;
    double low[3], high[3];
    for (int c = 0; c < 3; c++) {
      const double moved = pose[3 * c] * x[0] + pose[3 * c + 1] * x[1] + pose[3 * c + 2] * x[2] + pose[9 + c];
      low[c] = moved - scene->slack, high[c] = moved + scene->slack;
    }
    include(&box, low, high);
  }
  return box;
}

static Status find_pairs(Scene *scene, int count, const double *poses, OverlapApiCandidates *found) {
#pragma omp parallel for schedule(static)
  for (int v = 0; v < scene->own_vertices; v++) scene->swept[v] = sweep(scene, v, count, poses);
  for (int t = 0; t < scene->own_tets; t++) {
    scene->own[t] = empty;
    for (int v = 0; v < 4; v++) {
      const OverlapApiBox *box = &scene->swept[scene->tets[t][v]];
      include(&scene->own[t], box->low, box->high);
    }
  }
  TRY(overlap_api_sweep_find(scene->own, scene->own_tets, scene->other, scene->tet_count - scene->own_tets,
                             found));
  for (size_t k = 0; k < found->count; k++) found->at[k].second += scene->own_tets;
  if (found->count > INT_MAX / 2)
    return status_fail(STATUS_INPUT, "poses: more than %d pairs of tetrahedra may meet", INT_MAX / 2);
  return STATUS_OK;
}

_Static_assert(sizeof(OverlapApiCandidate) == sizeof(int[2]), "a pair is two ints");

static Status run_block(DevicePoses *poses, Scene *scene, int count, const double *list, double *sums) {
  static const int none[1][2];
  OverlapApiCandidates found = {0};
  Status status = find_pairs(scene, count, list, &found);
  if (!status)
    status =
        device_poses_set_pairs(poses, (int)found.count, found.count > 0 ? (const int(*)[2])found.at : none);
  if (!status) status = device_poses_run(poses, count, list, sums);
  overlap_api_sweep_destroy(&found);
  return status;
}

static Status run_blocks(const Device *device, Scene *scene, const TetlapOverlapPoses *asked) {
  DevicePosesDef def = {.vertex_count = scene->vertex_count,
                        .tet_count = scene->tet_count,
                        .positions = scene->points,
                        .tets = (const int(*)[4])scene->tets};
  memcpy(def.centre, asked->centre, sizeof def.centre);
  DevicePoses poses = {0};
  Status status = device_poses_create(&poses, device, &def);
  for (size_t first = 0; first < asked->count && !status; first += BLOCK) {
    const size_t left = asked->count - first;
    status = run_block(&poses, scene, left < BLOCK ? (int)left : BLOCK,
                       asked->poses + DEVICE_POSE_SIZE * first, asked->sums + DEVICE_POSE_SUMS * first);
  }
  device_poses_destroy(&poses);
  return status;
}

static Status run(const TetlapOverlapMesh meshes[2], const TetlapOverlapPoses *asked) {
  Device device = {0};
  Scene scene = {0};
  Status status = asked->device ? device_open(&device, asked->device) : STATUS_OK;
  if (!status) status = make_scene(&scene, meshes);
  if (!status) status = run_blocks(asked->device ? &device : NULL, &scene, asked);
  destroy_scene(&scene);
  device_close(&device);
  return status;
}

static Status check(const TetlapOverlapPoses *asked) {
  if (asked->count > INT_MAX) return status_fail(STATUS_INPUT, "poses: at most %d are expected", INT_MAX);
  if (asked->count > 0 && (!asked->poses || !asked->sums))
    return status_fail(STATUS_INPUT, "poses: `%s` is NULL", asked->poses ? "sums" : "poses");
  for (size_t k = 0; k < DEVICE_POSE_SIZE * asked->count; k++)
    if (!isfinite(asked->poses[k]))
      return status_fail(STATUS_INPUT, "pose %zu, number %zu: %g, it must be a finite number",
                         k / DEVICE_POSE_SIZE, k % DEVICE_POSE_SIZE, asked->poses[k]);
  for (int c = 0; c < 3; c++)
    if (!isfinite(asked->centre[c])) return status_fail(STATUS_INPUT, "poses: `centre` must be finite");
  return STATUS_OK;
}

static Status overlap_poses(const TetlapOverlap *overlap, const TetlapOverlapMesh *moved,
                            const TetlapOverlapMesh *others, const TetlapOverlapPoses *given) {
  TetlapOverlapMesh meshes[2];
  TetlapOverlapPoses asked;
  if (!overlap) return status_fail(STATUS_INPUT, "the handle is NULL");
  if (overlap->model.ops != &overlap_clip_ops)
    return status_fail(STATUS_INPUT, "poses are evaluated by model 'clip', not by '%s'",
                       overlap->model.ops->name);
  TRY(overlap_api_argument_mesh(&meshes[0], moved, 1));
  TRY(overlap_api_argument_mesh(&meshes[1], others, 2));
  TRY(overlap_api_argument_copy(&asked, sizeof asked, sizeof asked, given, "TetlapOverlapPoses"));
  TRY(check(&asked));
  const int before = overlap_api_handle_enter(overlap);
  Status status = run(meshes, &asked);
  overlap_api_handle_leave(before);
  return status;
}

int tetlap_overlap_poses(const TetlapOverlap *overlap, const TetlapOverlapMesh *moved,
                         const TetlapOverlapMesh *others, const TetlapOverlapPoses *poses) {
  return overlap_api_argument_status(overlap_poses(overlap, moved, others, poses));
}
