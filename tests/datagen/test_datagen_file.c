// SPDX-License-Identifier: GPL-3.0-or-later
// Data set files: what is written is read, by any number of threads and shards the same, and what is wrong
// with a file is said.
#include "suite.h"

#include <limits.h>
#include <omp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "datagen/capture.h"
#include "datagen/files/dataset.h"
#include "datagen/files/merge.h"
#include "datagen/generate.h"
#include "datagen/hard.h"
#include "datagen/run.h"
#include "overlap/pair/invariant.h"

enum { COUNT = 9000, BLOCK = 1024 }; // more than two chunks

static char directory[] = "/tmp/tetlap_datagen_XXXXXX";

// A path in the test's own directory; good until the eighth call after.
static const char *path_of(const char *name) {
  static char paths[8][256];
  static int next;
  char *path = paths[next++ % 8];
  snprintf(path, sizeof paths[0], "%s/%s", directory, name);
  return path;
}

static void make_directory(void) {
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static void remove_directory(void) {
  char command[64];
  snprintf(command, sizeof command, "rm -r %s", directory);
  ck_assert_int_eq(system(command), 0);
}

static DatagenPlan make_plan(long long count, bool wants_gradient) {
  DatagenLaw law;
  DatagenPlan plan;
  ck_assert_ok(datagen_law_find("paper-train", &law));
  ck_assert_ok(datagen_law_parse_mix(law.mix, "none=30,vertex-face=10,edge-face=10,face-face=10,"
                                              "volumetric=10,vertex-vertex=5,vertex-edge=5,edge-edge=5,scene="
                                              "10,scene-none=5"));
  ck_assert_ok(datagen_plan_make(&plan, &law, 42, count));
  plan.wants_gradient = wants_gradient;
  return plan;
}

static Status run_shard(const DatagenPlan *plan, const char *name, int shard, int shard_count) {
  DatagenRunOptions options = {.path = path_of(name), .program = "test 1", .block = BLOCK};
  datagen_plan_shard(plan, shard, shard_count, &options.first, &options.count);
  return datagen_run(plan, &options);
}

// All pairs of a file; the caller destroys them.
static DatagenPairs read_all(const char *name, DatagenInfo *info) {
  DatagenDataset *dataset;
  DatagenPairs pairs;
  ck_assert_ok(datagen_dataset_open(&dataset, path_of(name)));
  *info = *datagen_dataset_info(dataset);
  ck_assert_ok(datagen_pairs_create(&pairs, (size_t)info->count, info->has_gradient));
  ck_assert_ok(datagen_dataset_read(dataset, 0, (size_t)info->count, &pairs));
  datagen_dataset_close(dataset);
  return pairs;
}

static void assert_same_pairs(const DatagenPairs *a, size_t first, const DatagenPairs *b, size_t count) {
  ck_assert(memcmp(a->coordinates + 24 * first, b->coordinates, 24 * count * sizeof(double)) == 0);
  ck_assert(memcmp(a->status + first, b->status, count) == 0);
  ck_assert(memcmp(a->kind + first, b->kind, count) == 0);
  ck_assert(memcmp(a->volume + first, b->volume, count * sizeof(double)) == 0);
  ck_assert_int_eq(!a->gradient, !b->gradient);
  ck_assert(memcmp(a->centroid + 3 * first, b->centroid, 3 * count * sizeof(double)) == 0);
  if (a->gradient) ck_assert(memcmp(a->gradient + 24 * first, b->gradient, 24 * count * sizeof(double)) == 0);
}

static void assert_same_files(const char *first, const char *second) {
  DatagenInfo info[2];
  DatagenPairs a = read_all(first, &info[0]), b = read_all(second, &info[1]);
  ck_assert_mem_eq(&info[0], &info[1], sizeof info[0]);
  assert_same_pairs(&a, 0, &b, (size_t)info[0].count);
  datagen_pairs_destroy(&a);
  datagen_pairs_destroy(&b);
}

START_TEST(a_file_holds_what_the_generator_made) {
  DatagenPlan plan = make_plan(COUNT, _i);
  DatagenPairs made;
  DatagenInfo info;
  long long attempts[DATAGEN_KIND_COUNT] = {0};
  ck_assert_ok(datagen_pairs_create(&made, COUNT, _i));
  ck_assert_ok(datagen_generate(&plan, 0, COUNT, &made, attempts));
  ck_assert_ok(run_shard(&plan, "a.h5", 1, 1));
  DatagenPairs held = read_all("a.h5", &info);
  ck_assert_int_eq(info.count, COUNT);
  assert_same_pairs(&held, 0, &made, COUNT);
  ck_assert_mem_eq(info.kind_counts, plan.kind_counts, sizeof info.kind_counts);
  ck_assert_mem_eq(info.attempts, attempts, sizeof info.attempts);
  ck_assert_str_eq(info.law, "paper-train");
  ck_assert_str_eq(info.volume_law, "log-uniform:1e-07:0.02");
  ck_assert_str_eq(info.program, "test 1");
  ck_assert_str_eq(info.label, "exact");
  ck_assert(info.seed == 42 && info.total == COUNT && info.first == 0 && info.planned == COUNT);
  ck_assert_int_eq(info.generator_version, DATAGEN_GENERATOR_VERSION);
  datagen_pairs_destroy(&made);
  datagen_pairs_destroy(&held);
}
END_TEST

START_TEST(any_range_and_any_array_can_be_read_by_itself) {
  DatagenPlan plan = make_plan(COUNT, false);
  DatagenInfo info;
  ck_assert_ok(run_shard(&plan, "a.h5", 1, 1));
  DatagenPairs all = read_all("a.h5", &info);
  DatagenDataset *dataset;
  double volume[100], coordinates[24];
  ck_assert_ok(datagen_dataset_open(&dataset, path_of("a.h5")));
  ck_assert_ok(datagen_dataset_read(dataset, 4050, 100, &(DatagenPairs){.volume = volume}));
  ck_assert_mem_eq(volume, all.volume + 4050, sizeof volume);
  ck_assert_ok(datagen_dataset_read(dataset, COUNT - 1, 1, &(DatagenPairs){.coordinates = coordinates}));
  ck_assert_mem_eq(coordinates, all.coordinates + 24 * (COUNT - 1), sizeof coordinates);
  ck_assert_ok(datagen_dataset_read(dataset, COUNT, 0, &(DatagenPairs){.volume = volume}));
  ck_assert_int_eq(datagen_dataset_read(dataset, COUNT - 99, 100, &(DatagenPairs){.volume = volume}),
                   STATUS_INPUT);
  ck_assert_int_eq(datagen_dataset_read(dataset, -1, 1, &(DatagenPairs){.volume = volume}), STATUS_INPUT);
  ck_assert_int_eq(datagen_dataset_read(dataset, 0, 1, &(DatagenPairs){.gradient = coordinates}),
                   STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "no gradients"));
  datagen_dataset_close(dataset);
  datagen_pairs_destroy(&all);
}
END_TEST

