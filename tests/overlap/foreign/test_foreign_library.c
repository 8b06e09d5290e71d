// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries of users (overlap/foreign/library.h). The oracles are `clip` and what library.c says.
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <tetlap/model.h>
#include <unistd.h>

#include "model.h"
#include "overlap/slopes.h"

// The example of a library splits tetrahedra; clip cuts polytopes.
START_TEST(a_library_answers_as_clip) {
  OverlapModel clip, split;
  double truth[PAIRS], middle[PAIRS][3];
  open_model(&clip, "clip");
  open_model(&split, TETLAP_MODEL_SPLIT);
  ck_assert(overlap_model_has_own_centroid(&split) && !overlap_model_has_gradient(&split));
  OverlapBatch batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&clip, &batch));
  memcpy(truth, volume, sizeof truth), memcpy(middle, centroid, sizeof middle);
  ck_assert_ok(overlap_model_eval(&split, &batch));
  int shared = 0;
  for (int i = 0; i < PAIRS; i++) {
    ck_assert_near(volume[i], truth[i], 1e-12);
    shared += truth[i] > 1e-6;
    for (int c = 0; c < 3 && truth[i] > 1e-6; c++) ck_assert_near(centroid[i][c], middle[i][c], 1e-7);
  }
  ck_assert_int_gt(shared, PAIRS / 10);
  batch = batch_of(PAIRS, true, false);
  ck_assert_int_eq(overlap_model_eval(&split, &batch), STATUS_INPUT);
  ck_assert(strstr(status_message(), "gives no gradient"));
  overlap_model_destroy(&clip), overlap_model_destroy(&split);
}
END_TEST

START_TEST(libraries_that_are_wrong) {
  static const struct {
    const char *path, *says;
    bool is_opened;
  } cases[] = {{TETLAP_MODEL_1, "exports no function 'tetlap_model'", false},
               {TETLAP_MODEL_2, "version 99", false},
               {TETLAP_MODEL_3, "no `size", false},
               {TETLAP_MODEL_4, "no `evaluate`", false},
               {TETLAP_MODEL_22, "its 'tetlap_model' is a variable, expected a function", false},
               {TETLAP_MODEL_20, "its range is 'radius 2 to 1', expected 'radius A to B, first", false},
               {TETLAP_MODEL_5, "(3): weights of 1 GB are not there", false},
               {TETLAP_MODEL_6, "failed with 4: the card fell out", true},
               {TETLAP_MODEL_7, "its volume is not a finite number", true}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    if (cases[i].is_opened)
      expect_failure(cases[i].path, STATUS_SOLVER, cases[i].says);
    else
      expect_refused(cases[i].path, STATUS_INPUT, cases[i].says);
  expect_refused("none.so", STATUS_IO, "none.so: cannot be opened");
  expect_refused(TETLAP_SOURCE_DIR "/tests/overlap/foreign/library.so", STATUS_IO, "cannot be opened");
}
END_TEST

// Copies the first `size` bytes of a library; of all of them where it has fewer. Returns how many it has.
static long copy_part(const char *path, long size, const char *to) {
  FILE *from = fopen(path, "rb"), *into = fopen(to, "wb");
  long count = 0;
  ck_assert(from && into);
  for (int c; count < size && (c = fgetc(from)) != EOF; count++) fputc(c, into);
  fclose(from), fclose(into);
  return count;
}

// Without the check, touching what is not there is a bus error.
START_TEST(a_library_that_is_cut_off_is_refused) {
  char folder[] = "/tmp/tetlap-foreign-XXXXXX", path[100];
  OverlapModel model;
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/part.so", folder);
  const long whole = copy_part(TETLAP_MODEL_0, LONG_MAX, path);
  open_model(&model, path);
  overlap_model_destroy(&model);
  const long sizes[] = {64, 1000, 5000, whole / 2};
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    copy_part(TETLAP_MODEL_0, sizes[k], path);
    expect_refused(path, STATUS_INPUT, "part.so: is cut off: it has");
  }
  copy_part(TETLAP_MODEL_0, 10, path);
  expect_refused(path, STATUS_INPUT, "part.so: cannot be loaded");
  copy_part(TETLAP_SOURCE_DIR "/README.md", 5000, path);
  expect_refused(path, STATUS_INPUT, "part.so: cannot be loaded");
  ck_assert(remove(path) == 0 && remove(folder) == 0);
}
END_TEST

