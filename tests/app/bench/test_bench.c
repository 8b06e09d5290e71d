// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap bench`: the sets of pairs, the timer, and the rows that scripts read.
#include "app/bench/overlap/pairs.h"
#include "app/bench/timer.h"
#include "app/evaluation/card.h"
#include "base/memory.h"
#include "bench_rows.h"
#include "overlap/models.h"

enum { COUNT = 50 };
static const char BENCH[] = TETLAP_PROGRAM " bench";

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

START_TEST(a_card_tells_a_networks_size) {
  OverlapModel model;
  AppModelCard card;
  ck_assert_ok(overlap_models_create(&model, "geo-small"));
  ck_assert_ok(app_evaluation_card_read(&model, "geo-small", &card));
  ck_assert_str_eq(card.family, "geo");
  ck_assert_int_eq((int)card.parameters, 56 * 16 + 16 + 16 * 16 + 16 + 46 * (16 + 1));
  overlap_model_destroy(&model);
  ck_assert_ok(overlap_models_create(&model, "clip"));
  ck_assert_ok(app_evaluation_card_read(&model, "clip", &card));
  ck_assert_str_eq(card.family, "clip");
  ck_assert_int_eq((int)card.parameters, 0);
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
  ck_assert_ok(app_bench_timer_take_turns(contestants, sizeof *contestants, 3, 3, note_turn));
  ck_assert_str_eq(diary, "a0b0c0"
                          "a0b0c0"
                          "c1b1a1"
                          "a2b2c2");
}
END_TEST

START_TEST(a_failure_ends_the_turns) {
  char diary[64] = "";
  Contestant contestants[] = {{'a', diary}, {'x', diary}, {'c', diary}};
  ck_assert_int_eq(app_bench_timer_take_turns(contestants, sizeof *contestants, 3, 2, note_turn),
                   STATUS_SOLVER);
  ck_assert_str_eq(diary, "a0x0");
}
END_TEST

static const Promise promises[] = {
    {"overlap --model clip,exact --set near,uniform --quantity V+grad --batch 100,200 --repeat 1 --threads "
     "1,2",
     16,
     "bench model family set quantity spread reference error error_median error_p90 fallback_share frontier "
     "parameters",
     "pairs_per_second pairs_per_cpu_second batch threads ratio ratio_min ratio_max thread_gain samples"},
    {"overlap --model geo --set near --quantity V --batch 4096 --repeat 1", 1, "bench",
     "error error_median error_p90 parameters frontier samples"},
};
enum { PROMISE_COUNT = sizeof promises / sizeof *promises };

START_TEST(rows_carry_the_promised_keys) {
  check_promise(BENCH, &promises[_i]);
}
END_TEST

START_TEST(exact_has_no_error_clip_rounding_and_a_learned_model_its_own) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(BENCH,
                             "overlap -m exact,clip,geo-small -s near -Q V,V+grad,V+centroid -b 200 -r 1 -j",
                             output),
                   0);
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n")) {
    if (strstr(row, "V+centroid")) {
      ck_assert_int_eq(strncmp(value_of(row, "error"), "null", 4), 0);
      continue;
    }
    double error = number_of(row, "error");
    if (strstr(row, "\"model\":\"exact\"")) {
      ck_assert_double_eq(error, 0);
      ck_assert_double_eq(number_of(row, "frontier"), 1); // nothing beats no error
    } else if (strstr(row, "\"model\":\"clip\"")) {
      ck_assert_msg(error > 0 && error < 1e-9, "%g", error);
    } else {
      ck_assert_msg(error > 1e-4 && error < 0.1, "%g", error);
      ck_assert_double_le(number_of(row, "error_median"), number_of(row, "error_p90"));
      ck_assert_double_gt(number_of(row, "parameters"), 1000);
    }
  }
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
  snprintf(words, sizeof words,
           "overlap -s near -Q V -b 10 -r 1 -j -m clip,%s/a/net.safetensors,%s/b/net.safetensors", folder,
           folder);
  ck_assert_msg(run_bench(BENCH, words, output) == 0, "%s", words);
  const char *names[] = {"clip", "a/net", "b/net"};
  for (int m = 0; m < 3; m++) {
    char expected[64];
    snprintf(expected, sizeof expected, "\"model\":\"%s\"", names[m]);
    ck_assert_msg(strstr(output, expected) != NULL, "no %s in %s", expected, output);
  }
  snprintf(words, sizeof words, "rm -r %s", folder);
  ck_assert_int_eq(system(words), 0);
}
END_TEST

