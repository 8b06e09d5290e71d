// SPDX-License-Identifier: GPL-3.0-or-later
// libtetlap-overlap as others see it: through tetlap/overlap.h alone.
#include "suite.h"

#include <pthread.h>
#include <stdbool.h>
#include <string.h>
#include <tetlap/overlap.h>

// ---- Pairs.

static const double unit[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

// Two of the same shape, the second moved along x: what is common is that shape again, smaller.
static void make_pair(double moved, double x[24]) {
  for (int i = 0; i < 12; i++) {
    x[i] = unit[i];
    x[12 + i] = unit[i] + (i % 3 == 0 ? moved : 0);
  }
}

// A few of them, no two alike.
static void make_pairs(int count, double *x) {
  for (int k = 0; k < count; k++) {
    make_pair(0.1 + 0.8 * k / count, x + 24 * k);
    for (int i = 0; i < 24; i++) x[24 * k + i] += 0.01 * sin(7.0 * i + k);
  }
}

static TetlapOverlap *open_model(const char *name) {
  TetlapOverlap *overlap;
  ck_assert_msg(tetlap_overlap_open(&overlap, name) == TETLAP_OVERLAP_OK, "%s", tetlap_overlap_message());
  return overlap;
}

static void ck_assert_eval(const TetlapOverlap *overlap, const TetlapOverlapBatch *batch) {
  ck_assert_msg(tetlap_overlap_eval(overlap, batch) == TETLAP_OVERLAP_OK, "%s", tetlap_overlap_message());
}

START_TEST(a_pair_has_volume_gradient_hessian_and_centroid) {
  TetlapOverlap *overlap = open_model("clip");
  double x[24], volume, gradient[24], hessian[576], centroid[3];
  unsigned flags = 99;
  make_pair(0.5, x);
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  batch.count = 1, batch.pairs = x, batch.volume = &volume, batch.gradient = gradient;
  batch.hessian = hessian, batch.centroid = centroid, batch.flags = &flags;
  ck_assert_eval(overlap, &batch);
  ck_assert_near(volume, 0.125 / 6, 1e-15);
  double pushed = 0; // V = (1 − d)³/6 moves with the second tetrahedron by −(1 − d)²/2
  for (int v = 0; v < 4; v++) pushed += gradient[12 + 3 * v];
  ck_assert_near(pushed, -0.125, 1e-14);
  ck_assert_near(centroid[0], 0.5 + 0.125, 1e-14);
  ck_assert_near(centroid[1], 0.125, 1e-14);
  for (int i = 0; i < 576; i++) ck_assert_near(hessian[i], hessian[24 * (i % 24) + i / 24], 1e-12);
  ck_assert_uint_eq(flags & TETLAP_OVERLAP_DISJOINT, 0);
  tetlap_overlap_close(overlap);
}
END_TEST

START_TEST(products_are_those_of_the_hessian) {
  enum { COUNT = 100 };
  static double x[24 * COUNT], u[24 * COUNT], volume[COUNT], hessian[576 * COUNT], product[24 * COUNT];
  make_pairs(COUNT, x);
  for (int i = 0; i < 24 * COUNT; i++) u[i] = cos(3.0 * i);
  for (int m = 0; m < 2; m++) {
    TetlapOverlap *overlap = open_model(m ? "geo-small" : "clip");
    TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
    batch.count = COUNT, batch.pairs = x, batch.volume = volume, batch.hessian = hessian;
    batch.direction = u, batch.product = product;
    ck_assert_eval(overlap, &batch);
    for (int k = 0; k < COUNT; k++)
      for (int i = 0; i < 24; i++) {
        double sum = 0;
        for (int j = 0; j < 24; j++) sum += hessian[576 * k + 24 * i + j] * u[24 * k + j];
        ck_assert_near(product[24 * k + i], sum, 1e-12 * (1 + fabs(sum)));
      }
    tetlap_overlap_close(overlap);
  }
}
END_TEST

// ---- Models.

START_TEST(each_model_says_what_it_gives_and_gives_it) {
  double x[24], volume, gradient[24], hessian[576], centroid[3];
  make_pair(0.3, x);
  int count = 0;
  for (const char *name; (name = tetlap_overlap_model(count)); count++) {
    TetlapOverlap *overlap = open_model(name);
    TetlapOverlapInfo info = TETLAP_OVERLAP_INFO_INIT;
    ck_assert_int_eq(tetlap_overlap_info(overlap, &info), TETLAP_OVERLAP_OK);
    ck_assert_str_eq(info.name, name);
    ck_assert_str_ne(name, "cgal"); // under the GPL
    TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
    batch.count = 1, batch.pairs = x, batch.volume = &volume, batch.gradient = gradient;
    ck_assert_eval(overlap, &batch);
    batch.hessian = hessian;
    ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch),
                     info.gives & TETLAP_OVERLAP_HESSIAN ? TETLAP_OVERLAP_OK : TETLAP_OVERLAP_INVALID);
    batch.hessian = NULL, batch.centroid = centroid;
    ck_assert_uint_eq(info.gives & TETLAP_OVERLAP_CENTROID, TETLAP_OVERLAP_CENTROID);
    ck_assert_eval(overlap, &batch);
    tetlap_overlap_close(overlap);
  }
  ck_assert_int_ge(count, 10);
}
END_TEST