START_TEST(a_library_that_ends_the_program_does_not_end_it_well) {
  static const char *const libraries[] = {TETLAP_MODEL_21, TETLAP_MODEL_23};
  static const char *const told[] = {TETLAP_MODEL_21 ": called exit()", TETLAP_MODEL_23 ": called _exit()"};
  for (int k = 0; k < 2; k++) {
    char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", words[1000];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(
        words, sizeof words,
        "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap %s -o %s",
        TETLAP_SOURCE_DIR, libraries[k], folder);
    ck_assert_int_eq(run_program(words, text), 70);
    char *first = strstr(text, told[k]);
    ck_assert_msg(first && !strstr(first + 1, told[k]), "%s", text);
    snprintf(words, sizeof words, "--version; rm -r %s", folder);
    run_program(words, text);
  }
}
END_TEST

START_TEST(what_is_written_beyond_an_array_ends_the_run) {
  OverlapModel model;
  open_model(&model, TETLAP_MODEL_11);
  for (int count = 1; count <= PAIRS; count += 7) {
    OverlapBatch batch = batch_of(count, count % 2, false);
    ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_SOLVER);
    ck_assert_msg(strstr(status_message(), "wrote beyond the end of `volume`, which has"), "%s",
                  status_message());
  }
  overlap_model_destroy(&model);
}
END_TEST

// `count` numbers that end where no memory is.
static double *against_a_guard(size_t count) {
  size_t page = (size_t)sysconf(_SC_PAGESIZE), bytes = count * sizeof(double);
  size_t size = (bytes + page - 1) / page * page;
  char *room = mmap(NULL, size + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ck_assert(room != MAP_FAILED && mprotect(room + size, page, PROT_NONE) == 0);
  return (double *)(room + size - bytes);
}

// Whether the process survives that the library answers `count` pairs.
static bool stays_within(const char *path, size_t count) {
  int how;
  pid_t child = fork();
  if (child > 0) {
    ck_assert_int_eq(waitpid(child, &how, 0), child);
    return WIFEXITED(how) && WEXITSTATUS(how) == 0;
  }
  const TetlapModel *(*find)(void);
  char message[100];
  signal(SIGSEGV, SIG_DFL); // no sanitizer's report
  *(void **)&find = dlsym(dlopen(path, RTLD_NOW), "tetlap_model");
  double *own = against_a_guard(24 * count);
  memcpy(own, pairs[0], 24 * count * sizeof *own);
  const uint32_t gives = find()->gives;
  TetlapModelBatch batch = {.size = sizeof batch,
                            .count = count,
                            .pairs = own,
                            .volume = against_a_guard(count),
                            .gradient = gives & TETLAP_MODEL_GRADIENT ? against_a_guard(24 * count) : NULL,
                            .centroid = gives & TETLAP_MODEL_CENTROID ? against_a_guard(3 * count) : NULL};
  _exit(find()->evaluate(NULL, &batch, message, sizeof message));
}

START_TEST(the_example_writes_what_it_is_asked_for_and_no_more) {
  for (size_t count = 1; count < 20; count++) ck_assert(stays_within(TETLAP_MODEL_SPLIT, count));
  ck_assert(stays_within(TETLAP_MODEL_0, 5));
  ck_assert(!stays_within(TETLAP_MODEL_11, 5)); // else this would show nothing
}
END_TEST

START_TEST(what_a_model_does_to_its_pairs_stays_with_it) {
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, true, false);
  double before[PAIRS][24], answers[PAIRS];
  memcpy(before, pairs, sizeof before);
  open_model(&model, TETLAP_MODEL_0);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  memcpy(answers, volume, sizeof answers);
  unsigned expected[PAIRS];
  memcpy(expected, flags, sizeof expected);
  overlap_model_destroy(&model);
  open_model(&model, TETLAP_MODEL_12);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_int_eq(memcmp(before, pairs, sizeof before), 0);
  ck_assert_int_eq(memcmp(answers, volume, sizeof answers), 0);
  ck_assert_int_eq(memcmp(expected, flags, sizeof expected), 0);
  overlap_model_destroy(&model);
}
END_TEST

