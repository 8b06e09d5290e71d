// SPDX-License-Identifier: GPL-3.0-or-later
// The benches: the sets of pairs that they use, their timer, and the rows that scripts read.
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "app/bench/overlap/pairs.h"
#include "app/bench/peak.h"
#include "app/bench/scene/builtin.h"
#include "app/bench/scene/scaling.h"
#include "app/bench/timer.h"
#include "app/bench/trial.h"
#include "app/evaluation/card.h"
#include "base/memory.h"
#include "base/text.h"
#include "fem/model/build.h"

enum { COUNT = 50, OUTPUT_SIZE = 1 << 16 };

START_TEST(the_same_seed_gives_the_same_pairs) {
  static double first[COUNT * 24], again[COUNT * 24], other[COUNT * 24];
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 3, first));
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 3, again));
  ck_assert_ok(app_bench_pairs_make(app_bench_sets[_i], COUNT, 4, other));
  ck_assert_mem_eq(first, again, sizeof first);
  ck_assert_mem_ne(first, other, sizeof first);
}
END_TEST

START_TEST(an_unknown_set_is_an_error_that_names_the_known_ones) {
  double pair[24];
  ck_assert_int_eq(app_bench_pairs_make("nearly", 1, 1, pair), STATUS_USAGE);
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++)
    ck_assert_ptr_nonnull(strstr(status_message(), app_bench_sets[set]));
}
END_TEST

START_TEST(the_median_of_rounds_counts) {
  static AppBenchTimer timer = {.wall = {5, 1, 4, 2}, .cpu = {8, 8, 3, 3}};
  AppBenchTime odd = app_bench_timer_time(&timer, 3), even = app_bench_timer_time(&timer, 4);
  ck_assert_double_eq(odd.wall, 4);
  ck_assert_double_eq(odd.cpu, 8);
  ck_assert_double_eq(even.wall, 3);
  ck_assert_double_eq(even.cpu, 5.5);
  ck_assert_double_eq(even.wall_min, 1);
  ck_assert_double_eq(even.wall_max, 5);
  ck_assert_int_eq(app_bench_timer_median_round(&timer, 3), 2);
  ck_assert_int_eq(app_bench_timer_median_round(&timer, 4), 3); // 2, the lower of 2 and 4
}
END_TEST

START_TEST(ratios_are_taken_within_a_round) {
  // the machine slowed down threefold in the third round, for both
  static AppBenchTimer timer = {.wall = {1, 2, 3, 1}, .cpu = {1, 1, 1, 1}},
                       reference = {.wall = {2, 2, 6, 3}, .cpu = {4, 4, 5, 5}};
  AppBenchRatio ratio = app_bench_timer_ratio(&timer, &reference, 4);
  ck_assert_double_eq(ratio.median, 2);
  ck_assert_double_eq(ratio.min, 1);
  ck_assert_double_eq(ratio.max, 3);
  ck_assert_double_eq(app_bench_timer_cpu_ratio(&timer, &reference, 4).median, 4.5);
}
END_TEST

START_TEST(more_pairs_than_are_made_repeat_the_first) {
  enum { MANY = APP_BENCH_DIFFERENT_PAIRS + 10 };
  double *pairs = memory_zeroed((size_t)MANY * 24, sizeof *pairs), few[COUNT * 24];
  ck_assert_ok(app_bench_pairs_fill("uniform", MANY, 3, pairs));
  ck_assert_ok(app_bench_pairs_make("uniform", COUNT, 3, few));
  ck_assert_mem_eq(pairs, few, sizeof few);
  ck_assert_mem_eq(pairs + (size_t)APP_BENCH_DIFFERENT_PAIRS * 24, pairs, 10 * 24 * sizeof *pairs);
  memory_free(pairs);
}
END_TEST

START_TEST(the_peak_is_a_number) {
  double single = app_bench_peak_measure(true), twice = app_bench_peak_measure(false);
  ck_assert_double_gt(twice, 0);
  ck_assert_double_gt(single, 0);
  ck_assert(isfinite(single) && isfinite(twice));
}
END_TEST