START_TEST(threads_do_not_show_in_the_file) {
  DatagenPlan plan = make_plan(COUNT, true);
  for (int threads = 1; threads <= 5; threads += 2) {
    char name[16], *text[2];
    size_t size[2];
    snprintf(name, sizeof name, "%d.h5", threads);
    omp_set_num_threads(threads);
    ck_assert_ok(run_shard(&plan, name, 1, 1));
    ck_assert_ok(file_read(path_of("1.h5"), &text[0], &size[0]));
    ck_assert_ok(file_read(path_of(name), &text[1], &size[1]));
    ck_assert(size[0] == size[1] && memcmp(text[0], text[1], size[0]) == 0);
    memory_free(text[0]);
    memory_free(text[1]);
  }
}
END_TEST

START_TEST(shards_merged_in_any_order_are_the_whole) {
  DatagenPlan plan = make_plan(COUNT, true);
  ck_assert_ok(run_shard(&plan, "whole.h5", 1, 1));
  ck_assert_ok(run_shard(&plan, "1.h5", 1, 3));
  ck_assert_ok(run_shard(&plan, "2.h5", 2, 3));
  ck_assert_ok(run_shard(&plan, "3.h5", 3, 3));
  const char *paths[] = {path_of("3.h5"), path_of("1.h5"), path_of("2.h5")};
  ck_assert_ok(datagen_merge(paths, 3, path_of("merged.h5"), false));
  assert_same_files("whole.h5", "merged.h5");
}
END_TEST