// Of V = 1e-3 Σ x² and x̄ = the mean of the vertices; pairs that are disjoint have no derivatives.
START_TEST(a_pull_back_gives_the_gradient_the_hessian_and_that_of_the_centroid) {
  OverlapModel model;
  static double hessian[PAIRS][24][24], by_volume[PAIRS], by_centroid[PAIRS][3], slope[PAIRS][24];
  open_model(&model, TETLAP_MODEL_13);
  ck_assert(overlap_model_has_gradient(&model) && overlap_model_has_hessian(&model));
  OverlapBatch batch = batch_of(PAIRS, true, true);
  batch.hessian = hessian[0][0];
  ck_assert_ok(overlap_model_eval(&model, &batch));
  for (int i = 0; i < PAIRS; i++) {
    by_volume[i] = i;
    for (int c = 0; c < 3; c++) by_centroid[i][c] = c - 0.5 * i;
  }
  ck_assert_ok(model.ops->eval_pull(model.self, &(OverlapPull){.pair_count = PAIRS,
                                                               .pairs = pairs[0],
                                                               .by_volume = by_volume,
                                                               .by_centroid = by_centroid[0],
                                                               .by_gradient = pairs[0],
                                                               .slope = slope[0]}));
  int asked = 0;
  for (int i = 0; i < PAIRS; i++) {
    const double is_asked = !(flags[i] & OVERLAP_DISJOINT);
    asked += is_asked > 0;
    for (int v = 0; v < 24; v++) {
      const double x = pairs[i][v];
      ck_assert_near(gradient[i][v], is_asked * 2e-3 * x, 1e-18);
      for (int w = 0; w < 24; w++) ck_assert_near(hessian[i][v][w], is_asked * 2e-3 * (v == w), 1e-18);
      ck_assert_near(slope[i][v], is_asked * (2e-3 * x * (i + 1) + by_centroid[i][v % 3] / 8), 1e-12);
    }
  }
  ck_assert(asked > PAIRS / 10 && asked < PAIRS);
  overlap_model_destroy(&model);
  open_model(&model, TETLAP_MODEL_0);
  ck_assert(!model.ops->eval_pull && !overlap_model_has_hessian(&model));
  overlap_model_destroy(&model);
}
END_TEST

// The library is asked for those pairs alone that overlap; the last one's slope is none.
START_TEST(a_pull_back_that_is_no_number_is_told_with_its_pair) {
  OverlapModel model;
  static double slope[PAIRS][24], slopes[PAIRS][3][24];
  char says[64];
  OverlapBatch batch = batch_of(PAIRS, true, true);
  open_model(&model, TETLAP_MODEL_17);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  int last = PAIRS - 1, asked = 0;
  while (flags[last] & OVERLAP_DISJOINT) last--;
  for (int i = 0; i < PAIRS; i++) asked += !(flags[i] & OVERLAP_DISJOINT);
  ck_assert_int_lt(asked - 1, last);
  const OverlapPull pull = {.pair_count = PAIRS,
                            .pairs = pairs[0],
                            .by_volume = volume,
                            .by_centroid = centroid[0],
                            .slope = slope[0]};
  snprintf(says, sizeof says, "pair %d: its pull-back is not a finite number", last);
  ck_assert_int_eq(model.ops->eval_pull(model.self, &pull), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
  int numbers[PAIRS];
  for (int i = 0; i < PAIRS; i++) numbers[i] = 1000 + i;
  batch.numbers = numbers;
  snprintf(says, sizeof says, "pair %d: its pull-back is not a finite number", 1000 + last);
  ck_assert_int_eq(overlap_slopes_eval(&model, &batch, slopes[0][0]), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
  overlap_model_destroy(&model);
}
END_TEST

// The worst of what `stress --pairs` finds of derivatives.
static double stressed(const char *model) {
  char text[20000], words[1000], folder[] = "/tmp/tetlap-foreign-XXXXXX";
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "stress --pairs --quick --only uniform --overlap %s -j %s/it.json; cat %s/it.json; rm -r %s",
           model, folder, folder, folder);
  run_program(words, text);
  const char *name = strstr(text, "\"gradient\"");
  const char *at = name ? strstr(name, "\"value\":") : NULL;
  double worst;
  ck_assert_msg(at && sscanf(at, "\"value\": %lf", &worst) == 1, "%s", text); // null is no number
  return worst;
}

START_TEST(stress_holds_the_pull_back_of_centroids_to_differences) {
  ck_assert(stressed(TETLAP_MODEL_13) < 1e-7);
  ck_assert_near(stressed(TETLAP_MODEL_14), 1, 1e-6); // by as much is one coordinate wrong
}
END_TEST

START_TEST(a_library_is_told_where_a_scenes_pairs_are_from) {
  char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", words[1000];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap %s -o "
           "%s; rm -r %s",
           TETLAP_SOURCE_DIR, TETLAP_MODEL_15, folder, folder);
  run_program(words, text);
  const char *told = strstr(text, "told of ");
  ck_assert_msg(told && strstr(text, "trouble:     none"), "%s", text);
  ck_assert_int_gt(atoi(told + strlen("told of ")), 100);
}
END_TEST