START_TEST(a_power_law_gives_its_exponent) {
  const double sizes[] = {10, 100, 1000, 1e4}, seconds[] = {3e-3, 3e-1, NAN, 3e3}, once[] = {1, 0, 0, 0};
  ck_assert_near(app_bench_scaling_exponent(sizes, seconds, 4), 2, 1e-12);
  ck_assert(isnan(app_bench_scaling_exponent(sizes, once, 4)));
  ck_assert(isnan(app_bench_scaling_exponent(sizes, seconds, 0)));
}
END_TEST

START_TEST(scenes_for_large_meshes_touch_from_the_first_step) {
  static AppBenchTrial trial;
  AppBenchOptions options = app_bench_options_default(1);
  trial = (AppBenchTrial){0};
  ck_assert_ok(app_bench_builtin_large[_i].read(300, &trial.scene));
  ck_assert_ok(app_bench_trial_begin(&trial, &options, 1));
  ck_assert_int_ge(trial.model.vertex_count, 200);
  ck_assert_int_le(trial.model.vertex_count, 550); // the press with the vertices of its plate
  ck_assert_ok(app_bench_trial_run(&trial, 0));
  ck_assert_int_gt(trial.result.pairs_max, 10);
  app_bench_trial_end(&trial);
}
END_TEST

START_TEST(a_trial_is_cut_short_or_fails_and_says_so) {
  static AppBenchTrial trial;
  AppBenchOptions options = app_bench_options_default(1);
  ck_assert_ok(app_bench_builtin_beam(60, 5, &trial.scene));
  ck_assert_ok(app_bench_trial_begin(&trial, &options, 0));
  trial.wall_limit_s = 1e-9;
  ck_assert_ok(app_bench_trial_run(&trial, 0));
  ck_assert_str_eq(app_bench_trial_outcome(&trial), "cut short");
  ck_assert_ptr_nonnull(strstr(trial.message, "was reached"));
  trial.wall_limit_s = 0, trial.scene.min_step = 0.02; // longer than any step may be
  ck_assert_int_eq(app_bench_trial_run(&trial, 0), STATUS_SOLVER);
  trial.accepts_failure = true;
  ck_assert_ok(app_bench_trial_run(&trial, 0));
  ck_assert_str_eq(app_bench_trial_outcome(&trial), "failed");
  trial.scene.min_step = 0, trial.step_limit = 3;
  ck_assert_ok(app_bench_trial_run(&trial, 0));
  ck_assert_str_eq(app_bench_trial_outcome(&trial), "finished");
  ck_assert_int_eq((int)trial.result.integrator.steps, 3);
  app_bench_trial_end(&trial);
}
END_TEST

START_TEST(a_card_tells_a_networks_size) {
  OverlapModel model;
  AppModelCard card;
  ck_assert_ok(overlap_model_create(&model, "geo-small"));
  ck_assert_ok(app_evaluation_card_read(&model, "geo-small", &card));
  ck_assert_str_eq(card.family, "geo");
  ck_assert(card.is_learned && !card.is_float);
  ck_assert_int_eq(card.features, 56);
  ck_assert_int_eq((int)card.parameters, 56 * 16 + 16 + 16 * 16 + 16 + 46 * (16 + 1));
  ck_assert_double_eq(card.flops,
                      2 * (56 * 16 + 16 * 16 + 46 * 16)); // a multiplication and an addition a weight
  overlap_model_destroy(&model);
  ck_assert_ok(overlap_model_create(&model, "clip"));
  ck_assert_ok(app_evaluation_card_read(&model, "clip", &card));
  ck_assert_str_eq(card.family, "clip");
  ck_assert(!card.is_learned);
  overlap_model_destroy(&model);
}
END_TEST

typedef struct Contestant {
  char name;
  char *diary; // of all
} Contestant;

static Status note_turn(void *self, int round) {
  const Contestant *contestant = self;
  size_t length = strlen(contestant->diary);
  contestant->diary[length] = contestant->name;
  contestant->diary[length + 1] = (char)('0' + round);
  return contestant->name == 'x' ? STATUS_SOLVER : STATUS_OK;
}

START_TEST(contestants_take_turns_to_and_fro_after_a_warm_up) {
  char diary[64] = "";
  Contestant contestants[] = {{'a', diary}, {'b', diary}, {'c', diary}};
  ck_assert_ok(app_bench_timer_take_turns(contestants, sizeof *contestants, 3, 3, true, note_turn));
  ck_assert_str_eq(diary, "a0b0c0"
                          "a0b0c0"
                          "c1b1a1"
                          "a2b2c2");
}
END_TEST

