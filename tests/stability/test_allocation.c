// SPDX-License-Identifier: GPL-3.0-or-later
// Allocation k fails, for every k, while a scene, a mesh, weights, a data set or a checkpoint is read and
// while a run is set up: out of memory is told, nothing leaks, nothing crashes. And a run holds no more the
// longer it lasts.
//
// Every allocation of our own code is counted and can fail, since the calls are replaced at link time (--wrap
// in tests/CMakeLists.txt). Those inside shared libraries (SUNDIALS, SuiteSparse, HDF5, libyaml, jansson,
// gmsh, C++) are not: they cannot be told apart from the ones that a library cannot survive.
#include <fcntl.h>
#include <omp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/scene/read.h"
#include "base/log.h"
#include "base/memory.h"
#include "datagen/files/dataset.h"
#include "datagen/run.h"
#include "fem/mesh/mesh.h"
#include "fem/model/build.h"
#include "fem/run/checkpoint/checkpoint.h"
#include "fem/run/run.h"
#include "overlap/models.h"
#include "scene_text.h"
#include "suite.h"

enum { MOST_LIVE = 1 << 16 };

// While it is on: which call of ours fails, how many there were, and what is allocated and not freed.
static struct {
  bool is_on, has_struck;
  long calls, fails; // fails: that call, counted from 1; 0: none
  int live_count;
  size_t live_bytes;
  void *live[MOST_LIVE]; // by hash of the address; NULL: free place
} watch;

static size_t place_of(const void *array) {
  size_t at = (size_t)((uintptr_t)array >> 4) * 2654435761u % MOST_LIVE;
  while (watch.live[at] && watch.live[at] != array) at = (at + 1) % MOST_LIVE;
  return at;
}

static void remember(void *array) {
  if (!watch.is_on || !array) return;
  if (watch.live_count > MOST_LIVE / 2) abort();
  watch.live[place_of(array)] = array;
  watch.live_count++;
  watch.live_bytes += memory_held(array);
}

// Whatever stands behind in the same run of places moves up.
static void forget(void *array) {
  size_t at = place_of(array);
  if (!array || !watch.live[at]) return; // it is older than the watch, or a library's
  watch.live[at] = NULL;
  watch.live_count--;
  watch.live_bytes -= memory_held(array);
  for (size_t next = (at + 1) % MOST_LIVE; watch.live[next]; next = (next + 1) % MOST_LIVE) {
    void *moved = watch.live[next];
    watch.live[next] = NULL;
    watch.live[place_of(moved)] = moved;
  }
}

static bool fails_now(void) {
  if (!watch.is_on) return false;
  bool now = ++watch.calls == watch.fails;
  watch.has_struck = watch.has_struck || now;
  return now;
}

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__real_realloc(void *array, size_t size);
void *__wrap_realloc(void *array, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *array);
void __wrap_free(void *array);

void *__wrap_malloc(size_t size) {
  void *array = fails_now() ? NULL : __real_malloc(size);
  remember(array);
  return array;
}

void *__wrap_calloc(size_t count, size_t size) {
  void *array = fails_now() ? NULL : __real_calloc(count, size);
  remember(array);
  return array;
}

void *__wrap_realloc(void *array, size_t size) {
  if (fails_now()) return NULL;
  forget(array);
  void *moved = __real_realloc(array, size);
  remember(moved);
  return moved;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
  void *array = fails_now() ? NULL : __real_aligned_alloc(alignment, size);
  remember(array);
  return array;
}

void __wrap_free(void *array) {
  forget(array);
  __real_free(array);
}

// Something that is made and destroyed again, whether or not it could be made.
typedef Status (*Attempt)(const char *input);

