// SPDX-License-Identifier: GPL-3.0-or-later
// Models of users (overlap/foreign): libraries, Python files, commands. The oracles are `clip` and what the
// models of tests/overlap/foreign say.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // memfd_create
#endif
#include "suite.h"

#include <dirent.h>
#include <dlfcn.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <tetlap/model.h>
#include <unistd.h>

#include "base/machine/interrupt.h"
#include "base/random.h"
#include "overlap/models.h"
#include "overlap/slopes.h"
#include "overlap/source.h"

enum { PAIRS = 300 };

static double pairs[PAIRS][24], volume[PAIRS], gradient[PAIRS][24], centroid[PAIRS][3];
static unsigned flags[PAIRS];

static void draw(void) {
  Random random = random_seeded(11, 0);
  for (int i = 0; i < PAIRS; i++)
    for (int v = 0; v < 24; v++)
      pairs[i][v] = random_uniform(&random) + (i % 3 == 2 && v >= 12 && v % 3 == 0);
}

static OverlapBatch batch_of(int count, bool with_gradient, bool with_centroid) {
  return (OverlapBatch){.pair_count = count,
                        .pairs = pairs[0],
                        .volume = volume,
                        .gradient = with_gradient ? gradient[0] : NULL,
                        .centroid = with_centroid ? centroid[0] : NULL,
                        .flags = flags};
}

static void open_model(OverlapModel *model, const char *word) {
  ck_assert_ok(overlap_models_create(model, word));
}

static void expect_refused(const char *word, Status status, const char *says) {
  OverlapModel model;
  ck_assert_int_eq(overlap_models_create(&model, word), status);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
}

static void expect_failure(const char *word, Status status, const char *says) {
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, false, true);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), status);
  ck_assert_msg(strstr(status_message(), says), "%s", status_message());
  overlap_model_destroy(&model);
}

#define PYTHON(name) TETLAP_SOURCE_DIR "/tests/overlap/foreign/models.py:" name

START_TEST(a_word_says_what_it_is) {
  static const struct {
    const char *word;
    OverlapSource source;
    const char *path;
  } cases[] = {{"clip", OVERLAP_SOURCE_NAME, ""},
               {"hybrid=a/b.safetensors", OVERLAP_SOURCE_WEIGHTS, "a/b.safetensors"},
               {"hybrid=geo", OVERLAP_SOURCE_NAME, ""},
               {"fade:.05=both=a/b.so", OVERLAP_SOURCE_LIBRARY, "a/b.so"},
               {"both=exec:x=y z", OVERLAP_SOURCE_COMMAND, ""},
               {"exec:env a=b.so", OVERLAP_SOURCE_COMMAND, ""},
               {"./both=b.so", OVERLAP_SOURCE_LIBRARY, "./both=b.so"},
               {"a.safetensors", OVERLAP_SOURCE_WEIGHTS, "a.safetensors"},
               {"./a.so", OVERLAP_SOURCE_LIBRARY, "./a.so"},
               {".so", OVERLAP_SOURCE_WEIGHTS, ".so"},
               {"./net.pt", OVERLAP_SOURCE_WEIGHTS, "./net.pt"},
               {"a/b.py", OVERLAP_SOURCE_PYTHON, "a/b.py"},
               {"a/b.py:f", OVERLAP_SOURCE_PYTHON, "a/b.py"},
               {"a:b/c.py", OVERLAP_SOURCE_PYTHON, "a:b/c.py"},
               {"exec:./x.py", OVERLAP_SOURCE_COMMAND, ""},
               {"channel:3:4:f", OVERLAP_SOURCE_CHANNEL, ""}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const char *path;
    char text[64];
    size_t length = overlap_source_path(cases[i].word, &path);
    ck_assert_int_eq(overlap_source_of(cases[i].word), cases[i].source);
    ck_assert_uint_eq(length, strlen(cases[i].path));
    ck_assert_int_eq(strncmp(path, cases[i].path, length), 0);
    ck_assert(overlap_source_from(cases[i].word, "/f", text, sizeof text));
    ck_assert(length > 0 ? strstr(text, "/f/") != NULL : strcmp(text, cases[i].word) == 0);
  }
  char text[64];
  ck_assert(overlap_source_from("hybrid=a.safetensors", "/f", text, sizeof text));
  ck_assert_str_eq(text, "hybrid=/f/a.safetensors");
  ck_assert(overlap_source_from("/a.py:f", "/f", text, sizeof text));
  ck_assert_str_eq(text, "/a.py:f");
  ck_assert(overlap_source_from("both=a.py:f", "e=1", text, sizeof text));
  ck_assert_str_eq(text, "both=./e=1/a.py:f");
  ck_assert(!overlap_source_from("a.py:f", "/a/folder", text, 8));
}
END_TEST

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