START_TEST(a_failure_ends_the_turns) {
  char diary[64] = "";
  Contestant contestants[] = {{'a', diary}, {'x', diary}, {'c', diary}};
  ck_assert_int_eq(app_bench_timer_take_turns(contestants, sizeof *contestants, 3, 2, false, note_turn),
                   STATUS_SOLVER);
  ck_assert_str_eq(diary, "a0x0");
}
END_TEST

START_TEST(the_beam_has_about_the_vertices_that_were_asked_for) {
  const int wanted[] = {24, 1000, 5000};
  for (int i = 0; i < 3; i++) {
    FemSceneDef scene;
    FemModel model;
    ck_assert_ok(app_bench_builtin_beam(wanted[i], 5, &scene));
    ck_assert_ok(fem_model_create(&model, &scene));
    ck_assert_int_ge(model.vertex_count, wanted[i] * 9 / 10);
    ck_assert_int_le(model.vertex_count, wanted[i] * 11 / 10);
    ck_assert_int_gt(model.unknown_count, 0);
    ck_assert_int_lt(model.unknown_count, 3 * model.vertex_count); // one end is clamped
    fem_model_destroy(&model);
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(a_trial_stops_after_its_steps_and_its_phases_sum_to_the_whole) {
  static AppBenchTrial trial;
  AppBenchOptions options = {.threads = 1, .repeats = 2};
  ck_assert_ok(app_bench_builtin_beam(100, 5, &trial.scene));
  ck_assert_ok(app_bench_trial_begin(&trial, &options, 4));
  ck_assert_ok(app_bench_timer_take_turns(&trial, sizeof trial, 1, 2, false, app_bench_trial_run));
  ck_assert_int_eq((int)trial.result.integrator.steps, 4);
  ck_assert_double_gt(trial.result.end_time, 0);
  ck_assert_double_lt(trial.result.end_time, trial.scene.end);
  FemRunPhases phases = app_bench_trial_phases(&trial, 2);
  double seconds[APP_BENCH_PHASE_COUNT], sum = 0;
  app_bench_trial_split(&phases, seconds);
  for (int p = 0; p < APP_BENCH_PHASE_COUNT; p++) {
    // no phase is counted twice: what remains for `other` would be negative
    ck_assert_msg(seconds[p] >= 0, "%s takes %g s", app_bench_phases[p], seconds[p]);
    sum += seconds[p];
  }
  ck_assert_near(sum, phases.total, 1e-12);
  app_bench_trial_end(&trial);
}
END_TEST

// What `tetlap bench` with these arguments prints; its exit code.
static int run_bench(const char *arguments, char output[OUTPUT_SIZE]) {
  char command[1024];
  snprintf(command, sizeof command, "cd '%s' && '%s' bench 2>/dev/null %s", TETLAP_SOURCE_DIR, TETLAP_PROGRAM,
           arguments);
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(pipe);
  output[fread(output, 1, OUTPUT_SIZE - 1, pipe)] = 0;
  int ended = pclose(pipe);
  return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
}

// Where the value of a key begins in a row of JSON; fails if the row lacks it.
static const char *value_of(const char *row, const char *key) {
  char quoted[TEXT_MAX_WORD + 8];
  snprintf(quoted, sizeof quoted, "\"%s\":", key);
  const char *found = strstr(row, quoted);
  ck_assert_msg(found != NULL, "no %s in %s", quoted, row);
  return found + strlen(quoted);
}

// Infinite for null where a rate by processor time may be so: a bench this short can fall between two ticks
// of that clock.
static double number_of(const char *row, const char *key) {
  char *end;
  const char *value = value_of(row, key);
  if (strstr(key, "cpu") && strncmp(value, "null", 4) == 0) return INFINITY;
  double number = strtod(value, &end);
  ck_assert_msg(end != value, "%s is no number in %s", key, row);
  return number;
}

// A bench at a tiny size, the keys that BENCHMARKS.md promises, and those of them that must be positive.
typedef struct Promise {
  const char *arguments;
  int rows;                    // 0: some
  const char *keys, *positive; // separated by spaces
} Promise;

static const Promise promises[] = {
    {"overlap --model clip,exact --set near,uniform --quantity V+grad --batch 100,200 --repeat 1 --threads "
     "1,2",
     16, "bench model set quantity spread reference flops_per_pair peak_share",
     "pairs_per_second pairs_per_cpu_second batch threads ratio ratio_min ratio_max thread_gain"},
    {"overlap --model geo --set near --quantity V --batch 4096 --repeat 1", 1, "bench",
     "flops_per_pair peak_share"},
    {"net --net geo,geo-small --batch 100 --repeat 1 --no-torch --threads 2 --quantity V", 0,
     "bench net implementation precision quantity spread ratio_to_torch difference",
     "parameters batch threads samples_per_second samples_per_cpu_second flops gflops peak_share"},
    {"datagen --count 3000 --repeat 1 --threads 1,2", 6, "bench law product spread",
     "count threads pairs_per_second pairs_per_cpu_second thread_gain planned planned_s"},
    {"train examples/train/sweep/geo.yaml --batch 64 --pairs 300 --repeat 1", 1,
     "bench config model implementation spread ratio_to_torch",
     "parameters batch threads samples_per_second samples_per_cpu_second"},
    {"scaling --model clip --pairs 100,1000 --nodes 100,200 --scene press --steps 2 --repeat 1 --solver amg",
     0, "bench subject name spread exponent cpu_seconds", "size seconds seconds_per_item done"},
    {"elements --passes 1 --repeat 1", 40, "bench element law what single_s lanes_s ratio spread", "threads"},
    {"solver --nodes 60,100 --repeat 2", 10, "bench solver iterations spread factor_entries",
     "vertices unknowns step slenderness assembly_s factorisation_s solve_s setup_solve_s residual"},
    {"beam --nodes 60 --steps 3", 5, "bench solver linear_iterations spread",
     "vertices unknowns steps newton_iterations factorisations linear_solves end_time wall_s forces_s "
     "assembly_s factorisation_s solve_s ratio slenderness"},
    {"scene tests/scenes/onset.yaml examples/01_drop.yaml --set time.end=0.02 --overlap clip,exact --repeat "
     "1",
     4,
     "bench scene overlap solver factorisations energy_gain_relative spread broad_phase_s overlap_s "
     "contact_s forces_s assembly_s analysis_s factorisation_s solve_s output_s other_s",
     "vertices tetrahedra unknowns steps wall_s"},
    {"step tests/scenes/cantilever.yaml --set time.end=0.01 --steps 5 --repeat 1", 11,
     "bench scene overlap phase wall_s wall_s_per_step share", "steps"},
    {"drop --stiffness 1e5,1e6 --tolerance 1e-3", 2,
     "bench scene outcome onsets restarts energy_retries newton_failures energy_gain_relative",
     "stiffness tolerance steps pairs_max contact_force_max deepest_overlap_max min_det_F wall_s"},
};
enum { PROMISE_COUNT = sizeof promises / sizeof *promises };

// What is counted is written without a decimal point.
static void check_counts(const char *row) {
  static const char keys[] = "vertices unknowns steps threads newton_iterations linear_iterations set_ups "
                             "factor_entries peak_bytes";
  char key[TEXT_MAX_WORD], quoted[TEXT_MAX_WORD + 4];
  for (const char *rest = text_next(keys, key); rest; rest = text_next(rest, key)) {
    snprintf(quoted, sizeof quoted, "\"%s\":", key);
    const char *at = strstr(row, quoted);
    if (!at) continue;
    at += strlen(quoted);
    at += strncmp(at, "null", 4) == 0 ? 4 : strspn(at, "-0123456789");
    ck_assert_msg(*at == ',' || *at == '}', "%s is no whole number in %s", key, row);
  }
}

static void check_row(const char *row, const Promise *promise) {
  char key[TEXT_MAX_WORD];
  ck_assert_int_eq(row[0], '{');
  ck_assert_int_eq(row[strlen(row) - 1], '}');
  for (const char *rest = text_next(promise->keys, key); rest; rest = text_next(rest, key))
    value_of(row, key);
  for (const char *rest = text_next(promise->positive, key); rest; rest = text_next(rest, key))
    ck_assert_msg(number_of(row, key) > 0, "%s is not positive in %s", key, row);
  check_counts(row);
  value_of(row, "processor");
  value_of(row, "simd");
  value_of(row, "versions");
  ck_assert_double_ge(number_of(row, "repeats"), 1);
}

START_TEST(rows_carry_the_promised_keys) {
  static char output[OUTPUT_SIZE];
  const Promise *promise = &promises[_i];
  char arguments[512];
  snprintf(arguments, sizeof arguments, "%s --json", promise->arguments);
  ck_assert_int_eq(run_bench(arguments, output), 0);
  int rows = 0;
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n"), rows++) check_row(row, promise);
  ck_assert_int_gt(rows, 0);
  if (promise->rows) ck_assert_int_eq(rows, promise->rows);
}
END_TEST

static int count(const char *text, char letter) {
  int found = 0;
  for (; *text; text++) found += *text == letter;
  return found;
}

START_TEST(csv_and_markdown_have_as_many_cells_in_every_line) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench("solver --nodes 60 --solver cholmod,klu --repeat 1 --csv", output), 0);
  char *head = strtok(output, "\n"), *row = strtok(NULL, "\n");
  ck_assert_int_eq(strncmp(head, "bench,solver,", 13), 0);
  ck_assert_int_eq(strncmp(row, "solver,cholmod,", 15), 0);
  ck_assert_int_eq(count(row, ','), count(head, ','));
  ck_assert_int_eq(run_bench("solver --nodes 60 --solver cholmod,klu --repeat 1 --markdown", output), 0);
  int lines = 0, cells = 0;
  for (const char *line = strtok(output, "\n"); line; line = strtok(NULL, "\n"), lines++) {
    if (lines == 0) cells = count(line, '|');
    ck_assert_int_eq(count(line, '|'), cells);
  }
  ck_assert_int_eq(lines, 4); // heads, rule, two rows
}
END_TEST

