// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab`: what its benches are made of, and the rows that scripts read.
#include "app/bench/peak.h"
#include "bench_rows.h"
#include "fem/model/build.h"
#include "lab/scene/builtin.h"
#include "lab/scene/scaling.h"
#include "lab/trial.h"

static const char LAB[] = TETLAP_LAB;

START_TEST(the_peak_is_a_number) {
  double single = app_bench_peak_measure(true), twice = app_bench_peak_measure(false);
  ck_assert_double_gt(twice, 0);
  ck_assert_double_gt(single, 0);
  ck_assert(isfinite(single) && isfinite(twice));
}
END_TEST

START_TEST(a_power_law_gives_its_exponent) {
  const double sizes[] = {10, 100, 1000, 1e4}, seconds[] = {3e-3, 3e-1, NAN, 3e3}, once[] = {1, 0, 0, 0};
  ck_assert_near(lab_scaling_exponent(sizes, seconds, 4), 2, 1e-12);
  ck_assert(isnan(lab_scaling_exponent(sizes, once, 4)));
  ck_assert(isnan(lab_scaling_exponent(sizes, seconds, 0)));
}
END_TEST

START_TEST(scenes_for_large_meshes_touch_from_the_first_step) {
  static LabTrial trial;
  AppBenchOptions options = app_bench_options_default(1);
  trial = (LabTrial){0};
  ck_assert_ok(lab_scene_builtin_large[_i].read(300, &trial.scene));
  ck_assert_ok(lab_trial_begin(&trial, &options, 1));
  ck_assert_int_ge(trial.model.vertex_count, 200);
  ck_assert_int_le(trial.model.vertex_count, 550); // the press with the vertices of its plate
  ck_assert_ok(lab_trial_run(&trial, 0));
  ck_assert_int_gt(trial.result.pairs_max, 10);
  lab_trial_end(&trial);
}
END_TEST

START_TEST(a_trial_is_cut_short_or_fails_and_says_so) {
  static LabTrial trial;
  AppBenchOptions options = app_bench_options_default(1);
  ck_assert_ok(lab_scene_builtin_beam(60, 5, &trial.scene));
  ck_assert_ok(lab_trial_begin(&trial, &options, 0));
  trial.wall_limit_s = 1e-9;
  ck_assert_ok(lab_trial_run(&trial, 0));
  ck_assert_str_eq(lab_trial_outcome(&trial), "cut short");
  ck_assert_ptr_nonnull(strstr(trial.message, "was reached"));
  trial.wall_limit_s = 0, trial.scene.min_step = 0.02; // longer than any step may be
  ck_assert_int_eq(lab_trial_run(&trial, 0), STATUS_SOLVER);
  trial.accepts_failure = true;
  ck_assert_ok(lab_trial_run(&trial, 0));
  ck_assert_str_eq(lab_trial_outcome(&trial), "failed");
  trial.scene.min_step = 0, trial.step_limit = 3;
  ck_assert_ok(lab_trial_run(&trial, 0));
  ck_assert_str_eq(lab_trial_outcome(&trial), "finished");
  ck_assert_int_eq((int)trial.result.integrator.steps, 3);
  lab_trial_end(&trial);
}
END_TEST

START_TEST(the_beam_has_about_the_vertices_that_were_asked_for) {
  const int wanted[] = {24, 1000, 5000};
  for (int i = 0; i < 3; i++) {
    FemSceneDef scene;
    FemModel model;
    ck_assert_ok(lab_scene_builtin_beam(wanted[i], 5, &scene));
    ck_assert_ok(fem_model_create(&model, &scene));
    ck_assert_int_ge(model.vertex_count, wanted[i] * 9 / 10);
    ck_assert_int_le(model.vertex_count, wanted[i] * 11 / 10);
    ck_assert_int_gt(model.free_count, 0);
    ck_assert_int_lt(model.free_count, 3 * model.vertex_count); // one end is clamped
    fem_model_destroy(&model);
    fem_scene_destroy(&scene);
  }
}
END_TEST

START_TEST(a_trial_stops_after_its_steps_and_its_phases_sum_to_the_whole) {
  static LabTrial trial;
  AppBenchOptions options = {.threads = 1, .repeats = 2};
  ck_assert_ok(lab_scene_builtin_beam(100, 5, &trial.scene));
  ck_assert_ok(lab_trial_begin(&trial, &options, 4));
  ck_assert_ok(app_bench_timer_take_turns(&trial, sizeof trial, 1, 2, false, lab_trial_run));
  ck_assert_int_eq((int)trial.result.integrator.steps, 4);
  ck_assert_double_gt(trial.result.end_time, 0);
  ck_assert_double_lt(trial.result.end_time, trial.scene.end);
  FemRunPhases phases = lab_trial_phases(&trial, 2);
  double seconds[LAB_TRIAL_PHASE_COUNT], sum = 0;
  lab_trial_split(&phases, seconds);
  for (int p = 0; p < LAB_TRIAL_PHASE_COUNT; p++) {
    // no phase is counted twice: what remains for `other` would be negative
    ck_assert_msg(seconds[p] >= 0, "%s takes %g s", lab_trial_phase_names[p], seconds[p]);
    sum += seconds[p];
  }
  ck_assert_near(sum, phases.total, 1e-12);
  lab_trial_end(&trial);
}
END_TEST