// What a command prints; its exit code.
static int run_program(const char *words, char text[20000]) {
  char command[2000];
  snprintf(command, sizeof command, "{ %s %s; } 2>&1", TETLAP_PROGRAM, words);
  FILE *stream = popen(command, "r");
  ck_assert_ptr_nonnull(stream);
  text[fread(text, 1, 19999, stream)] = 0;
  int how = pclose(stream);
  return WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

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
  for (int i = 0; i < PAIRS; i++)
    ck_assert(flags[i] == OVERLAP_UNSOUND ? volume[i] == 100 && gradient[i][23] == 1 : volume[i] == 0);
  overlap_model_destroy(&model);
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

static bool has_numpy(void) {
  bool has = system(TETLAP_PYTHON " -c 'import numpy' 2>/dev/null") == 0;
  if (!has) suite_skip("%s has no NumPy", TETLAP_PYTHON);
  return has;
}

// V is `share` of what the bounding boxes have in common, x̄ its middle. Returns how many pairs have a V.
static int check_boxes(int count, double x[][24], const double *v, double middles[][3], double share) {
  int found = 0;
  for (int i = 0; i < count; i++) {
    double product = share;
    if (v[i] == 0) continue;
    found++;
    for (int c = 0; c < 3; c++) {
      double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
      for (int k = 0; k < 8; k++) {
        low[k / 4] = fmin(low[k / 4], x[i][3 * k + c]);
        high[k / 4] = fmax(high[k / 4], x[i][3 * k + c]);
      }
      double from = fmax(low[0], low[1]), to = fmin(high[0], high[1]);
      product *= to - from;
      ck_assert_double_eq(middles[i][c], (from + to) / 2);
    }
    ck_assert_near(v[i], product, 1e-15);
  }
  return found;
}

START_TEST(a_python_function_answers_with_all_that_it_has) {
  OverlapModel model;
  if (!has_numpy()) return;
  open_model(&model, PYTHON("box"));
  ck_assert(overlap_model_has_own_centroid(&model) && !overlap_model_has_gradient(&model));
  OverlapBatch batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_int_gt(check_boxes(PAIRS, pairs, volume, centroid, 1), PAIRS / 10);
  overlap_model_destroy(&model);
  static double logits[PAIRS], bounds[PAIRS];
  open_model(&model, PYTHON("with_all"));
  batch = batch_of(2, true, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_ok(model.ops->eval_logits(model.self, PAIRS, pairs[0], logits));
  ck_assert_ok(model.ops->eval_bounds(model.self, PAIRS, pairs[0], volume, bounds));
  ck_assert(logits[0] == -1.5 && logits[PAIRS - 1] == PAIRS - 2.5 && bounds[7] == 0.25);
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("Made")); // a class is called first
  overlap_model_destroy(&model);
}
END_TEST

// The example of a command has a sixth of what the Python function above has.
// A force needs a place: that of clip, where the model has none.
START_TEST(a_model_of_v_alone_runs_where_its_volumes_are_placed) {
  static const char *const words[] = {PYTHON("alone"), "placed=" PYTHON("alone")};
  if (!has_numpy()) return;
  for (int k = 0; k < 2; k++) {
    char text[20000], folder[] = "/tmp/tetlap-foreign-XXXXXX", command[1500];
    ck_assert_ptr_nonnull(mkdtemp(folder));
    snprintf(command, sizeof command,
             "run %s/examples/02_two_blocks.yaml --set time.end=0.02 --set output.vtu=false --overlap %s -o "
             "%s",
             TETLAP_SOURCE_DIR, words[k], folder);
    const int code = run_program(command, text);
    ck_assert_msg(code == (k == 0 ? 65 : 0), "%s", text);
    ck_assert_msg(strstr(text, k == 0 ? "gives V alone" : "overlap model placed=models:alone"), "%s", text);
    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
  }
}
END_TEST

START_TEST(a_command_answers_as_a_function_does) {
  enum { MANY = 3000 }; // more than the memory has room for at first
  OverlapModel model;
  static double x[MANY][24], v[MANY], middles[MANY][3];
  for (int i = 0; i < MANY; i++) memcpy(x[i], pairs[i % PAIRS], sizeof *x);
  open_model(&model, "exec:" TETLAP_MODEL_SERVE);
  for (int count = 10; count <= MANY; count *= 300) {
    OverlapBatch batch = {.pair_count = count, .pairs = x[0], .volume = v, .centroid = middles[0]};
    ck_assert_ok(overlap_model_eval(&model, &batch));
    ck_assert_int_gt(check_boxes(count, x, v, middles, 1.0 / 6), count / 10);
  }
  overlap_model_destroy(&model);
}
END_TEST

// More pairs than the memory that is shared at first has room for.
START_TEST(the_shared_memory_grows) {
  enum { MANY = 5000 };
  OverlapModel model;
  if (!has_numpy()) return;
  double(*x)[24] = calloc(MANY, sizeof *x), *v = calloc(MANY, sizeof *v);
  ck_assert(x && v);
  open_model(&model, PYTHON("box"));
  for (int i = 0; i < MANY; i++) memcpy(x[i], pairs[i % PAIRS], sizeof *x);
  for (int count = 1; count <= MANY; count = count * 9 + 1) {
    OverlapBatch batch = {.pair_count = count, .pairs = x[0], .volume = v};
    ck_assert_ok(overlap_model_eval(&model, &batch));
    for (int i = PAIRS; i < count; i++) ck_assert_double_eq(v[i], v[i % PAIRS]);
  }
  overlap_model_destroy(&model);
  free(x), free(v);
}
END_TEST

START_TEST(python_that_is_wrong) {
  if (!has_numpy()) return;
  setenv("TETLAP_MODEL_SECONDS", "20", 1);
  expect_refused(PYTHON("nothing"), STATUS_INPUT, "has no 'nothing'; it has box");
  expect_refused(PYTHON("NUMBER"), STATUS_INPUT, "NUMBER is int, expected a callable");
  expect_refused(PYTHON("wrong_shape"), STATUS_INPUT, "volume of shape (1, 1), expected (1,)");
  expect_refused(PYTHON("wrong_key"), STATUS_INPUT, "'volumes', which is none of volume");
  expect_refused(PYTHON("no_numbers"), STATUS_INPUT, "no array of numbers");
  expect_refused(TETLAP_SOURCE_DIR "/tests/overlap/foreign/torn.py", STATUS_INPUT, "SyntaxError");
  expect_refused("none.py:f", STATUS_INPUT, "there is no such file");
  expect_failure(PYTHON("raises"), STATUS_SOLVER, "ValueError: no more than one");
  expect_refused(PYTHON("no_volume"), STATUS_INPUT, "no_volume returned no volume");
  expect_failure(PYTHON("changes_its_mind"), STATUS_SOLVER, "returned no centroid this time");
  expect_failure(PYTHON("dies"), STATUS_DEVICE, "ended by signal 9");
  expect_failure(PYTHON("leaves"), STATUS_SOLVER, "SystemExit");
  expect_failure(PYTHON("shrinks"), STATUS_SOLVER, "Operation not permitted");
  OverlapModel model;
  OverlapBatch batch = batch_of(PAIRS, false, true);
  open_model(&model, PYTHON("alone"));
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "gives V alone"), "%s", status_message());
  overlap_model_destroy(&model);
}
END_TEST