// Elements of this scene are far smaller than those that the model is for, so clip has them all.
START_TEST(pairs_beyond_a_declared_range_are_counted_in_a_run) {
  char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", words[1000];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap "
           "hybrid=%s -q -o %s; cat %s/summary.json; rm -r %s",
           TETLAP_SOURCE_DIR, TETLAP_MODEL_19, folder, folder, folder);
  ck_assert_int_eq(run_program(words, text), 0);
  const char *name = strstr(text, "\"beyond_range_pairs\":");
  ck_assert_msg(name && strstr(text, "\"outcome\": \"finished\""), "%s", text);
  ck_assert_int_gt(atoi(strchr(name, ':') + 1), 10);
}
END_TEST

// Below 0 is no volume: nothing pushes. Above the smaller tetrahedron is no volume either, but a push.
START_TEST(volumes_that_none_can_have_are_flagged) {
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, true, false);
  open_model(&model, TETLAP_MODEL_8);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  int asked = 0;
  for (int i = 0; i < PAIRS; i++) {
    ck_assert(volume[i] == 0 && gradient[i][0] == 0);
    ck_assert((flags[i] == OVERLAP_UNSOUND) != (flags[i] == OVERLAP_DISJOINT));
    asked += flags[i] == OVERLAP_UNSOUND;
  }
  ck_assert_int_gt(asked, PAIRS / 10);
  overlap_model_destroy(&model);
  open_model(&model, TETLAP_MODEL_9);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  for (int i = 0; i < PAIRS; i++) {
    const bool is_told = flags[i] == OVERLAP_UNSOUND;
    ck_assert(is_told ? volume[i] == 100 && gradient[i][23] == 1 : volume[i] == 0);
    asked -= is_told;
  }
  ck_assert_int_eq(asked, 0); // the same pairs
  overlap_model_destroy(&model);
}
END_TEST

// Wherever it stands among many; numbers whose sum alone is not finite are none of them.
START_TEST(a_coordinate_that_is_not_finite_is_named) {
  static const int places[] = {0, 63, 64, 130, PAIRS - 1};
  static const double values[] = {NAN, INFINITY, -INFINITY};
  const int place = places[_i / 3];
  char says[80];
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, false, false);
  snprintf(says, sizeof says, "pair %d, tetrahedron 1, vertex 2: coordinate y is %g", place, values[_i % 3]);
  open_model(&model, "keep=" TETLAP_MODEL_0);
  for (int v = 0; v < 24; v += 8) pairs[70][v] = 1.5e308; // they overflow as a sum
  ck_assert_ok(overlap_model_eval(&model, &batch));
  pairs[place][19] = values[_i % 3];
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
  overlap_model_destroy(&model);
}
END_TEST