START_TEST(what_is_no_set_of_shards_is_refused_by_what_is_wrong) {
  DatagenPlan plan = make_plan(COUNT, false), other = plan;
  other.seed = 43;
  ck_assert_ok(run_shard(&plan, "1.h5", 1, 3));
  ck_assert_ok(run_shard(&plan, "2.h5", 2, 3));
  ck_assert_ok(run_shard(&plan, "3.h5", 3, 3));
  ck_assert_ok(run_shard(&other, "other.h5", 2, 3));
  const char *gap[] = {path_of("1.h5"), path_of("3.h5")}, *twice[] = {path_of("1.h5"), path_of("1.h5")},
             *mixed[] = {path_of("1.h5"), path_of("other.h5")};
  const char *output = path_of("merged.h5");
  ck_assert_int_eq(datagen_merge(gap, 2, output, false), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "pairs 3000 to 5999 are missing"), "%s", status_message());
  ck_assert_int_eq(datagen_merge(twice, 2, output, false), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "both hold pair 0"), "%s", status_message());
  ck_assert_int_eq(datagen_merge(mixed, 2, output, false), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "differ in the seed"), "%s", status_message());
  ck_assert(!file_exists(output));
  ck_assert_ok(datagen_merge(mixed, 2, output, true));
  DatagenInfo info;
  DatagenPairs pairs = read_all("merged.h5", &info);
  ck_assert_int_eq(info.count, 6000);
  ck_assert_str_eq(info.law, "mixed");
  datagen_pairs_destroy(&pairs);
}
END_TEST

typedef struct Interrupter {
  volatile sig_atomic_t flag;
  int blocks_left;
} Interrupter;

static void interrupt_later(void *observer, const DatagenProgress *progress) {
  Interrupter *interrupter = observer;
  ck_assert(progress->planned == COUNT && progress->done <= COUNT);
  if (--interrupter->blocks_left == 0) interrupter->flag = 1;
}

START_TEST(interrupted_after_some_blocks_it_keeps_them) {
  DatagenPlan plan = make_plan(COUNT, true);
  ck_assert_ok(run_shard(&plan, "whole.h5", 1, 1));
  Interrupter interrupter = {.blocks_left = _i};
  DatagenRunOptions options = {.path = path_of("part.h5"),
                               .program = "test 1",
                               .count = COUNT,
                               .block = BLOCK,
                               .stop = &interrupter.flag,
                               .observe = interrupt_later,
                               .observer = &interrupter};
  ck_assert_int_eq(datagen_run(&plan, &options), STATUS_INTERRUPTED);
  DatagenInfo info[2];
  DatagenPairs whole = read_all("whole.h5", &info[0]), part = read_all("part.h5", &info[1]);
  ck_assert_int_eq(info[1].count, _i * BLOCK);
  ck_assert_int_eq(info[1].planned, COUNT);
  assert_same_pairs(&whole, 0, &part, (size_t)info[1].count);
  datagen_pairs_destroy(&whole);
  datagen_pairs_destroy(&part);
}
END_TEST

START_TEST(interrupted_before_the_first_block_it_leaves_no_file) {
  DatagenPlan plan = make_plan(COUNT, false);
  volatile sig_atomic_t flag = 1;
  DatagenRunOptions options = {.path = path_of("a.h5"), .program = "test 1", .count = COUNT, .stop = &flag};
  ck_assert_int_eq(datagen_run(&plan, &options), STATUS_INTERRUPTED);
  char command[80];
  snprintf(command, sizeof command, "test -z \"$(ls %s)\"", directory);
  ck_assert_int_eq(system(command), 0);
}
END_TEST

START_TEST(a_place_that_cannot_be_written_is_an_error) {
  DatagenPlan plan = make_plan(10, false);
  ck_assert_int_eq(run_shard(&plan, "missing/a.h5", 1, 1), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "missing/a.h5"));
}
END_TEST

START_TEST(without_memory_it_fails_cleanly) {
  DatagenPlan plan = make_plan(100, true);
  int failures = 0;
  for (long k = 1; k < 40; k++) {
    memory_fail_at(k);
    Status status = run_shard(&plan, "a.h5", 1, 1);
    memory_fail_at(0);
    if (status == STATUS_OK) break;
    ck_assert_int_eq(status, STATUS_MEMORY);
    ck_assert(!file_exists(path_of("a.h5")));
    failures++;
  }
  ck_assert_int_ge(failures, 6);
  DatagenDataset *dataset;
  memory_fail_at(1);
  ck_assert_int_eq(datagen_dataset_open(&dataset, path_of("a.h5")), STATUS_MEMORY);
  memory_fail_at(2);
  ck_assert_int_eq(datagen_dataset_open(&dataset, path_of("a.h5")), STATUS_MEMORY);
  memory_fail_at(0);
}
END_TEST