// The model of this is the test: it answers before it is asked.
START_TEST(a_reply_that_comes_too_late_answers_no_other_request) {
  static const uint64_t done[4] = {0};
  OverlapModel model;
  char word[64];
  int ends[2], memory = memfd_create("memory", 0);
  OverlapBatch batch = batch_of(PAIRS, false, false);
  ck_assert(memory >= 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  snprintf(word, sizeof word, "channel:%d:%d:late", ends[0], memory);
  setenv("TETLAP_MODEL_SECONDS", "0.2", 1);
  ck_assert_int_eq(send(ends[1], done, sizeof done, 0), sizeof done);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_DEVICE);
  ck_assert_msg(strstr(status_message(), "late: the model has not answered within 0.2 s. "), "%s",
                status_message());
  send(ends[1], done, sizeof done, MSG_NOSIGNAL);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_DEVICE);
  overlap_model_destroy(&model);
  close(ends[0]), close(ends[1]), close(memory);
}
END_TEST

// What it leaves unwritten is what the memory held before: no answer.
START_TEST(a_model_that_writes_nothing_has_not_answered) {
  static const uint64_t done[4] = {0, 0, TETLAP_MODEL_LOGIT, 0};
  static double logits[PAIRS];
  OverlapModel model;
  char word[64];
  int ends[2], memory = memfd_create("memory", 0);
  OverlapBatch batch = batch_of(PAIRS, false, false);
  ck_assert(memory >= 0 && socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0);
  snprintf(word, sizeof word, "channel:%d:%d:silent", ends[0], memory);
  for (int i = 0; i < 3; i++) ck_assert_int_eq(send(ends[1], done, sizeof done, 0), sizeof done);
  open_model(&model, word);
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "its volume is not a finite number"), "%s", status_message());
  ck_assert_int_eq(model.ops->eval_logits(model.self, PAIRS, pairs[0], logits), STATUS_SOLVER);
  ck_assert_msg(strstr(status_message(), "its logit"), "%s", status_message());
  overlap_model_destroy(&model);
  close(ends[0]), close(ends[1]), close(memory);
  expect_failure(TETLAP_MODEL_10, STATUS_SOLVER, "its volume is not a finite number");
}
END_TEST

