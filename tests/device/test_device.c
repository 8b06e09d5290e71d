// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels on every device that there is, against the models of the same name on this processor: to the bit.
// Without an OpenCL driver (pocl is one) only `host` runs, and a line says so.
#include "devices.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "datagen/hard.h"
#include "device/backend/cache.h"
#include "device/backend/cuda.h"
#include "net/kernel/bf16.h"
#include "overlap/clip/lanes.h"
#include "overlap/models.h"
#include "overlap/tpn/portion.h"
#include "overlap/weights.h"

enum { COUNT = 4099, MEMBERS = 96, MODELS = 5 }; // models: those that answer to the bit

// Answers of a model, to all of a batch.
typedef struct Answers {
  double *volume, *gradient; // (count), (count, 24)
  unsigned *flags;           // (count)
} Answers;

static Answers make_answers(int count) {
  size_t n = (size_t)count;
  return (Answers){memory_zeroed(n, 8), memory_zeroed(n * 24, 8), memory_zeroed(n, sizeof(unsigned))};
}

static void destroy_answers(Answers *answers) {
  memory_free(answers->volume), memory_free(answers->gradient), memory_free(answers->flags);
}

static OverlapBatch batch_of(const double *pairs, int count, const Answers *answers, bool has_gradient) {
  return (OverlapBatch){.pair_count = count,
                        .pairs = pairs,
                        .volume = answers->volume,
                        .gradient = has_gradient ? answers->gradient : NULL,
                        .flags = answers->flags};
}

// The sums of `tpn-bf16` in a fixed order: not by the instructions that add pairs of products.
static void use_emulation(const OverlapModel *model) {
  const OverlapTpnNetwork *network = &((OverlapTpnModel *)model->self)->model;
  for (int k = 0; k < network->workspace_count; k++)
    network->workspaces[k].work.kernel = &net_kernel_bf16_emulated;
}

static void ask_processor(const char *name, const double *pairs, int count, bool has_gradient,
                          Answers *answers) {
  OverlapModel model;
  OverlapBatch batch = batch_of(pairs, count, answers, has_gradient);
  ck_assert_ok(overlap_models_create(&model, name));
  if (strcmp(name, "tpn-bf16") == 0) use_emulation(&model);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  overlap_model_destroy(&model);
}

// A network on a device does not tell pairs unlike those that it was trained on.
static bool is_same_answer(const Answers *a, const Answers *b, int i, bool has_gradient) {
  size_t at = (size_t)i;
  unsigned untold = b->flags[at] & OVERLAP_NET ? OVERLAP_BEYOND : 0;
  return memcmp(&a->volume[at], &b->volume[at], 8) == 0 && a->flags[at] == (b->flags[at] & ~untold) &&
         (!has_gradient || memcmp(&a->gradient[24 * at], &b->gradient[24 * at], 24 * 8) == 0);
}

// A driver's exponential rounds otherwise than the processor's: of tpn, where a coordinate is compressed, ∇V
// is the processor's but for that, times what cancels where the first tetrahedron is flat.
static bool is_close_slope(const Answers *a, const Answers *b, int i) {
  const double *p = a->gradient + 24 * (size_t)i, *q = b->gradient + 24 * (size_t)i;
  double largest = 0, furthest = 0;
  for (int c = 0; c < 24; c++) {
    largest = fmax(largest, fabs(q[c]));
    if (!(fabs(p[c] - q[c]) <= furthest)) furthest = fabs(p[c] - q[c]);
  }
  return is_same_answer(a, b, i, false) && furthest <= 1e-12 * largest;
}

// Without vectors, or fused multiply-adds for networks, the processor's model is another.
static bool is_comparable(const Device *device, const char *model) {
  // tensor cores add in an order of their own: test_device_bf16.c
  if (strcmp(model, "tpn-bf16") == 0 && device->ops == &device_cuda) return false;
  bool is_clip = strncmp(model, "clip", 4) == 0;
  if (is_clip ? overlap_clip_lanes() != NULL : net_kernel_best() != NET_KERNEL_BLAS) return true;
  printf("%s is not compared: this processor computes it in another way\n", model);
  return false;
}