// A library that gives V and centroids, no gradients; a network with clipping where it doubts.
START_TEST(models_of_users_are_measured_in_what_they_give) {
  static char output[OUTPUT_SIZE];
  const char words[] =
      "overlap -s near -b 10 -r 1 -j -m " TETLAP_MODEL_SPLIT ",hybrid=net/weights/geo-small.safetensors";
  int own = 0, hybrid = 0;
  ck_assert_int_eq(run_bench(BENCH, words, output), 0);
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n")) {
    bool is_hybrid = strstr(row, "\"model\":\"hybrid=") != NULL;
    hybrid += is_hybrid, own += !is_hybrid;
    ck_assert_msg(is_hybrid || !strstr(row, "V+grad"), "%s", row);
    ck_assert_int_eq(strstr(row, "\"family\":\"geo\"") != NULL, is_hybrid);
  }
  ck_assert_int_eq(own, 2);
  ck_assert_int_ge(hybrid, 3);
}
END_TEST

// Without --model those that are there are measured.
START_TEST(a_model_that_is_named_is_not_left_out) {
  static char output[OUTPUT_SIZE];
  const char without[] = "TETLAP_DATA=/nowhere " TETLAP_PROGRAM " bench";
  ck_assert_int_eq(run_bench(without, "overlap -s near -Q V -b 10 -r 1 -j", output), 0);
  ck_assert(strstr(output, "\"model\":\"clip\"") && !strstr(output, "\"model\":\"geo\""));
  ck_assert_int_eq(run_bench(without, "overlap -m clip,geo -s near -Q V -b 10 -r 1 2>&1", output), 74);
  ck_assert_msg(strstr(output, "the weights of 'geo'") != NULL, "%s", output);
}
END_TEST

START_TEST(a_wrong_option_is_told_as_it_was_given) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(BENCH, "unseen --threads 1,2 2>&1", output), 64);
  ck_assert_msg(strstr(output, "--threads is '1,2'") != NULL, "%s", output);
  ck_assert_int_eq(run_bench(BENCH, "unseen --model clop 2>&1", output), 64);
  ck_assert_msg(strstr(output, "--model: there is no overlap model 'clop'") != NULL, "%s", output);
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  static char output[OUTPUT_SIZE];
  static const char *const wrong[] = {"",
                                      "everything",
                                      "overlap --model clap",
                                      "overlap --model clip,clip",
                                      "overlap --set far",
                                      "overlap --quantity W",
                                      "overlap --batch 0",
                                      "overlap --batch 1.5",
                                      "overlap --repeat many",
                                      "overlap --model exact --quantity V+grad+hess"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(run_bench(BENCH, wrong[k], output) == 64, "%s", wrong[k]);
}
END_TEST

START_TEST(an_unknown_bench_gets_the_nearest_name) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(BENCH, "unsene 2>&1", output), 64);
  ck_assert_msg(strstr(output, "did you mean: tetlap bench unseen") != NULL, "%s", output);
  ck_assert_int_eq(run_bench(BENCH, "--help", output), 0);
  ck_assert_ptr_nonnull(strstr(output, "overlap"));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("bench");
  tcase_add_loop_test(cases, the_same_seed_gives_the_same_pairs, 0, APP_BENCH_SET_COUNT);
  tcase_add_test(cases, an_unknown_set_is_an_error_that_names_the_known_ones);
  tcase_add_test(cases, the_median_of_rounds_counts);
  tcase_add_test(cases, ratios_are_taken_within_a_round);
  tcase_add_test(cases, more_pairs_than_are_made_repeat_the_first);
  tcase_add_test(cases, a_card_tells_a_networks_size);
  tcase_add_test(cases, contestants_take_turns_to_and_fro_after_a_warm_up);
  tcase_add_test(cases, a_failure_ends_the_turns);
  tcase_add_loop_test(cases, rows_carry_the_promised_keys, 0, PROMISE_COUNT);
  tcase_add_test(cases, exact_has_no_error_clip_rounding_and_a_learned_model_its_own);
  tcase_add_test(cases, weights_files_are_measured_under_names_of_their_own);
  tcase_add_test(cases, models_of_users_are_measured_in_what_they_give);
  tcase_add_test(cases, a_model_that_is_named_is_not_left_out);
  tcase_add_test(cases, a_wrong_option_is_told_as_it_was_given);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  tcase_add_test(cases, an_unknown_bench_gets_the_nearest_name);
  return suite_run("bench", cases, 60);
}