START_TEST(a_model_gets_no_file_of_the_program) {
  OverlapModel model;
  if (!has_numpy()) return;
  ck_assert_int_eq(dup2(2, 77), 77);
  open_model(&model, PYTHON("has_no_77")); // which fails where it has
  overlap_model_destroy(&model);
  close(77);
}
END_TEST

// How many processes this one has started, and not yet ended.
static int count_children(void) {
  int count = 0;
  DIR *processes = opendir("/proc");
  ck_assert_ptr_nonnull(processes);
  for (struct dirent *entry; (entry = readdir(processes));) {
    char path[300];
    int parent = 0;
    snprintf(path, sizeof path, "/proc/%.64s/stat", entry->d_name);
    FILE *stream = fopen(path, "r");
    if (!stream) continue;
    if (fscanf(stream, "%*d (%*[^)]) %*c %d", &parent) == 1) count += parent == getpid();
    fclose(stream);
  }
  closedir(processes);
  return count;
}

START_TEST(commands_that_are_wrong_leave_no_process) {
  expect_refused("exec:no-such-command-anywhere", STATUS_INPUT, "the command was not found");
  expect_refused("exec:false", STATUS_DEVICE, "ended with exit code 1");
  setenv("TETLAP_MODEL_SECONDS", "0.3", 1);
  expect_refused("exec:sleep 1000", STATUS_DEVICE, "has not answered within 0.3 s");
  if (has_numpy()) {
    setenv("TETLAP_MODEL_SECONDS", "20", 1);
    OverlapModel model;
    open_model(&model, PYTHON("hangs"));
    ck_assert_int_eq(count_children(), 1);
    overlap_model_destroy(&model);
  }
  setenv("TETLAP_MODEL_SECONDS", "5 min", 1);
  expect_refused("exec:true", STATUS_USAGE, "must be a number of seconds");
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// A process that has not ended; a zombie has.
static bool is_alive(pid_t pid) {
  char path[64], state = 'X';
  snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
  FILE *stream = fopen(path, "r");
  if (!stream) return false;
  if (fscanf(stream, "%*d (%*[^)]) %c", &state) != 1) state = 'X';
  fclose(stream);
  return state != 'Z' && state != 'X';
}

START_TEST(what_a_model_has_started_ends_with_it) {
  if (!has_numpy()) return;
  setenv("TETLAP_MODEL_SECONDS", "100", 1);
  OverlapModel model;
  OverlapBatch batch = batch_of(1, false, false);
  memcpy(pairs[0] + 12, pairs[0], 12 * sizeof pairs[0][0]);
  open_model(&model, PYTHON("starts_another"));
  ck_assert_ok(overlap_model_eval(&model, &batch));
  const pid_t other = (pid_t)volume[0];
  ck_assert(is_alive(other));
  overlap_model_destroy(&model);
  for (int k = 0; k < 200 && is_alive(other); k++) usleep(10000); // SIGKILL is under way
  ck_assert(!is_alive(other));
  expect_failure(PYTHON("dies_and_leaves_another"), STATUS_DEVICE, "ended by signal 9");
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// Else two would answer one request, and the second answer be taken for the next one's.
START_TEST(a_model_that_forks_answers_once) {
  if (!has_numpy()) return;
  OverlapModel model;
  double answers[PAIRS];
  open_model(&model, PYTHON("box"));
  OverlapBatch batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  memcpy(answers, volume, sizeof answers);
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("forks"));
  for (int k = 0; k < 5; k++) {
    batch = batch_of(PAIRS - 10 * k, false, true);
    ck_assert_ok(overlap_model_eval(&model, &batch));
    ck_assert_int_eq(memcmp(answers, volume, (size_t)batch.pair_count * sizeof *answers), 0);
  }
  overlap_model_destroy(&model);
  open_model(&model, PYTHON("spoils")); // nor does what it writes over its input matter
  batch = batch_of(PAIRS, false, true);
  ck_assert_ok(overlap_model_eval(&model, &batch));
  ck_assert_int_eq(memcmp(answers, volume, sizeof answers), 0);
  overlap_model_destroy(&model);
}
END_TEST

START_TEST(what_a_model_prints_is_no_output_of_the_program) {
  if (!has_numpy()) return;
  OverlapModel model;
  char text[1000] = "";
  OverlapBatch batch = batch_of(PAIRS, false, true);
  FILE *out = tmpfile(), *err = tmpfile();
  ck_assert(out && err);
  fflush(NULL);
  const int stdout_before = dup(1), stderr_before = dup(2);
  dup2(fileno(out), 1), dup2(fileno(err), 2);
  open_model(&model, PYTHON("prints"));
  Status status = overlap_model_eval(&model, &batch);
  overlap_model_destroy(&model);
  dup2(stdout_before, 1), dup2(stderr_before, 2);
  close(stdout_before), close(stderr_before);
  ck_assert_int_eq(status, STATUS_OK);
  ck_assert_int_eq(lseek(fileno(out), 0, SEEK_END), 0);
  rewind(err);
  text[fread(text, 1, sizeof text - 1, err)] = 0;
  ck_assert_msg(strstr(text, "one 1\none "), "%s", text);
  fclose(out), fclose(err);
}
END_TEST

START_TEST(a_python_that_lacks_something_says_what_to_do) {
  setenv("TETLAP_PYTHON", "/no/such/python", 1);
  expect_refused(PYTHON("box"), STATUS_INPUT, "there is no Python to run it: set TETLAP_PYTHON");
  setenv("TETLAP_PYTHON", TETLAP_SOURCE_DIR "/tests/overlap/foreign/bare_python", 1);
  expect_refused(PYTHON("box"), STATUS_INPUT, "set TETLAP_PYTHON to a Python that has it");
  ck_assert_msg(strstr(status_message(), "has no NumPy"), "%s", status_message());
  setenv("TETLAP_PYTHON", TETLAP_PYTHON, 1);
  if (!has_numpy()) return;
  expect_refused(TETLAP_SOURCE_DIR "/tests/overlap/foreign/unmet.py", STATUS_INPUT,
                 "No module named 'a_module_that_nobody_has' in /");
  ck_assert_msg(strstr(status_message(), "set TETLAP_PYTHON to a Python that has it"), "%s",
                status_message());
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

// A wish to end that came before the request, or between it and the wait for its answer, which no signal
// interrupts any more.
START_TEST(a_wish_to_end_is_seen_while_a_model_computes) {
  if (!has_numpy()) return;
  OverlapModel model;
  setenv("TETLAP_MODEL_SECONDS", "300", 1);
  open_model(&model, PYTHON("hangs"));
  *interrupt_flag() = 1;
  double v[PAIRS];
  OverlapBatch batch = {.pair_count = PAIRS, .pairs = pairs[0], .volume = v};
  ck_assert_int_eq(overlap_model_eval(&model, &batch), STATUS_INTERRUPTED);
  overlap_model_destroy(&model);
  ck_assert_int_eq(count_children(), 0);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("models of users");
  draw();
  setenv("TETLAP_PYTHON", TETLAP_PYTHON, 1);
  tcase_add_test(cases, a_word_says_what_it_is);
  tcase_add_test(cases, a_library_answers_as_clip);
  tcase_add_test(cases, libraries_that_are_wrong);
  tcase_add_test(cases, what_is_written_beyond_an_array_ends_the_run);
  tcase_add_test(cases, the_example_writes_what_it_is_asked_for_and_no_more);
  tcase_add_test(cases, what_a_model_does_to_its_pairs_stays_with_it);
  tcase_add_test(cases, a_pull_back_gives_the_gradient_the_hessian_and_that_of_the_centroid);
  tcase_add_test(cases, a_pull_back_that_is_no_number_is_told_with_its_pair);
  tcase_add_test(cases, stress_holds_the_pull_back_of_centroids_to_differences);
  tcase_add_test(cases, a_library_is_told_where_a_scenes_pairs_are_from);
  tcase_add_test(cases, volumes_that_none_can_have_are_flagged);
  tcase_add_test(cases, flat_and_disjoint_pairs_are_not_asked_for_unless_ghosts_are_kept);
  tcase_add_test(cases, a_python_function_answers_with_all_that_it_has);
  tcase_add_test(cases, a_model_of_v_alone_runs_where_its_volumes_are_placed);
  tcase_add_test(cases, a_command_answers_as_a_function_does);
  tcase_add_test(cases, the_shared_memory_grows);
  tcase_add_test(cases, python_that_is_wrong);
  tcase_add_test(cases, a_reply_that_comes_too_late_answers_no_other_request);
  tcase_add_test(cases, a_model_that_writes_nothing_has_not_answered);
  tcase_add_test(cases, a_model_gets_no_file_of_the_program);
  tcase_add_test(cases, commands_that_are_wrong_leave_no_process);
  tcase_add_test(cases, what_a_model_has_started_ends_with_it);
  tcase_add_test(cases, a_model_that_forks_answers_once);
  tcase_add_test(cases, what_a_model_prints_is_no_output_of_the_program);
  tcase_add_test(cases, a_python_that_lacks_something_says_what_to_do);
  tcase_add_test(cases, a_wish_to_end_is_seen_while_a_model_computes);
  return suite_run("foreign", cases, 60);
}