START_TEST(direct_solvers_solve_to_rounding_and_agree_on_the_run) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench("solver --nodes 200 --solver cholmod,klu --repeat 1 --json", output), 0);
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n"))
    ck_assert_msg(number_of(row, "residual") < 1e-10, "%s", row);
  ck_assert_int_eq(run_bench("beam --nodes 200 --solver cholmod,klu --steps 10 --json", output), 0);
  const char *cholmod = strtok(output, "\n"), *klu = strtok(NULL, "\n");
  ck_assert_double_eq(number_of(cholmod, "steps"), 10);
  ck_assert_double_eq(number_of(cholmod, "ratio"), 1);
  // cholmod's solutions follow c, klu's are scaled by IDA: corrections, and with them errors and steps, are
  // not the same, but Newton's method has as little to do.
  ck_assert_double_eq(number_of(klu, "steps"), number_of(cholmod, "steps"));
  ck_assert_near(number_of(klu, "newton_iterations"), number_of(cholmod, "newton_iterations"), 3);
  ck_assert_near(number_of(klu, "end_time"), number_of(cholmod, "end_time"),
                 0.5 * number_of(cholmod, "end_time"));
}
END_TEST

START_TEST(shares_of_a_run_sum_to_one) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench("step examples/01_drop.yaml --set time.end=0.02 --repeat 1 --json", output), 0);
  double sum = 0, total = 0;
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n")) {
    bool is_total = strncmp(value_of(row, "phase"), "\"total\"", 7) == 0;
    *(is_total ? &total : &sum) += number_of(row, "share");
  }
  ck_assert_double_eq(total, 1);
  ck_assert_near(sum, 1, 1e-9);
}
END_TEST