// Of a model whose V is not finite, below 0, above the smaller tetrahedron.
START_TEST(such_volumes_end_a_run_or_are_counted_as_asked) {
  static const char *const strict[] = {"strict=" TETLAP_MODEL_7, "strict=" TETLAP_MODEL_8,
                                       "strict=both=" TETLAP_MODEL_9};
  static const char *const lenient[] = {"lenient=" TETLAP_MODEL_7, "lenient=" TETLAP_MODEL_8,
                                        "both=lenient=" TETLAP_MODEL_9};
  static const char *const says[] = {"its volume is not a finite number",
                                     "its volume is -1 m³, expected 0 to",
                                     "its volume is 100 m³, expected 0 to"};
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, true, false);
  int asked = 0;
  expect_failure(strict[_i], STATUS_SOLVER, says[_i]);
  open_model(&model, lenient[_i]);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  for (int i = 0; i < PAIRS; i++) {
    const bool is_counted = (flags[i] & OVERLAP_UNSOUND) != 0;
    asked += is_counted;
    ck_assert(is_counted != ((flags[i] & OVERLAP_DISJOINT) != 0));
    ck_assert(volume[i] == (_i == 2 && is_counted ? 100 : 0) && gradient[i][0] == volume[i] / 100);
  }
  ck_assert_int_gt(asked, PAIRS / 10);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(a_run_of_such_volumes_has_trouble) {
  char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", words[1000];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap %s -o "
           "%s; rm -r %s",
           TETLAP_SOURCE_DIR, TETLAP_MODEL_8, folder, folder);
  run_program(words, text);
  const char *trouble = strstr(text, "trouble:");
  ck_assert_msg(trouble && strstr(trouble, "strict="), "%s", text);
}
END_TEST

START_TEST(a_run_that_fails_by_such_volumes_says_so) {
  char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", words[1000];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(
      words, sizeof words,
      "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap lenient=%s "
      "-o %s",
      TETLAP_SOURCE_DIR, TETLAP_MODEL_9, folder);
  ck_assert_int_eq(run_program(words, text), 70);
  ck_assert_msg(strstr(text, "no two such tetrahedra share: mend the model"), "%s", text);
  snprintf(words, sizeof words, "--version; rm -r %s", folder);
  run_program(words, text);
}
END_TEST

// A model that is right is left alone, to the bit.
START_TEST(what_comes_out_is_looked_at_of_any_model) {
  static double own[PAIRS][24], slopes[2][PAIRS][72];
  OverlapModel models[2];
  OverlapBatch batch = batch_of(PAIRS, true, true);
  int too_large = 0;
  open_model(&models[0], "geo"), open_model(&models[1], _i ? "lenient=geo" : "strict=geo");
  for (int k = 0; k < 2; k++) {
    ck_assert_ok(overlap_slopes_eval(&models[k], &batch, slopes[k][0]));
    if (k == 0) memcpy(own, gradient, sizeof own);
    overlap_model_destroy(&models[k]);
  }
  ck_assert_int_eq(memcmp(own, gradient, sizeof own), 0);
  ck_assert_int_eq(memcmp(slopes[0], slopes[1], sizeof slopes[0]), 0);
  open_model(&models[0], _i ? "lenient=tpn-published" : "strict=tpn-published");
  if (_i == 0) {
    ck_assert_int_eq(overlap_model_eval(&models[0], &batch), STATUS_SOLVER);
    ck_assert_ptr_nonnull(strstr(status_message(), "expected 0 to that of the smaller tetrahedron"));
  } else {
    ck_assert_ok(overlap_model_eval(&models[0], &batch));
    for (int i = 0; i < PAIRS; i++) too_large += (flags[i] & OVERLAP_UNSOUND) != 0;
    ck_assert_int_gt(too_large, 0);
  }
  overlap_model_destroy(&models[0]);
}
END_TEST