// A doubtful pair of clip32 is answered by clip on a device.
static void check_same(const Device *device, const char *model, const double *pairs, int count,
                       bool has_gradient, const Answers *answers, const char *what) {
  Answers expected = make_answers(count), careful = make_answers(count);
  bool is_single = strcmp(model, "clip32") == 0;
  bool is_rounded = has_gradient && (strcmp(model, "tpn") == 0 || strcmp(model, "tpn-bf16") == 0) &&
                    device->ops != &device_host;
  int others = 0;
  ask_processor(model, pairs, count, has_gradient, &expected);
  ask_processor("clip", pairs, count, has_gradient, &careful);
  for (int i = 0; i < count; i++) {
    if (is_same_answer(answers, &expected, i, has_gradient)) continue;
    if (is_rounded && is_close_slope(answers, &expected, i)) continue;
    ck_assert_msg(is_single && is_same_answer(answers, &careful, i, has_gradient),
                  "%s, pair %d: V = %.17g, flags %u; %s on the processor %.17g, flags %u", what, i,
                  answers->volume[i], answers->flags[i], model, expected.volume[i], expected.flags[i]);
    others++;
  }
  ck_assert_int_le(others, is_single ? count : 0);
  destroy_answers(&expected), destroy_answers(&careful);
}

static void check_batch(const Device *device, const char *model, const double *pairs, int count,
                        const char *what) {
  DeviceOverlap overlap;
  Answers answers = make_answers(count);
  ck_assert_ok(device_overlap_create(&overlap, device, model));
  for (int has_gradient = 0; has_gradient <= 1; has_gradient++) {
    OverlapBatch batch = batch_of(pairs, count, &answers, has_gradient);
    memset(answers.volume, 0x55, (size_t)count * 8);
    memset(answers.gradient, 0x55, (size_t)count * 24 * 8);
    ck_assert_ok(device_overlap_eval(&overlap, &batch));
    if (is_comparable(device, model)) check_same(device, model, pairs, count, has_gradient, &answers, what);
  }
  device_overlap_destroy(&overlap);
  destroy_answers(&answers);
}

START_TEST(bench_sets_are_answered_to_the_bit) {
  const Device *device = &devices[_i / MODELS];
  const char *model = device_overlap_models[_i % MODELS];
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    ck_assert_ok(app_bench_pairs_make(app_bench_sets[set], COUNT, 3, pairs));
    check_batch(device, model, pairs, COUNT, app_bench_sets[set]);
  }
  memory_free(pairs);
}
END_TEST

START_TEST(hard_pairs_are_answered_to_the_bit) {
  const Device *device = &devices[_i / MODELS];
  const char *model = device_overlap_models[_i % MODELS];
  int count = DATAGEN_HARD_CLASS_COUNT * MEMBERS;
  double *pairs = memory_zeroed((size_t)count * 24, sizeof *pairs);
  for (int i = 0; i < count; i++)
    memcpy(pairs + (size_t)i * 24, datagen_hard_make(i / MEMBERS, i % MEMBERS).x, 24 * sizeof *pairs);
  check_batch(device, model, pairs, count, "hard pairs");
  memory_free(pairs);
}
END_TEST

static const char *const normalisations[] = {"unit", "unscaled", "sorted", "axis"};
enum { NORMALISATIONS = 4 };

// The network of tpn behind another normalisation, as net/weights/tpn.safetensors in `folder`.
static void write_normalised(const char *normalisation, const char *folder) {
  char path[4096], text[64];
  NetModel_f32 network;
  NetCard card;
  ck_assert_ok(overlap_weights_find("tpn", path, sizeof path));
  ck_assert_int_eq(net_weights_read_f32(path, &network, &card), NET_OK);
  snprintf(text, sizeof text, "%s, V times 33", normalisation);
  NetCard written = {.normalisation = text, .range = card.range, .provenance = card.provenance};
  snprintf(path, sizeof path, "%s/net/weights/tpn.safetensors", folder);
  ck_assert_int_eq(net_weights_write_f32(path, &network, &written), NET_OK);
  net_weights_card_destroy(&card);
  net_model_destroy_f32(&network);
}

static void make_folder(const char *root, const char *name, char path[64]) {
  snprintf(path, 64, "%s%s", root, name);
  ck_assert_int_eq(mkdir(path, 0700), 0);
}