// Two weights files of one name, in folders of their own.
START_TEST(weights_files_are_measured_under_names_of_their_own) {
  static char output[OUTPUT_SIZE];
  char folder[] = "/tmp/tetlap_bench_XXXXXX", words[512];
  ck_assert_ptr_nonnull(mkdtemp(folder));
  snprintf(words, sizeof words,
           "cd %s && mkdir a b && cp '%s/net/weights/geo-small.safetensors' a/net.safetensors && "
           "cp '%s/net/weights/geo.safetensors' b/net.safetensors",
           folder, TETLAP_SOURCE_DIR, TETLAP_SOURCE_DIR);
  ck_assert_int_eq(system(words), 0);
  const char *kinds[] = {"overlap -s near -Q V -b 10 -r 1 -j -m", "scene -r 1 -s time.end=0.02 -j -m"};
  const char *keys[] = {"model", "overlap"}, *scenes[] = {"", "examples/01_drop.yaml"};
  for (int k = 0; k < 2; k++) {
    snprintf(words, sizeof words, "%s clip,%s/a/net.safetensors,%s/b/net.safetensors %s", kinds[k], folder,
             folder, scenes[k]);
    ck_assert_msg(run_bench(words, output) == 0, "%s", words);
    const char *names[] = {"clip", "a/net", "b/net"};
    for (int m = 0; m < 3; m++) {
      char expected[64];
      snprintf(expected, sizeof expected, "\"%s\":\"%s\"", keys[k], names[m]);
      ck_assert_msg(strstr(output, expected) != NULL, "no %s in %s", expected, output);
    }
  }
  snprintf(words, sizeof words, "rm -r %s", folder);
  ck_assert_int_eq(system(words), 0);
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  static char output[OUTPUT_SIZE];
  const char *wrong[] = {"",
                         "everything",
                         "overlap --model clap",
                         "overlap --model clip,clip",
                         "overlap --device host --model net/weights/geo.safetensors",
                         "overlap --set far",
                         "overlap --quantity W",
                         "overlap --batch 0",
                         "overlap --batch 1.5",
                         "solver --threads 1,2",
                         "scaling --solver amg,pcg",
                         "scaling --solver umfpack",
                         "scaling --scene moon",
                         "datagen --law paper",
                         "train",
                         "precision examples/02_two_blocks.yaml --level 0",
                         "overlap --repeat many",
                         "overlap --model exact --quantity V+grad+hess",
                         "solver --nodes 5000,x",
                         "solver --solver umfpack",
                         "beam --nodes 5000,6000",
                         "beam --slenderness nan",
                         "drop --stiffness -1",
                         "drop --tolerance ''",
                         "scene",
                         "scene examples/01_drop.yaml --set contact.stifness=1",
                         "step",
                         "step a.yaml b.yaml"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(run_bench(wrong[k], output) == 64, "%s", wrong[k]);
  ck_assert_int_eq(run_bench("step no_such_scene.yaml", output), 74);
}
END_TEST

START_TEST(an_unknown_bench_gets_the_nearest_name) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench("slover 2>&1", output), 64);
  ck_assert_msg(strstr(output, "did you mean: tetlap bench solver") != NULL, "%s", output);
  ck_assert_int_eq(run_bench("--help", output), 0);
  ck_assert_ptr_nonnull(strstr(output, "overlap"));
  ck_assert_ptr_nonnull(strstr(output, "drop"));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("bench");
  tcase_add_loop_test(cases, the_same_seed_gives_the_same_pairs, 0, APP_BENCH_SET_COUNT);
  tcase_add_test(cases, an_unknown_set_is_an_error_that_names_the_known_ones);
  tcase_add_test(cases, the_median_of_rounds_counts);
  tcase_add_test(cases, ratios_are_taken_within_a_round);
  tcase_add_test(cases, more_pairs_than_are_made_repeat_the_first);
  tcase_add_test(cases, the_peak_is_a_number);
  tcase_add_test(cases, a_power_law_gives_its_exponent);
  tcase_add_loop_test(cases, scenes_for_large_meshes_touch_from_the_first_step, 0, APP_BENCH_LARGE_COUNT);
  tcase_add_test(cases, a_trial_is_cut_short_or_fails_and_says_so);
  tcase_add_test(cases, a_card_tells_a_networks_size);
  tcase_add_test(cases, contestants_take_turns_to_and_fro_after_a_warm_up);
  tcase_add_test(cases, a_failure_ends_the_turns);
  tcase_add_test(cases, the_beam_has_about_the_vertices_that_were_asked_for);
  tcase_add_test(cases, a_trial_stops_after_its_steps_and_its_phases_sum_to_the_whole);
  tcase_add_loop_test(cases, rows_carry_the_promised_keys, 0, PROMISE_COUNT);
  tcase_add_test(cases, csv_and_markdown_have_as_many_cells_in_every_line);
  tcase_add_test(cases, direct_solvers_solve_to_rounding_and_agree_on_the_run);
  tcase_add_test(cases, shares_of_a_run_sum_to_one);
  tcase_add_test(cases, weights_files_are_measured_under_names_of_their_own);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  tcase_add_test(cases, an_unknown_bench_gets_the_nearest_name);
  return suite_run("bench", cases, 60);
}