// Numbers in 0 … 1, always the same (Lehmer's generator, as Park and Miller 1988).
static void fill_uniform(int count, double *x) {
  unsigned long long state = 1;
  for (int i = 0; i < count; i++) {
    state = 48271 * state % 2147483647;
    x[i] = (double)state / 2147483647.0;
  }
}

static void eval_volumes(const char *name, int count, const double *x, double *volume) {
  TetlapOverlap *overlap = open_model(name);
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  batch.count = (size_t)count, batch.pairs = x, batch.volume = volume;
  ck_assert_eval(overlap, &batch);
  tetlap_overlap_close(overlap);
}

// The error over the volume, both as roots of mean squares, on pairs such as the networks have been shown:
// vertices anywhere in the unit cube. docs/models.md has these figures on many more.
static double most_error_of(const char *name) {
  static const struct {
    const char *name;
    double most;
  } learned[] = {{"geo", 0.02},    {"geo-small", 0.02}, {"tpn", 0.15},          {"tpn-bf16", 0.15},
                 {"hybrid", 0.25}, {"tpn-scene", 0.25}, {"tpn-published", 0.65}};
  for (size_t k = 0; k < sizeof learned / sizeof *learned; k++)
    if (strcmp(name, learned[k].name) == 0) return learned[k].most;
  return strcmp(name, "clip32") == 0 ? 1e-5 : 1e-12;
}

START_TEST(each_model_s_volumes_are_as_near_to_the_exact_ones_as_is_said) {
  enum { COUNT = 1000 };
  static double x[24 * COUNT], exact[COUNT], volume[COUNT];
  fill_uniform(24 * COUNT, x);
  eval_volumes("exact", COUNT, x, exact);
  const char *name;
  for (int m = 0; (name = tetlap_overlap_model(m)); m++) {
    double error = 0, norm = 0;
    eval_volumes(name, COUNT, x, volume);
    for (int k = 0; k < COUNT; k++)
      error += (volume[k] - exact[k]) * (volume[k] - exact[k]), norm += exact[k] * exact[k];
    ck_assert_msg(sqrt(error / norm) <= most_error_of(name), "%s: %g", name, sqrt(error / norm));
  }
}
END_TEST