static void write_bytes(const char *name, const char *bytes, size_t size) {
  FILE *stream = fopen(path_of(name), "wb");
  ck_assert_ptr_nonnull(stream);
  ck_assert_uint_eq(fwrite(bytes, 1, size, stream), size);
  ck_assert_int_eq(fclose(stream), 0);
}

// A copy of the file with the first occurrence of `from` replaced.
static void write_patched(const char *bytes, size_t size, const char *from, size_t length, const char *to) {
  char *copy = memory_copy(bytes, size, 1);
  size_t at = 0;
  while (at + length <= size && memcmp(copy + at, from, length) != 0) at++;
  ck_assert_msg(at + length <= size, "no %s", from);
  memcpy(copy + at, to, length);
  write_bytes("wrong.h5", copy, size);
  memory_free(copy);
}

static void assert_refused(const char *reason) {
  DatagenDataset *dataset;
  ck_assert_int_eq(datagen_dataset_open(&dataset, path_of("wrong.h5")), STATUS_INPUT);
  ck_assert_ptr_null(dataset);
  ck_assert_msg(strstr(status_message(), reason) && strstr(status_message(), "wrong.h5"), "%s, not %s",
                status_message(), reason);
}

START_TEST(foreign_and_damaged_files_are_refused_by_what_is_wrong) {
  DatagenPlan plan = make_plan(COUNT, true);
  char *bytes;
  size_t size;
  ck_assert_ok(run_shard(&plan, "a.h5", 1, 1));
  ck_assert_ok(file_read(path_of("a.h5"), &bytes, &size));

  write_bytes("wrong.h5", "", 0);
  assert_refused("not an HDF5 file");
  write_bytes("wrong.h5", "vertices 1 2 3\n", 15);
  assert_refused("not an HDF5 file");
  static const double kept[] = {0.001, 0.1, 0.5, 0.99};
  for (int k = 0; k < 4; k++) {
    write_bytes("wrong.h5", bytes, (size_t)((double)size * kept[k]));
    assert_refused("truncated");
  }
  write_patched(bytes, size, "tetlap pairs", 13, "tetlap pears");
  assert_refused("'format' names another");
  write_patched(bytes, size, "format\0", 7, "farmet");
  assert_refused("no attribute 'format'");
  write_patched(bytes, size, "swap_share", 11, "swap_shore");
  assert_refused("no attribute 'swap_share'");
  write_patched(bytes, size, "volume\0", 7, "valume");
  assert_refused("no array 'volume'");
  memory_free(bytes);
}
END_TEST

// Found by tools/fuzz: first + planned overflows.
START_TEST(a_range_beyond_what_an_integer_holds_is_refused) {
  DatagenInfo info = {.generator_version = DATAGEN_GENERATOR_VERSION,
                      .program = "test",
                      .law = "mixed",
                      .label = "exact",
                      .first = LLONG_MAX - 2,
                      .planned = 8,
                      .total = 8};
  DatagenWriter *writer;
  ck_assert_ok(datagen_dataset_writer_begin(&writer, path_of("wrong.h5"), &info));
  ck_assert_ok(datagen_dataset_writer_commit(writer));
  assert_refused("claims 8 pairs from 9223372036854775805 on of 8");
}
END_TEST

START_TEST(a_flipped_bit_among_the_numbers_is_found_when_it_is_read) {
  DatagenPlan plan = make_plan(COUNT, false);
  DatagenInfo info;
  char *bytes;
  size_t size;
  ck_assert_ok(run_shard(&plan, "a.h5", 1, 1));
  ck_assert_ok(file_read(path_of("a.h5"), &bytes, &size));
  DatagenPairs pairs = read_all("a.h5", &info);
  double changed = nextafter(pairs.coordinates[24 * 5000], 2);
  write_patched(bytes, size, (const char *)&pairs.coordinates[24 * 5000], 8, (const char *)&changed);
  DatagenDataset *dataset;
  ck_assert_ok(datagen_dataset_open(&dataset, path_of("wrong.h5")));
  ck_assert_ok(datagen_dataset_read(dataset, 0, 4096, &pairs)); // the chunk before it is whole
  ck_assert_int_eq(datagen_dataset_read(dataset, 4096, 1, &pairs), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "'coordinates' is damaged"), "%s", status_message());
  datagen_dataset_close(dataset);
  datagen_pairs_destroy(&pairs);
  memory_free(bytes);
}
END_TEST