// With the k-th allocation failing, k = first, first + stride, …, until it goes through. Returns the number
// of allocations.
static long fail_each(Attempt attempt, const char *input, long first, long stride) {
  watch.is_on = false;
  ck_assert_ok(attempt(input)); // what is kept for good (tables, a library's own) is there now
  for (long k = first;; k += stride) {
    watch.calls = 0, watch.fails = k, watch.has_struck = false;
    watch.is_on = true;
    Status status = attempt(input);
    watch.is_on = false;
    ck_assert_msg(watch.live_count == 0, "%s: allocation %ld: %d arrays are lost", input, k,
                  watch.live_count);
    if (!watch.has_struck && status != STATUS_MEMORY) { // it may have struck in a child process
      ck_assert_ok(status);
      return watch.calls;
    }
    ck_assert_msg(status == STATUS_MEMORY, "%s: allocation %ld: %d: %s", input, k, (int)status,
                  status_message());
    ck_assert_msg(strstr(status_message(), "memory"), "%s: allocation %ld: %s", input, k, status_message());
  }
}

static char folder[64];

static void make_folder(void) {
  snprintf(folder, sizeof folder, "/tmp/tetlap_allocation_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(folder));
}

static void remove_folder(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -r %s", folder);
  ck_assert_int_eq(system(command), 0);
}

static const char everything[] = TETLAP_SOURCE_DIR "/tests/scenes/everything.yaml";

static Status read_scene(const char *path) {
  FemSceneDef scene;
  Status status = app_scene_read(path, NULL, 0, &scene);
  fem_scene_destroy(&scene);
  return status;
}

START_TEST(a_scene_is_read) {
  ck_assert_int_gt(fail_each(read_scene, everything, 1, 1), 100);
  ck_assert_int_gt(fail_each(read_scene, TETLAP_SOURCE_DIR "/tests/data/scene/full.json", 1, 1), 100);
}
END_TEST

static Status read_mesh(const char *path) {
  FemMesh mesh;
  FemMeshQuality quality;
  int(*triangles)[3] = NULL, count;
  Status status = fem_mesh_read(&mesh, path, NULL, NULL);
  if (!status) status = fem_mesh_quality(&mesh, &quality);
  if (!status) status = fem_mesh_surface(&mesh, &triangles, &count);
  memory_free(triangles);
  fem_mesh_destroy(&mesh);
  return status;
}

// _i: by our own reader; by gmsh, in a child process; meshed from a surface.
START_TEST(a_mesh_is_read) {
  static const char *const files[] = {"box.node", "box_41.msh", "box.stl"};
  char path[256];
  snprintf(path, sizeof path, "%s/tests/data/mesh/%s", TETLAP_SOURCE_DIR, files[_i]);
  ck_assert_int_gt(fail_each(read_mesh, path, 1, 1), 8);
}
END_TEST

// Two tetrahedra that overlap.
static Status ask_model(const char *name) {
  static const double pair[24] = {0,   0,   0,   1,   0,   0,   0,   1,   0,   0,   0,   1,
                                  0.2, 0.1, 0.3, 0.9, 0.3, 0.2, 0.1, 0.8, 0.4, 0.3, 0.2, 0.9};
  OverlapModel model = {0};
  Status status = overlap_models_create(&model, name);
  double volume, gradient[24];
  OverlapBatch batch = {.pair_count = 1, .pairs = pair, .volume = &volume, .gradient = gradient};
  if (!status) status = overlap_model_eval(&model, &batch);
  overlap_model_destroy(&model);
  return status;
}

// Those without networks keep nothing.
START_TEST(an_overlap_model_is_made_and_asked) {
  int count, allocating = 0;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++) allocating += fail_each(ask_model, models[m]->name, 1, 1) > 3;
  ck_assert_int_ge(allocating, 5);
}
END_TEST

static DatagenPlan plan;

static Status write_data(const char *path) {
  DatagenRunOptions options = {.path = path, .program = "test", .block = 16, .count = 40};
  return datagen_run(&plan, &options);
}