START_TEST(what_is_wrong_is_a_status_and_a_message) {
  TetlapOverlap *overlap = (TetlapOverlap *)&overlap;
  ck_assert_int_eq(tetlap_overlap_open(&overlap, "clipp"), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_null(overlap);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "did you mean 'clip'"));
  ck_assert_int_eq(tetlap_overlap_open(&overlap, "/nowhere/at.safetensors"), TETLAP_OVERLAP_NO_FILE);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "/nowhere/at.safetensors"));
  ck_assert_int_eq(tetlap_overlap_open(&overlap, NULL), TETLAP_OVERLAP_INVALID);
  TetlapOverlapOptions options = TETLAP_OVERLAP_OPTIONS_INIT;
  options.model = "clip", options.threads = -1;
  ck_assert_int_eq(tetlap_overlap_open_with(&overlap, &options), TETLAP_OVERLAP_INVALID);

  overlap = open_model("exact");
  double x[2 * 24], volume[2], hessian[576 * 2];
  make_pairs(2, x);
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  ck_assert_eval(overlap, &batch); // none at all
  batch.count = 2, batch.pairs = x;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "`volume` is NULL"));
  batch.volume = volume, batch.hessian = hessian;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "'exact' has no Hessian"));
  batch.hessian = NULL, batch.product = hessian;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "`direction`"));
  batch.direction = x;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "'exact' has no Hessian"));
  batch.product = NULL, x[24 + 13] = NAN;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "pair 1, tetrahedron 1, vertex 0: coordinate y"));
  ck_assert_int_eq(tetlap_overlap_eval(NULL, &batch), TETLAP_OVERLAP_INVALID);
  ck_assert_int_eq(tetlap_overlap_eval(overlap, NULL), TETLAP_OVERLAP_INVALID);
  tetlap_overlap_close(overlap), tetlap_overlap_close(NULL);
}
END_TEST

// A struct of a later header is taken as long as nothing is set that is not known here.
START_TEST(structs_of_other_versions_are_taken_or_refused) {
  TetlapOverlap *overlap = open_model("clip");
  double x[24], volume = -1;
  make_pair(0.5, x);
  struct Later {
    TetlapOverlapBatch batch;
    double *more;
  } later = {.batch = TETLAP_OVERLAP_BATCH_INIT};
  later.batch.size = sizeof later;
  later.batch.count = 1, later.batch.pairs = x, later.batch.volume = &volume;
  ck_assert_eval(overlap, &later.batch);
  ck_assert_near(volume, 0.125 / 6, 1e-15);
  later.more = x;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &later.batch), TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "later library"));
  later.batch.size = 8;
  ck_assert_int_eq(tetlap_overlap_eval(overlap, &later.batch), TETLAP_OVERLAP_INVALID);
  tetlap_overlap_close(overlap);
}
END_TEST

// ---- Threads.

enum { SHARED = 6000 };
static double shared_pairs[24 * SHARED];

typedef struct Job {
  TetlapOverlap *overlap;
  double volume[SHARED], gradient[24 * SHARED];
  int status;
} Job;

static void *do_job(void *self) {
  Job *job = self;
  TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
  batch.count = SHARED, batch.pairs = shared_pairs, batch.volume = job->volume,
  batch.gradient = job->gradient;
  for (int k = 0; k < 5 && !job->status; k++) job->status = tetlap_overlap_eval(job->overlap, &batch);
  return NULL;
}

// Loop: 0 a handle each, 1 one for all; of a model without and one with a network.
START_TEST(several_threads_get_what_one_gets) {
  static Job alone, jobs[4];
  pthread_t threads[4];
  const char *model = _i / 2 ? "tpn" : "clip";
  make_pairs(SHARED, shared_pairs);
  alone.overlap = open_model(model);
  do_job(&alone);
  for (int t = 0; t < 4; t++) {
    jobs[t].overlap = _i % 2 ? alone.overlap : open_model(model);
    ck_assert_int_eq(pthread_create(&threads[t], NULL, do_job, &jobs[t]), 0);
  }
  for (int t = 0; t < 4; t++) {
    pthread_join(threads[t], NULL);
    ck_assert_int_eq(jobs[t].status, TETLAP_OVERLAP_OK);
    ck_assert_mem_eq(jobs[t].volume, alone.volume, sizeof alone.volume);
    ck_assert_mem_eq(jobs[t].gradient, alone.gradient, sizeof alone.gradient);
    if (_i % 2 == 0) tetlap_overlap_close(jobs[t].overlap);
  }
  tetlap_overlap_close(alone.overlap);
}
END_TEST

// ---- Meshes.

// A box cut into cells of six tetrahedra each, turned about z.
typedef struct Grid {
  int point_count, tet_count;
  double *points;
  int32_t *tets;
} Grid;