START_TEST(impossible_pairs_are_not_written) {
  DatagenPlan plan = make_plan(100, true);
  DatagenInfo info = datagen_dataset_info_of_plan(&plan, "test 1", 0, 100);
  static const char *const reasons[] = {"coordinate", "derivative", "status",       "kind",
                                        "volume",     "volume",     "says disjoint"};
  for (int k = 0; k < 7; k++) {
    DatagenPairs pairs;
    DatagenWriter *writer;
    ck_assert_ok(datagen_pairs_create(&pairs, 3, true));
    if (k == 0) pairs.coordinates[2 * 24 + 5] = NAN;
    if (k == 1) pairs.gradient[2 * 24 + 23] = INFINITY;
    if (k == 2) pairs.status[2] = 2;
    if (k == 3) pairs.kind[2] = DATAGEN_KIND_COUNT;
    if (k == 4) pairs.volume[2] = -1e-300;
    if (k == 5) pairs.volume[2] = NAN;
    if (k == 6) pairs.volume[2] = 1e-3;
    ck_assert_ok(datagen_dataset_writer_begin(&writer, path_of("a.h5"), &info));
    ck_assert_int_eq(datagen_dataset_writer_append(writer, &pairs, 3, NULL), STATUS_INPUT);
    ck_assert_msg(strstr(status_message(), reasons[k]) && strstr(status_message(), "pair 2"), "%s",
                  status_message());
    datagen_dataset_writer_abandon(writer);
    datagen_pairs_destroy(&pairs);
  }
}
END_TEST

// Pairs in any unit, of every class that overlap models are tested on: those with volume are kept, scaled.
START_TEST(captured_pairs_are_scaled_proven_and_labelled) {
  enum { MEMBERS = 30, ALL = MEMBERS * DATAGEN_HARD_CLASS_COUNT };
  static double pairs[ALL * 24];
  int flat = 0;
  for (int i = 0; i < ALL; i++) {
    DatagenHardPair c = datagen_hard_make(i / MEMBERS, i % MEMBERS);
    memcpy(pairs + 24 * i, c.x, sizeof c.x);
    flat += c.is_flat;
  }
  DatagenCapture capture;
  ck_assert_ok(datagen_capture_begin(&capture, path_of("a.h5"), "test 1", DATAGEN_LABEL_CLIP));
  ck_assert_ok(datagen_capture_append(&capture, pairs, ALL));
  ck_assert_int_eq(capture.flat, flat);
  ck_assert_ok(datagen_capture_commit(&capture));
  DatagenInfo info;
  DatagenPairs held = read_all("a.h5", &info);
  ck_assert_int_eq(info.count, ALL - flat);
  ck_assert_int_gt(info.kind_counts[DATAGEN_SCENE_NONE], 0);
  ck_assert_int_eq(info.kind_counts[DATAGEN_CAPTURED] + info.kind_counts[DATAGEN_SCENE_NONE], ALL - flat);
  ck_assert(info.total == info.count && info.planned == info.count && info.has_gradient);
  int intersecting = 0;
  for (int i = 0; i < info.count; i++) {
    intersecting += held.volume[i] > 0;
    ck_assert_int_eq(held.kind[i], held.status[i] ? DATAGEN_CAPTURED : DATAGEN_SCENE_NONE);
    for (int c = 0; c < 24; c++)
      ck_assert(held.coordinates[24 * i + c] >= 0 && held.coordinates[24 * i + c] <= 1);
  }
  ck_assert_int_ge(intersecting, ALL / 4);
  datagen_pairs_destroy(&held);
}
END_TEST

// V scales with the cube of lengths: what was captured in millimetres or far away has the same label.
START_TEST(a_capture_does_not_depend_on_the_unit) {
  static double pairs[2 * 24];
  DatagenHardPair c;
  for (int member = 0; c = datagen_hard_make(2, member), !(overlap_invariant_smaller_volume(c.x) > 0.03);
       member++)
    continue;
  for (int i = 0; i < 24; i++) pairs[i] = c.x[i], pairs[24 + i] = 0x1p-10 * c.x[i] + 1;
  DatagenCapture capture;
  ck_assert_ok(datagen_capture_begin(&capture, path_of("a.h5"), "test 1", DATAGEN_LABEL_EXACT));
  ck_assert_ok(datagen_capture_append(&capture, pairs, 2));
  ck_assert_ok(datagen_capture_commit(&capture));
  DatagenInfo info;
  DatagenPairs held = read_all("a.h5", &info);
  ck_assert_near(held.volume[0], held.volume[1], 1e-11);
  for (int i = 0; i < 24; i++) ck_assert_near(held.coordinates[i], held.coordinates[24 + i], 1e-12);
  datagen_pairs_destroy(&held);
}
END_TEST