static Status read_data(const char *path) {
  DatagenDataset *dataset = NULL;
  DatagenPairs pairs = {0};
  Status status = datagen_dataset_open(&dataset, path);
  size_t count = status ? 0 : (size_t)datagen_dataset_info(dataset)->count;
  if (!status) status = datagen_pairs_create(&pairs, count, true);
  if (!status) status = datagen_dataset_read(dataset, 0, count, &pairs);
  datagen_pairs_destroy(&pairs);
  datagen_dataset_close(dataset);
  return status;
}

START_TEST(a_data_set_is_written_and_read) {
  DatagenLaw law;
  ck_assert_ok(datagen_law_find("paper-train", &law));
  ck_assert_ok(datagen_plan_make(&plan, &law, 42, 40));
  plan.wants_gradient = true;
  char path[128];
  snprintf(path, sizeof path, "%s/a.h5", folder);
  ck_assert_int_gt(fail_each(write_data, path, 1, 1), 5);
  ck_assert_int_gt(fail_each(read_data, path, 1, 1), 5);
}
END_TEST

// The scene as far as a run needs it.
typedef struct Job {
  FemSceneDef scene;
  FemModel model;
} Job;

static Job job;

static Status make_model(const char *unused) {
  (void)unused;
  FemModel model = {0};
  Status status = fem_model_create(&model, &job.scene);
  fem_model_destroy(&model);
  return status;
}

static Status make_system(const char *unused) {
  (void)unused;
  FemSystem system = {0};
  Status status = fem_system_create(&system, &job.model);
  if (!status) status = fem_system_create_again(&system);
  fem_system_destroy(&system);
  return status;
}

static void open_job(const char *overlap) {
  char choice[64];
  snprintf(choice, sizeof choice, "contact.overlap=%s", overlap);
  const char *overrides[] = {choice, "output.checkpoint.seconds=0", "bodies.slab.mesh.box.cells=[2, 2, 1]",
                             "bodies.block.mesh.box.cells=1"};
  ck_assert_ok(app_scene_read(everything, overrides, 4, &job.scene));
  ck_assert_ok(fem_model_create(&job.model, &job.scene));
}

static void close_job(void) {
  fem_model_destroy(&job.model);
  fem_scene_destroy(&job.scene);
}

START_TEST(a_model_is_built) {
  open_job("clip");
  ck_assert_int_gt(fail_each(make_model, "model", 1, 1), 30);
  close_job();
}
END_TEST

// _i: overlap model. With contact, friction and every other effect; anew from an old one as well.
START_TEST(a_system_is_built) {
  static const char *const overlaps[] = {"clip", "geo", "hybrid"};
  open_job(overlaps[_i]);
  ck_assert_int_gt(fail_each(make_system, "system", 1, 1), 100);
  close_job();
}
END_TEST

static Status stop(void *self, const FemRunProgress *progress) {
  (void)self, (void)progress;
  return status_fail(STATUS_INTERRUPTED, "far enough");
}

// A run that is stopped says so first, and then what else it could not do.
static Status judge(Status status) {
  if (status != STATUS_INTERRUPTED) return status;
  return strstr(status_message(), "besides: ") ? STATUS_MEMORY : STATUS_OK;
}

// To the first step, with first frame and checkpoint; one that stops leaves a checkpoint, too.
static Status begin_run(const char *directory) {
  FemRunOptions options = {.directory = directory, .observe = stop};
  FemRunResult result;
  Status status = fem_run(&job.model, &options, &result);
  fem_run_result_destroy(&result);
  return judge(status);
}

START_TEST(a_run_begins) {
  open_job("clip");
  ck_assert_int_gt(fail_each(begin_run, folder, 1, 1), 200);
  close_job();
}
END_TEST

static Status read_checkpoint(const char *path) {
  FemCheckpoint checkpoint = {0}, copy = {0};
  Status status = fem_checkpoint_read(&checkpoint, path);
  if (!status) status = fem_checkpoint_copy(&copy, &checkpoint);
  if (!status) status = fem_checkpoint_write(&copy, path);
  fem_checkpoint_destroy(&copy), fem_checkpoint_destroy(&checkpoint);
  return status;
}