static Grid make_grid(int n, double size, double x0, double turn) {
  static const int corners[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                    {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  Grid grid = {(n + 1) * (n + 1) * (n + 1), 6 * n * n * n, NULL, NULL};
  grid.points = calloc((size_t)grid.point_count * 3, sizeof *grid.points);
  grid.tets = calloc((size_t)grid.tet_count * 4, sizeof *grid.tets);
  for (int p = 0; p < grid.point_count; p++) {
    double x = size * (p % (n + 1)) / n + x0, y = size * (p / (n + 1) % (n + 1)) / n + x0;
    grid.points[3 * p] = cos(turn) * x - sin(turn) * y;
    grid.points[3 * p + 1] = sin(turn) * x + cos(turn) * y;
    grid.points[3 * p + 2] = size * (p / (n + 1) / (n + 1)) / n + x0;
  }
  for (int t = 0; t < grid.tet_count; t++)
    for (int a = 0; a < 4; a++) {
      int cell = t / 6, corner = corners[t % 6][a];
      int x = cell % n + (corner & 1), y = cell / n % n + (corner >> 1 & 1), z = cell / n / n + (corner >> 2);
      grid.tets[4 * t + a] = (z * (n + 1) + y) * (n + 1) + x;
    }
  return grid;
}

static void destroy_grid(Grid *grid) {
  free(grid->points);
  free(grid->tets);
}

static TetlapOverlapMesh mesh_of(const Grid *grid) {
  TetlapOverlapMesh mesh = TETLAP_OVERLAP_MESH_INIT;
  mesh.point_count = (size_t)grid->point_count, mesh.points = grid->points;
  mesh.tet_count = (size_t)grid->tet_count, mesh.tets = grid->tets;
  return mesh;
}

static void load(const Grid *grid, int tet, double x[12]) {
  for (int a = 0; a < 4; a++) memcpy(x + 3 * a, grid->points + 3 * grid->tets[4 * tet + a], 3 * sizeof *x);
}

// Every pair of two small meshes, asked one after another, is the list's oracle.
START_TEST(two_meshes_overlap_where_their_tetrahedra_do) {
  TetlapOverlap *overlap = open_model("clip");
  Grid grids[2] = {make_grid(3, 1, 0, 0), make_grid(4, 1.1, 0.3, 0.4 * _i)};
  TetlapOverlapMesh a = mesh_of(&grids[0]), b = mesh_of(&grids[1]);
  TetlapOverlapList *list;
  ck_assert_int_eq(
      tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_GRADIENT | TETLAP_OVERLAP_CENTROID, &list),
      TETLAP_OVERLAP_OK);
  size_t at = 0;
  for (int i = 0; i < grids[0].tet_count; i++)
    for (int j = 0; j < grids[1].tet_count; j++) {
      double x[24], volume, gradient[24], centroid[3];
      load(&grids[0], i, x), load(&grids[1], j, x + 12);
      TetlapOverlapBatch batch = TETLAP_OVERLAP_BATCH_INIT;
      batch.count = 1, batch.pairs = x, batch.volume = &volume, batch.gradient = gradient;
      batch.centroid = centroid;
      ck_assert_eval(overlap, &batch);
      if (!(volume > 0)) continue;
      ck_assert_uint_lt(at, list->count);
      ck_assert_int_eq(list->first[at], i);
      ck_assert_int_eq(list->second[at], j);
      ck_assert(list->volume[at] == volume);
      ck_assert_mem_eq(list->gradient + 24 * at, gradient, sizeof gradient);
      ck_assert_mem_eq(list->centroid + 3 * at, centroid, sizeof centroid);
      at++;
    }
  ck_assert_uint_eq(at, list->count);
  ck_assert_uint_ge(list->count, 300);
  ck_assert_uint_le(list->count, list->candidates);
  tetlap_overlap_list_free(list), tetlap_overlap_close(overlap);
  destroy_grid(&grids[0]), destroy_grid(&grids[1]);
}
END_TEST

// A mesh inside another: each of its tetrahedra is covered once, volume and first moment.
START_TEST(a_covered_mesh_is_covered_once) {
  TetlapOverlap *overlap = open_model("clip");
  Grid grids[2] = {make_grid(6, 1, 0, 0.3), make_grid(5, 4, -1.5, 0)};
  TetlapOverlapMesh a = mesh_of(&grids[0]), b = mesh_of(&grids[1]);
  TetlapOverlapList *list;
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_CENTROID, &list), TETLAP_OVERLAP_OK);
  ck_assert_ptr_null(list->gradient);
  double *sum = calloc((size_t)grids[0].tet_count * 4, sizeof *sum);
  for (size_t k = 0; k < list->count; k++) {
    double *own = sum + 4 * list->first[k];
    own[3] += list->volume[k];
    for (int c = 0; c < 3; c++) own[c] += list->volume[k] * list->centroid[3 * k + (size_t)c];
  }
  for (int t = 0; t < grids[0].tet_count; t++) {
    double x[12], volume = 1.0 / (6 * 216);
    load(&grids[0], t, x);
    ck_assert_near(sum[4 * t + 3], volume, 1e-12 * volume);
    for (int c = 0; c < 3; c++)
      ck_assert_near(sum[4 * t + c] / volume, (x[c] + x[3 + c] + x[6 + c] + x[9 + c]) / 4, 1e-12);
  }
  free(sum), tetlap_overlap_list_free(list), tetlap_overlap_close(overlap);
  destroy_grid(&grids[0]), destroy_grid(&grids[1]);
}
END_TEST