// Which of the two tetrahedra is flat decides differently by normalisation; the bench sets' pairs have
// faces that nearly separate them.
START_TEST(normalisations_are_answered_to_the_bit) {
  const Device *device = &devices[_i / NORMALISATIONS];
  const char *normalisation = normalisations[_i % NORMALISATIONS];
  const int hard = DATAGEN_HARD_CLASS_COUNT * MEMBERS, count = hard + COUNT;
  char root[] = "/tmp/tetlap-normalised-XXXXXX", net[64], weights[64], file[96];
  char *kept = getenv("TETLAP_DATA");
  double *pairs = memory_zeroed((size_t)count * 24, sizeof *pairs);
  ck_assert_ptr_nonnull(mkdtemp(root));
  make_folder(root, "/net", net);
  make_folder(root, "/net/weights", weights);
  snprintf(file, sizeof file, "%s/tpn.safetensors", weights);
  if (kept) ck_assert_ptr_nonnull(kept = strdup(kept));
  write_normalised(normalisation, root);
  ck_assert_ok(app_bench_pairs_make("near", COUNT, 4, pairs));
  for (int i = 0; i < hard; i++)
    memcpy(pairs + (size_t)(COUNT + i) * 24, datagen_hard_make(i / MEMBERS, i % MEMBERS).x,
           24 * sizeof *pairs);
  setenv("TETLAP_DATA", root, 1);
  check_batch(device, "tpn", pairs, count, normalisation);
  if (kept)
    setenv("TETLAP_DATA", kept, 1);
  else
    unsetenv("TETLAP_DATA");
  unlink(file), rmdir(weights), rmdir(net), rmdir(root);
  free(kept), memory_free(pairs);
}
END_TEST

// Pairs of a set as two meshes: each tetrahedron has vertices of its own.
static void check_residences(const Device *device, const double *pairs) {
  DeviceOverlap overlap;
  Answers rows = make_answers(COUNT), others = make_answers(COUNT);
  double *columns = memory_zeroed(COUNT * 24, sizeof *columns);
  int *tets = memory_zeroed(COUNT * 8, sizeof *tets), *ends = memory_zeroed(COUNT * 2, sizeof *ends);
  for (int i = 0; i < COUNT; i++)
    for (int c = 0; c < 24; c++) columns[(size_t)c * COUNT + (size_t)i] = pairs[(size_t)i * 24 + (size_t)c];
  for (int k = 0; k < 8 * COUNT; k++) tets[k] = k;
  for (int k = 0; k < 2 * COUNT; k++) ends[k] = k;
  OverlapBatch batch = batch_of(pairs, COUNT, &rows, true);
  ck_assert_ok(device_overlap_create(&overlap, device, "clip"));
  ck_assert_ok(device_overlap_eval(&overlap, &batch));
  for (int kind = 0; kind < 2; kind++) {
    ck_assert_ok(kind == 0
                     ? device_overlap_put_columns(&overlap, COUNT, columns)
                     : device_overlap_put_mesh(&overlap, 8 * COUNT, pairs, 2 * COUNT, tets, COUNT, ends));
    ck_assert_ok(device_overlap_run(&overlap, DEVICE_GRADIENT));
    ck_assert_ok(device_overlap_get(&overlap, others.volume, others.gradient, others.flags));
    ck_assert_mem_eq(rows.volume, others.volume, COUNT * sizeof(double));
    ck_assert_mem_eq(rows.flags, others.flags, COUNT * sizeof(unsigned));
    for (int i = 0; i < COUNT; i++)
      for (int c = 0; c < 24; c++)
        ck_assert(memcmp(&rows.gradient[24 * i + c], &others.gradient[COUNT * c + i], sizeof(double)) == 0);
  }
  device_overlap_destroy(&overlap);
  destroy_answers(&rows), destroy_answers(&others);
  memory_free(columns), memory_free(tets), memory_free(ends);
}