static const Promise promises[] = {
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
    {"device host --model clip,tpn --set near --quantity V --residence device --batch 100 --repeat 1", 2,
     "bench model set quantity residence gate of_peak of_issue spread device",
     "batch kernel_pairs_s pairs_s"},
};
enum { PROMISE_COUNT = sizeof promises / sizeof *promises };

START_TEST(rows_carry_the_promised_keys) {
  check_promise(LAB, &promises[_i]);
}
END_TEST

static int count(const char *text, char letter) {
  int found = 0;
  for (; *text; text++) found += *text == letter;
  return found;
}

START_TEST(csv_and_markdown_have_as_many_cells_in_every_line) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(LAB, "solver --nodes 60 --solver cholmod,klu --repeat 1 --csv", output), 0);
  char *head = strtok(output, "\n"), *row = strtok(NULL, "\n");
  ck_assert_int_eq(strncmp(head, "bench,solver,", 13), 0);
  ck_assert_int_eq(strncmp(row, "solver,cholmod,", 15), 0);
  ck_assert_int_eq(count(row, ','), count(head, ','));
  ck_assert_int_eq(run_bench(LAB, "solver --nodes 60 --solver cholmod,klu --repeat 1 --markdown", output), 0);
  int lines = 0, cells = 0;
  for (const char *line = strtok(output, "\n"); line; line = strtok(NULL, "\n"), lines++) {
    if (lines == 0) cells = count(line, '|');
    ck_assert_int_eq(count(line, '|'), cells);
  }
  ck_assert_int_eq(lines, 4); // heads, rule, two rows
}
END_TEST

START_TEST(direct_solvers_solve_to_rounding) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(LAB, "solver --nodes 200 --solver cholmod,klu --repeat 1 --json", output), 0);
  for (char *row = strtok(output, "\n"); row; row = strtok(NULL, "\n"))
    ck_assert_msg(number_of(row, "residual") < 1e-10, "%s", row);
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  static char output[OUTPUT_SIZE];
  static const char *const wrong[] = {"solver --threads 1,2",
                                      "scaling --solver amg,pcg",
                                      "scaling --solver umfpack",
                                      "scaling --scene moon",
                                      "datagen --law paper",
                                      "train",
                                      "precision examples/02_two_blocks.yaml --level 0",
                                      "solver --nodes 5000,x",
                                      "solver --solver umfpack",
                                      "device",
                                      "device host --model net/weights/geo.safetensors",
                                      "device host cuda",
                                      "net --net ,",
                                      "precision examples/02_two_blocks.yaml --overlap \"\"",
                                      "pareto -m \"\"",
                                      "pareto -m clip,,geo"};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
    ck_assert_msg(run_bench(LAB, wrong[k], output) == 64, "%s", wrong[k]);
}
END_TEST

START_TEST(an_unknown_command_gets_the_nearest_name) {
  static char output[OUTPUT_SIZE];
  ck_assert_int_eq(run_bench(LAB, "slover 2>&1", output), 64);
  ck_assert_msg(strstr(output, "tetlap-lab solver") != NULL, "%s", output);
  ck_assert_int_eq(run_bench(LAB, "--help", output), 0);
  ck_assert_ptr_nonnull(strstr(output, "elements"));
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("lab");
  tcase_add_test(cases, the_peak_is_a_number);
  tcase_add_test(cases, a_power_law_gives_its_exponent);
  tcase_add_loop_test(cases, scenes_for_large_meshes_touch_from_the_first_step, 0, LAB_SCENE_LARGE_COUNT);
  tcase_add_test(cases, a_trial_is_cut_short_or_fails_and_says_so);
  tcase_add_test(cases, the_beam_has_about_the_vertices_that_were_asked_for);
  tcase_add_test(cases, a_trial_stops_after_its_steps_and_its_phases_sum_to_the_whole);
  tcase_add_loop_test(cases, rows_carry_the_promised_keys, 0, PROMISE_COUNT);
  tcase_add_test(cases, csv_and_markdown_have_as_many_cells_in_every_line);
  tcase_add_test(cases, direct_solvers_solve_to_rounding);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  tcase_add_test(cases, an_unknown_command_gets_the_nearest_name);
  return suite_run("lab", cases, 60);
}