// ---- Poses.

enum { POSES = 5 };

// Turns about z and shifts, the last far away.
static void make_poses(double poses[POSES][12]) {
  for (int i = 0; i < POSES; i++) {
    const double a = 0.3 * i, far = i == POSES - 1 ? 10 : 0;
    const double pose[12] = {cos(a), -sin(a), 0, sin(a),        cos(a), 0,
                             0,      0,       1, 0.1 * i + far, 0.05,   0.2 - 0.1 * i};
    memcpy(poses[i], pose, sizeof pose);
  }
}

// V, and force and moment by ∇V of the pairs of the mesh that has been moved.
static void find_sums(const TetlapOverlap *overlap, const Grid *grid, const TetlapOverlapMesh *others,
                      const double pose[12], const double centre[3], double sums[7]) {
  TetlapOverlapMesh moved = mesh_of(grid);
  double *points = malloc(3 * moved.point_count * sizeof *points), c[3];
  TetlapOverlapList *list;
  for (size_t v = 0; v <= moved.point_count; v++) {
    const double *x = v < moved.point_count ? grid->points + 3 * v : centre;
    for (int k = 0; k < 3; k++)
      (v < moved.point_count ? points + 3 * v : c)[k] =
          pose[3 * k] * x[0] + pose[3 * k + 1] * x[1] + pose[3 * k + 2] * x[2] + pose[9 + k];
  }
  moved.points = points;
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &moved, others, TETLAP_OVERLAP_GRADIENT, &list),
                   TETLAP_OVERLAP_OK);
  memset(sums, 0, 7 * sizeof *sums);
  for (size_t k = 0; k < list->count; k++) {
    sums[0] += list->volume[k];
    for (int v = 0; v < 4; v++) {
      const double *x = points + 3 * grid->tets[4 * list->first[k] + v], *g = list->gradient + 24 * k + 3 * v;
      for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        sums[1 + i] -= g[i];
        sums[4 + i] -= (x[j] - c[j]) * g[l] - (x[l] - c[l]) * g[j];
      }
    }
  }
  tetlap_overlap_list_free(list), free(points);
}

// The list of two meshes is the oracle; a kernel gives the bits of the processor's vectors.
START_TEST(poses_sum_what_the_meshes_share) {
  static const char *const devices[] = {"host", "opencl"};
  TetlapOverlap *overlap = open_model("clip");
  Grid grids[2] = {make_grid(3, 1, 0, 0), make_grid(4, 1.1, 0.3, 0.4)};
  const TetlapOverlapMesh a = mesh_of(&grids[0]), b = mesh_of(&grids[1]);
  double poses[POSES][12], sums[POSES][7], again[POSES][7], wanted[7];
  make_poses(poses);
  TetlapOverlapPoses asked = TETLAP_OVERLAP_POSES_INIT;
  asked.count = POSES, asked.poses = poses[0], asked.sums = sums[0];
  asked.centre[0] = 0.5, asked.centre[1] = 0.4, asked.centre[2] = 0.3;
  ck_assert_msg(tetlap_overlap_poses(overlap, &a, &b, &asked) == TETLAP_OVERLAP_OK, "%s",
                tetlap_overlap_message());
  for (int i = 0; i < POSES; i++) {
    find_sums(overlap, &grids[0], &b, poses[i], asked.centre, wanted);
    for (int k = 0; k < 7; k++) ck_assert_near(sums[i][k], wanted[k], 1e-13);
    ck_assert(i == POSES - 1 ? sums[i][0] == 0 : sums[i][0] > 0.05);
  }
  for (int d = 0; d < 2; d++) {
    asked.device = devices[d], asked.sums = again[0];
    const int status = tetlap_overlap_poses(overlap, &a, &b, &asked);
    if (d == 1 && status == TETLAP_OVERLAP_DEVICE) {
      printf("opencl is not tested: %s\n", tetlap_overlap_message());
      continue;
    }
    ck_assert_msg(status == TETLAP_OVERLAP_OK, "%s", tetlap_overlap_message());
    ck_assert_mem_eq(again, sums, sizeof sums);
  }
  tetlap_overlap_close(overlap);
  destroy_grid(&grids[0]), destroy_grid(&grids[1]);
}
END_TEST