static Status resume(const char *path) {
  FemCheckpoint checkpoint = {0};
  Status status = fem_checkpoint_read(&checkpoint, path);
  FemRunOptions options = {.directory = folder, .observe = stop, .from = &checkpoint};
  FemRunResult result = {0};
  if (!status) status = fem_run(&job.model, &options, &result);
  fem_run_result_destroy(&result);
  fem_checkpoint_destroy(&checkpoint);
  return judge(status);
}

START_TEST(a_checkpoint_is_read_and_resumed) {
  open_job("clip");
  char path[128];
  snprintf(path, sizeof path, "%s/%s", folder, FEM_CHECKPOINT_FILE);
  ck_assert_ok(begin_run(folder));
  ck_assert_int_gt(fail_each(read_checkpoint, path, 1, 1), 12);
  ck_assert_int_gt(fail_each(resume, path, 1, 3), 200);
  close_job();
}
END_TEST

// A falling block, two frames or more in every step.
static const char falling[] = "bodies: [{name: block, mesh: {box: {size: [1, 1, 1], cells: 1}},\n"
                              "  material: {young: 1e5, poisson: .3, density: 1000}}]\n"
                              "effects: {gravity: [0, 0, -9.81]}\n"
                              "time: {end: 1, max_step: 2e-3}\n"
                              "output: {frames: 1200, checkpoint: {frames: 100, seconds: 0}}\n";

typedef struct Holding {
  size_t early, late; // bytes of ours after the step that reaches a sixth of the time, and after the last
} Holding;

static Status weigh(void *self, const FemRunProgress *progress) {
  Holding *holding = self;
  if (holding->early == 0 && progress->time > progress->end / 6) holding->early = watch.live_bytes;
  holding->late = watch.live_bytes;
  return STATUS_OK;
}

// A thousand frames, each with a line of the history, and ten checkpoints later: less than a byte a frame,
// which is room for numbers that have become longer.
START_TEST(a_run_holds_no_more_the_more_frames_it_has_written) {
  ck_assert_ok(scene_text_read("falling.yaml", falling, strlen(falling), &job.scene));
  ck_assert_ok(fem_model_create(&job.model, &job.scene));
  Holding holding = {0};
  FemRunOptions options = {.directory = folder, .observe = weigh, .observer = &holding};
  FemRunResult result;
  watch.is_on = true;
  ck_assert_ok(fem_run(&job.model, &options, &result));
  watch.is_on = false;
  fem_run_result_destroy(&result);
  char last[128];
  snprintf(last, sizeof last, "%s/frame_01200.vtu", folder);
  ck_assert_int_eq(access(last, F_OK), 0);
  ck_assert_uint_gt(holding.early, 1000);
  ck_assert_uint_lt(holding.late, holding.early + 1000);
  close_job();
}
END_TEST

int main(void) {
  log_set_level(LOG_SILENT);
  omp_set_num_threads(1);
  TCase *test_case = tcase_create("allocation");
  tcase_add_checked_fixture(test_case, make_folder, remove_folder);
  tcase_add_test(test_case, a_scene_is_read);
  tcase_add_loop_test(test_case, a_mesh_is_read, 0, 3);
  tcase_add_test(test_case, an_overlap_model_is_made_and_asked);
  tcase_add_test(test_case, a_data_set_is_written_and_read);
  tcase_add_test(test_case, a_model_is_built);
  tcase_add_loop_test(test_case, a_system_is_built, 0, 3);
  tcase_add_test(test_case, a_run_begins);
  tcase_add_test(test_case, a_checkpoint_is_read_and_resumed);
  tcase_add_test(test_case, a_run_holds_no_more_the_more_frames_it_has_written);
  return suite_run("allocation", test_case, 60);
}