// By rows, of a bench set and hard pairs at once.
START_TEST(centroids_are_answered_to_the_bit) {
  const Device *device = &devices[_i / 2];
  const char *name = device_overlap_models[_i % 2];
  const int hard = DATAGEN_HARD_CLASS_COUNT * MEMBERS, count = hard + COUNT;
  double *pairs = memory_zeroed((size_t)count * 24, sizeof *pairs);
  Answers answers = make_answers(count), expected = make_answers(count), careful = make_answers(count);
  const Answers *all[3] = {&answers, &expected, &careful};
  DeviceOverlap overlap;
  OverlapModel model;
  int inside = 0;
  ck_assert_ok(app_bench_pairs_make("uniform", COUNT, 5, pairs));
  for (int i = 0; i < hard; i++)
    memcpy(pairs + (size_t)(COUNT + i) * 24, datagen_hard_make(i / MEMBERS, i % MEMBERS).x,
           24 * sizeof *pairs);
  ck_assert_ok(device_overlap_create(&overlap, device, name));
  for (int k = 0; k < 3; k++) {
    OverlapBatch batch = batch_of(pairs, count, all[k], false);
    batch.centroid = all[k]->gradient;
    if (k == 0) {
      ck_assert_ok(device_overlap_eval(&overlap, &batch));
      continue;
    }
    ck_assert_ok(overlap_models_create(&model, k == 1 ? name : "clip"));
    ck_assert_ok(overlap_model_eval(&model, &batch));
    overlap_model_destroy(&model);
  }
  const bool is_compared = is_comparable(device, name);
  for (int i = 0; i < count && is_compared; i++) {
    bool is_same = memcmp(answers.gradient + 3 * i, expected.gradient + 3 * i, 3 * sizeof(double)) == 0,
         is_careful = memcmp(answers.gradient + 3 * i, careful.gradient + 3 * i, 3 * sizeof(double)) == 0;
    ck_assert_msg(is_same || (is_careful && _i % 2), "%s, pair %d: %.17g, expected %.17g", name, i,
                  answers.gradient[3 * i], expected.gradient[3 * i]);
    inside += answers.volume[i] > 0;
  }
  ck_assert(inside > COUNT / 2 || !is_compared);
  device_overlap_destroy(&overlap);
  destroy_answers(&answers), destroy_answers(&expected), destroy_answers(&careful);
  memory_free(pairs);
}
END_TEST

START_TEST(where_the_numbers_lie_does_not_matter) {
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  ck_assert_ok(app_bench_pairs_make("uniform", COUNT, 8, pairs));
  check_residences(&devices[_i], pairs);
  memory_free(pairs);
}
END_TEST

START_TEST(doubtful_pairs_are_handed_on_and_counted) {
  DeviceOverlap overlap;
  double *pairs = memory_zeroed(COUNT * 24, sizeof *pairs);
  Answers answers = make_answers(COUNT);
  OverlapBatch batch = batch_of(pairs, COUNT, &answers, false);
  ck_assert_ok(app_bench_pairs_make("uniform", COUNT, 3, pairs));
  ck_assert_ok(device_overlap_create(&overlap, &devices[_i], "clip32"));
  ck_assert_ok(device_overlap_eval(&overlap, &batch));
  ck_assert_int_gt(overlap.handed_on[0], COUNT / 100);
  ck_assert_int_lt(overlap.handed_on[1], overlap.handed_on[0] / 10);
  device_overlap_destroy(&overlap);
  destroy_answers(&answers), memory_free(pairs);
}
END_TEST

START_TEST(a_pair_that_is_not_finite_is_named) {
  expect_named(&devices[_i], "clip");
}
END_TEST

int main(void) {
  setenv("CK_FORK", "no", 1); // a driver's threads do not survive a fork
  open_devices();
  TCase *cases = tcase_create("device");
  tcase_add_loop_test(cases, bench_sets_are_answered_to_the_bit, 0, device_count * MODELS);
  tcase_add_loop_test(cases, hard_pairs_are_answered_to_the_bit, 0, device_count * MODELS);
  tcase_add_loop_test(cases, normalisations_are_answered_to_the_bit, 0, device_count * NORMALISATIONS);
  tcase_add_loop_test(cases, centroids_are_answered_to_the_bit, 0, device_count * 2);
  tcase_add_loop_test(cases, where_the_numbers_lie_does_not_matter, 0, device_count);
  tcase_add_loop_test(cases, doubtful_pairs_are_handed_on_and_counted, 0, device_count);
  tcase_add_loop_test(cases, a_pair_that_is_not_finite_is_named, 0, device_count);
  int result = suite_run("device", cases, 300);
  close_devices();
  return result;
}