START_TEST(poses_that_are_wrong_or_none) {
  TetlapOverlap *overlap = open_model("clip"), *exact = open_model("exact");
  Grid grid = make_grid(2, 1, 0, 0);
  const TetlapOverlapMesh a = mesh_of(&grid);
  double poses[POSES][12], sums[POSES][7];
  make_poses(poses);
  TetlapOverlapPoses asked = TETLAP_OVERLAP_POSES_INIT;
  ck_assert_int_eq(tetlap_overlap_poses(overlap, &a, &a, &asked), TETLAP_OVERLAP_OK); // none
  asked.count = POSES, asked.poses = poses[0], asked.sums = sums[0];
  ck_assert_int_eq(tetlap_overlap_poses(exact, &a, &a, &asked), TETLAP_OVERLAP_INVALID);
  ck_assert_msg(strstr(tetlap_overlap_message(), "model 'clip', not by 'exact'") != NULL, "%s",
                tetlap_overlap_message());
  asked.device = "gpu";
  ck_assert_int_eq(tetlap_overlap_poses(overlap, &a, &a, &asked), TETLAP_OVERLAP_INVALID);
  asked.device = "opencl:99";
  ck_assert_int_eq(tetlap_overlap_poses(overlap, &a, &a, &asked), TETLAP_OVERLAP_DEVICE);
  asked.device = NULL, asked.sums = NULL;
  ck_assert_int_eq(tetlap_overlap_poses(overlap, &a, &a, &asked), TETLAP_OVERLAP_INVALID);
  asked.sums = sums[0], poses[3][7] = NAN;
  ck_assert_int_eq(tetlap_overlap_poses(overlap, &a, &a, &asked), TETLAP_OVERLAP_INVALID);
  ck_assert_msg(strstr(tetlap_overlap_message(), "pose 3, number 7") != NULL, "%s", tetlap_overlap_message());
  tetlap_overlap_close(overlap), tetlap_overlap_close(exact);
  destroy_grid(&grid);
}
END_TEST

START_TEST(meshes_that_are_wrong_or_empty) {
  TetlapOverlap *overlap = open_model("tpn-scene");
  Grid grids[2] = {make_grid(1, 1, 0, 0), make_grid(1, 1, 5, 0)};
  TetlapOverlapMesh a = mesh_of(&grids[0]), b = mesh_of(&grids[1]), none = TETLAP_OVERLAP_MESH_INIT;
  TetlapOverlapList *list;
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_VOLUME, &list), TETLAP_OVERLAP_OK);
  ck_assert_uint_eq(list->count, 0); // far apart
  tetlap_overlap_list_free(list);
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &none, &b, TETLAP_OVERLAP_VOLUME, &list),
                   TETLAP_OVERLAP_OK);
  ck_assert_uint_eq(list->count, 0);
  tetlap_overlap_list_free(list), tetlap_overlap_list_free(NULL);
  grids[1].tets[7] = 8;
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_VOLUME, &list),
                   TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(
      strstr(tetlap_overlap_message(), "mesh 2, tetrahedron 1: there is no point 8, of 0 to 7"));
  grids[0].points[4] = INFINITY;
  ck_assert_int_eq(tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_VOLUME, &list),
                   TETLAP_OVERLAP_INVALID);
  ck_assert_ptr_nonnull(strstr(tetlap_overlap_message(), "mesh 1, point 1: coordinate y"));
  tetlap_overlap_close(overlap);
  destroy_grid(&grids[0]), destroy_grid(&grids[1]);
}
END_TEST