static int run_program(const char *arguments, char *output, size_t size) {
  char command[1024];
  snprintf(command, sizeof command, "cd %s && '%s' %s 2>&1", directory, TETLAP_PROGRAM, arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, size - 1, pipe)] = 0;
  int ended = pclose(pipe);
  return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
}

START_TEST(the_commands_make_tell_merge_and_draw) {
  static char output[1 << 16];
  const char *good[] = {"datagen --law scene --count 600 --seed 3 -o s.h5 --gradient clip",
                        "datagen -l paper-test -n 500 -s 4 -o 1.h5 --shard 1/2 --threads 1",
                        "datagen -l paper-test -n 500 -s 4 -o 2.h5 --shard 2/2",
                        "dataset merge 2.h5 1.h5 -o all.h5",
                        "dataset merge --mix s.h5 1.h5 -o mix.h5",
                        "datagen --list",
                        "dataset info s.h5"};
  for (size_t k = 0; k < sizeof good / sizeof *good; k++)
    ck_assert_msg(run_program(good[k], output, sizeof output) == 0, "%s: %s", good[k], output);
  ck_assert_int_eq(run_program("dataset info all.h5 --json", output, sizeof output), 0);
  ck_assert_ptr_nonnull(strstr(output, "\"pairs\": 500,"));
  ck_assert_ptr_nonnull(strstr(output, "\"volumetric\""));
  // gnuplot may be missing: the script must be there in any case, and the picture if it is not
  int plotted = run_program("dataset plot s.h5 -o s.png", output, sizeof output);
  ck_assert(file_exists(path_of("s.png.gp")));
  if (system("command -v gnuplot >/dev/null") == 0) ck_assert(plotted == 0 && file_exists(path_of("s.png")));
}
END_TEST

START_TEST(wrong_arguments_end_with_their_exit_codes) {
  static char output[1 << 16];
  const char *usage[] = {"datagen",
                         "datagen -o a.h5 --law papertrain",
                         "datagen -o a.h5 --count 0",
                         "datagen -o a.h5 --shard 0/3",
                         "datagen -o a.h5 --shard 5/10 --count 4",
                         "datagen -o a.h5 --gradient cgal",
                         "datagen -o a.h5 --gradient clip --label exact",
                         "datagen -o a.h5 --volume uniform:0:1",
                         "datagen -o a.h5 --swap 2",
                         "dataset",
                         "dataset burn a.h5",
                         "dataset merge a.h5"};
  for (size_t k = 0; k < sizeof usage / sizeof *usage; k++)
    ck_assert_msg(run_program(usage[k], output, sizeof output) == 64, "%s: %s", usage[k], output);
  ck_assert(!file_exists(path_of("a.h5")));
  ck_assert_int_eq(run_program("dataset info a.h5", output, sizeof output), 74);
  write_bytes("a.h5", "no", 2);
  ck_assert_int_eq(run_program("dataset info a.h5", output, sizeof output), 65);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("file");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_loop_test(cases, a_file_holds_what_the_generator_made, 0, 2);
  tcase_add_test(cases, any_range_and_any_array_can_be_read_by_itself);
  tcase_add_test(cases, threads_do_not_show_in_the_file);
  tcase_add_test(cases, shards_merged_in_any_order_are_the_whole);
  tcase_add_test(cases, what_is_no_set_of_shards_is_refused_by_what_is_wrong);
  tcase_add_loop_test(cases, interrupted_after_some_blocks_it_keeps_them, 1, 4);
  tcase_add_test(cases, interrupted_before_the_first_block_it_leaves_no_file);
  tcase_add_test(cases, a_place_that_cannot_be_written_is_an_error);
  tcase_add_test(cases, without_memory_it_fails_cleanly);
  tcase_add_test(cases, foreign_and_damaged_files_are_refused_by_what_is_wrong);
  tcase_add_test(cases, a_range_beyond_what_an_integer_holds_is_refused);
  tcase_add_test(cases, a_flipped_bit_among_the_numbers_is_found_when_it_is_read);
  tcase_add_test(cases, impossible_pairs_are_not_written);
  tcase_add_test(cases, captured_pairs_are_scaled_proven_and_labelled);
  tcase_add_test(cases, a_capture_does_not_depend_on_the_unit);
  tcase_add_test(cases, the_commands_make_tell_merge_and_draw);
  tcase_add_test(cases, wrong_arguments_end_with_their_exit_codes);
  return suite_run("datagen_file", cases, 120);
}