// The pair at which the model failed stands in a file that `tetlap overlap` reads; the next run removes it.
// Also where bodies overlap before anything has moved.
START_TEST(the_pair_that_ends_a_run_is_written_to_its_folder) {
  char text[20000], words[1000], folder[] = "/tmp/tetlap-foreign-XXXXXX", path[100];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/unsound_pair.csv", folder);
  snprintf(
      words, sizeof words,
      "run %s/examples/02_two_blocks.yaml --set time.end=0.1 --set output.vtu=false --overlap %s -o %s%s",
      TETLAP_SOURCE_DIR, TETLAP_MODEL_7, folder,
      _i ? " --set 'bodies.upper.place.translate=[-0.04, -0.08, 0.19]'" : "");
  ck_assert_int_eq(run_program(words, text), 70);
  ck_assert_msg(strstr(text, "its volume is not a finite number. Its coordinates are in"), "%s", text);
  snprintf(words, sizeof words, "overlap -q -j %s", path);
  ck_assert_int_eq(run_program(words, text), 0);
  const char *told = strstr(text, "\"volume\":");
  ck_assert_msg(told && strtod(told + strlen("\"volume\":"), NULL) > 0, "%s", text); // they do overlap
  snprintf(words, sizeof words,
           "run %s/examples/02_two_blocks.yaml --set time.end=0.001 --set output.vtu=false -q -o %s",
           TETLAP_SOURCE_DIR, folder);
  ck_assert_int_eq(run_program(words, text), 0);
  ck_assert_int_ne(access(path, F_OK), 0);
  snprintf(words, sizeof words, "--version; rm -r %s", folder);
  run_program(words, text);
}
END_TEST

START_TEST(flat_and_disjoint_pairs_are_not_asked_for_unless_ghosts_are_kept) {
  OverlapModel model;
  OverlapBatch batch = batch_of(3, false, false);
  for (int v = 12; v < 24; v++) pairs[0][v] += 10;
  memcpy(pairs[1] + 12, pairs[1] + 15, 3 * sizeof(double)); // two vertices in one place
  open_model(&model, TETLAP_MODEL_0);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert(flags[0] == OVERLAP_DISJOINT && volume[0] == 0);
  ck_assert(flags[1] == OVERLAP_FLAT && volume[1] == 0);
  overlap_model_destroy(&model);
  open_model(&model, "keep=" TETLAP_MODEL_0);
  ck_assert(overlap_model_has_ghosts(&model));
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert(!(flags[0] & OVERLAP_DISJOINT) && volume[0] == 1e-3);
  ck_assert(flags[1] == OVERLAP_FLAT && volume[1] == 0);
  overlap_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("libraries of users");
  draw();
  tcase_add_test(cases, a_library_answers_as_clip);
  tcase_add_test(cases, libraries_that_are_wrong);
  tcase_add_test(cases, a_library_that_is_cut_off_is_refused);
  tcase_add_test(cases, a_library_that_ends_the_program_does_not_end_it_well);
  tcase_add_test(cases, what_is_written_beyond_an_array_ends_the_run);
  tcase_add_test(cases, the_example_writes_what_it_is_asked_for_and_no_more);
  tcase_add_test(cases, what_a_model_does_to_its_pairs_stays_with_it);
  tcase_add_test(cases, a_pull_back_gives_the_gradient_the_hessian_and_that_of_the_centroid);
  tcase_add_test(cases, a_pull_back_that_is_no_number_is_told_with_its_pair);
  tcase_add_test(cases, stress_holds_the_pull_back_of_centroids_to_differences);
  tcase_add_test(cases, a_library_is_told_where_a_scenes_pairs_are_from);
  tcase_add_test(cases, pairs_beyond_a_declared_range_are_counted_in_a_run);
  tcase_add_test(cases, volumes_that_none_can_have_are_flagged);
  tcase_add_loop_test(cases, a_coordinate_that_is_not_finite_is_named, 0, 15);
  tcase_add_loop_test(cases, such_volumes_end_a_run_or_are_counted_as_asked, 0, 3);
  tcase_add_test(cases, a_run_of_such_volumes_has_trouble);
  tcase_add_test(cases, a_run_that_fails_by_such_volumes_says_so);
  tcase_add_loop_test(cases, what_comes_out_is_looked_at_of_any_model, 0, 2);
  tcase_add_loop_test(cases, the_pair_that_ends_a_run_is_written_to_its_folder, 0, 2);
  tcase_add_test(cases, flat_and_disjoint_pairs_are_not_asked_for_unless_ghosts_are_kept);
  return suite_run("libraries of users", cases, 60);
}