// ---- Memory.

#if defined(__SANITIZE_ADDRESS__) || defined(TETLAP_NO_INTERPOSING)
#define HAS_FAILING_MEMORY 0 // the sanitizer has the allocations
#else
#define HAS_FAILING_MEMORY 1
#endif

#if HAS_FAILING_MEMORY
// The allocations of the library go through here, as it calls those of the program.
static long fail_at;
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *calloc(size_t count, size_t size);
void *realloc(void *memory, size_t size);

static bool strikes(void) {
  return fail_at > 0 && --fail_at == 0;
}

void *calloc(size_t count, size_t size) {
  return strikes() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size) {
  return strikes() ? NULL : __libc_realloc(memory, size);
}

START_TEST(each_allocation_that_fails_is_told) {
  Grid grids[2] = {make_grid(2, 1, 0, 0), make_grid(2, 1.1, 0.3, 0.4)};
  TetlapOverlapMesh a = mesh_of(&grids[0]), b = mesh_of(&grids[1]);
  double poses[POSES][12], sums[POSES][7];
  make_poses(poses);
  TetlapOverlapPoses asked = TETLAP_OVERLAP_POSES_INIT;
  asked.count = POSES, asked.poses = poses[0], asked.sums = sums[0], asked.device = "host";
  TetlapOverlap *first = open_model("clip"); // OpenMP takes its memory once, and ends the process without it
  ck_assert_int_eq(tetlap_overlap_poses(first, &a, &b, &asked), TETLAP_OVERLAP_OK);
  tetlap_overlap_close(first);
  long failed = 0;
  for (bool is_done = false; !is_done; failed++) {
    TetlapOverlap *overlap = NULL;
    TetlapOverlapList *list = NULL;
    fail_at = failed + 1;
    int status = tetlap_overlap_open(&overlap, "clip");
    if (status == TETLAP_OVERLAP_OK)
      status =
          tetlap_overlap_meshes(overlap, &a, &b, TETLAP_OVERLAP_GRADIENT | TETLAP_OVERLAP_CENTROID, &list);
    const bool has_list = status == TETLAP_OVERLAP_OK;
    if (has_list) status = tetlap_overlap_poses(overlap, &a, &b, &asked);
    is_done = fail_at > 0;
    fail_at = 0;
    ck_assert_int_eq(status, is_done ? TETLAP_OVERLAP_OK : TETLAP_OVERLAP_MEMORY);
    ck_assert_int_eq(list != NULL, has_list);
    tetlap_overlap_list_free(list), tetlap_overlap_close(overlap);
  }
  ck_assert_int_ge(failed, 15);
  destroy_grid(&grids[0]), destroy_grid(&grids[1]);
}
END_TEST
#endif

int main(void) {
  TCase *cases = tcase_create("library");
  tcase_add_test(cases, a_pair_has_volume_gradient_hessian_and_centroid);
  tcase_add_test(cases, products_are_those_of_the_hessian);
  tcase_add_test(cases, each_model_says_what_it_gives_and_gives_it);
  tcase_add_test(cases, each_model_s_volumes_are_as_near_to_the_exact_ones_as_is_said);
  tcase_add_test(cases, what_is_wrong_is_a_status_and_a_message);
  tcase_add_test(cases, structs_of_other_versions_are_taken_or_refused);
  tcase_add_loop_test(cases, several_threads_get_what_one_gets, 0, 4);
  tcase_add_loop_test(cases, two_meshes_overlap_where_their_tetrahedra_do, 0, 3);
  tcase_add_test(cases, a_covered_mesh_is_covered_once);
  tcase_add_test(cases, meshes_that_are_wrong_or_empty);
  tcase_add_test(cases, poses_sum_what_the_meshes_share);
  tcase_add_test(cases, poses_that_are_wrong_or_none);
#if HAS_FAILING_MEMORY
  tcase_add_test(cases, each_allocation_that_fails_is_told);
#endif
  return suite_run("library", cases, 60);
}
