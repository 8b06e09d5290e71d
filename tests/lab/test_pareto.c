// SPDX-License-Identifier: GPL-3.0-or-later
// The frontier: which points are on it, what `tetlap-lab pareto` measures and writes, sweeps of trainings.
#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/training/sweep.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "lab/pareto/pairs.h"
#include "lab/pareto/scenes.h"
#include "overlap/weights.h"

static LabPareto small(void) {
  return (LabPareto){.common = app_bench_options_default(1),
                     .batch = 64,
                     .error_pairs = 200,
                     .scene_wall_s = 20,
                     .scene_rounds = 1,
                     .audit_every = 5};
}

static void add(LabPareto *pareto, const char *set, double seconds, double error) {
  LabParetoPoint *point = lab_pareto_add_point(pareto, 0, "V", set);
  ck_assert_ptr_nonnull(point);
  point->seconds = seconds, point->error = error;
}

START_TEST(the_frontier_is_what_nothing_beats) {
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  add(&pareto, "near", 1, 1e-3);    // fastest
  add(&pareto, "near", 2, 1e-3);    // slower and no better
  add(&pareto, "near", 3, 0);       // most accurate
  add(&pareto, "near", 3, 1e-9);    // as slow, worse
  add(&pareto, "near", 2, 1e-4);    // between
  add(&pareto, "near", 2, 1e-4);    // the same once more: neither beats the other
  add(&pareto, "near", NAN, 1e-12); // not measured
  add(&pareto, "uniform", 9, 1);    // alone in its set
  add(&pareto, "near", 0.5, 0);     // of a device: beats none of the processor's
  pareto.points[8].device = "host";
  lab_pareto_finish(&pareto);
  const bool expected[9] = {true, false, true, false, true, true, false, true, true};
  for (int p = 0; p < 9; p++) ck_assert_msg(pareto.points[p].is_frontier == expected[p], "point %d", p);
  lab_pareto_destroy(&pareto);
}
END_TEST

static const LabParetoPoint *find(const LabPareto *pareto, const char *model, const char *quantity) {
  for (size_t p = 0; p < pareto->point_count; p++)
    if (strcmp(pareto->points[p].model, model) == 0 && strcmp(pareto->points[p].quantity, quantity) == 0)
      return &pareto->points[p];
  ck_abort_msg("no point %s %s", model, quantity);
  return NULL;
}

START_TEST(exact_has_no_error_clip_rounding_and_a_learned_model_its_own) {
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "exact"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "geo-small"));
  ck_assert_ok(lab_pareto_pairs_measure(&pareto, "near"));
  ck_assert_int_eq((int)pareto.point_count, 6);
  static const char *const quantities[] = {"V", "V+grad"};
  for (int q = 0; q < 2; q++) {
    const LabParetoPoint *clip = find(&pareto, "clip", quantities[q]),
                         *exact = find(&pareto, "exact", quantities[q]),
                         *geo = find(&pareto, "geo-small", quantities[q]);
    ck_assert_double_eq(exact->error, 0);
    ck_assert_msg(clip->error > 0 && clip->error < 1e-9, "%g", clip->error);
    ck_assert_msg(geo->error > 1e-4 && geo->error < 0.1, "%g", geo->error);
    ck_assert_msg(geo->error_median > 0 && geo->error_median <= geo->error_p90, "%g", geo->error_median);
    ck_assert_int_eq((int)geo->parameters, 1966);
    ck_assert_int_eq((int)geo->samples, 200);
    ck_assert(clip->seconds > 0 && clip->seconds_min <= clip->seconds && clip->cpu_seconds > 0);
    ck_assert(isnan(clip->step_s) && !clip->outcome);
  }
  lab_pareto_destroy(&pareto);
}
END_TEST

// Against a peer that is tried in the same rounds; the paper's comparison needs models that are not here.
START_TEST(a_comparison_names_both_and_takes_its_ratio_within_a_round) {
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "geo"));
  ck_assert_ok(lab_pareto_pairs_measure(&pareto, "near"));
  ck_assert_int_eq(pareto.comparison_count, 1);
  const LabParetoComparison *comparison = &pareto.comparisons[0];
  ck_assert_str_eq(comparison->slow, "clip");
  ck_assert_str_eq(comparison->fast, "geo");
  // one round of one thread: the ratio of the rates is that of the round
  ck_assert_near(comparison->ratio, comparison->fast_rate / comparison->slow_rate, 1e-9 * comparison->ratio);
  ck_assert_double_eq(comparison->fast_error, find(&pareto, "geo", "V+grad")->error);
  ck_assert(isnan(comparison->paper_ratio));
  lab_pareto_destroy(&pareto);
}
END_TEST

// clip's kernels give clip's bits, geo's to rounding; exact has none.
START_TEST(a_device_adds_points_of_the_models_that_have_kernels) {
  LabPareto pareto = small();
  pareto.device = "host";
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "exact"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "geo-small"));
  ck_assert_ok(lab_pareto_pairs_measure(&pareto, "near"));
  lab_pareto_finish(&pareto);
  ck_assert_int_eq((int)pareto.point_count, 10);
  static const char *const quantities[] = {"V", "V+grad"};
  for (int q = 0; q < 2; q++) {
    const LabParetoPoint *clip = find(&pareto, "clip", quantities[q]),
                         *kernel = find(&pareto, "clip@host", quantities[q]),
                         *geo = find(&pareto, "geo-small", quantities[q]),
                         *network = find(&pareto, "geo-small@host", quantities[q]);
    ck_assert(!clip->device && strcmp(kernel->device, "host") == 0);
    ck_assert(kernel->error > 0 && kernel->error < 1e-9);
    ck_assert_near(network->error, geo->error, 1e-9 * geo->error);
    ck_assert(kernel->seconds > 0 && kernel->seconds_min <= kernel->seconds);
  }
  lab_pareto_destroy(&pareto);
}
END_TEST

START_TEST(files_of_one_base_name_have_names_of_their_own) {
  char home[] = "/tmp/tetlap_pareto_XXXXXX", weights[4096], command[3 * 4096], paths[2][64];
  ck_assert_ptr_nonnull(mkdtemp(home));
  ck_assert_ok(overlap_weights_find("geo-small", weights, sizeof weights));
  snprintf(command, sizeof command,
           "cd %s && mkdir a b && cp %s a/net.safetensors && cp %s b/net.safetensors", home, weights,
           weights);
  ck_assert_int_eq(system(command), 0);
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  for (int k = 0; k < 2; k++) {
    snprintf(paths[k], sizeof paths[k], "%s/%c/net.safetensors", home, 'a' + k);
    ck_assert_ok(lab_pareto_add_model(&pareto, paths[k]));
  }
  ck_assert_str_eq(pareto.models[0].name, "a/net");
  ck_assert_str_eq(pareto.models[1].name, "b/net");
  lab_pareto_destroy(&pareto);
  snprintf(command, sizeof command, "rm -r %s", home);
  ck_assert_int_eq(system(command), 0);
}
END_TEST

START_TEST(models_of_one_name_are_refused) {
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_int_eq(lab_pareto_add_model(&pareto, "clip"), STATUS_USAGE);
  ck_assert_int_eq(lab_pareto_add_model(&pareto, "clap"), STATUS_INPUT);
  ck_assert_int_eq(pareto.model_count, 1);
  lab_pareto_destroy(&pareto);
}
END_TEST

START_TEST(a_scene_gives_forces_in_the_same_configurations_and_a_run_of_each_model) {
  LabPareto pareto = small();
  const char *overrides[] = {"time.end=0.04"};
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_ok(lab_pareto_add_model(&pareto, "geo-small"));
  ck_assert_ok(lab_pareto_scenes_measure(&pareto, TETLAP_SOURCE_DIR "/tests/scenes/collision.yaml", "clip",
                                         overrides, 1));
  const LabParetoPoint *clip = find(&pareto, "clip", "force"), *geo = find(&pareto, "geo-small", "force");
  ck_assert_int_gt((int)clip->samples, 2);
  ck_assert_int_eq((int)clip->samples, (int)geo->samples);
  ck_assert_msg(clip->error < 1e-9, "%g", clip->error);
  ck_assert_msg(geo->error > 1e-5 && geo->error < 0.2, "%g", geo->error);
  ck_assert_str_eq(clip->outcome, "finished");
  ck_assert_double_eq(clip->trajectory_error, 0); // the reference's run, run again
  ck_assert_double_gt(geo->trajectory_error, 0);
  ck_assert_msg(clip->share > 0 && clip->share < 1, "%g", clip->share);
  ck_assert_near(clip->limit * (1 - clip->share), 1, 1e-12);
  ck_assert(clip->step_s > 0 && clip->seconds > 0 && clip->steps > 0);
  lab_pareto_destroy(&pareto);
}
END_TEST

// As those of a sweep are.
START_TEST(a_weights_file_runs_a_scene_as_its_name_does) {
  char path[1024];
  ck_assert_ok(overlap_weights_find("geo-small", path, sizeof path));
  const char *sources[] = {"geo-small", path}, *names[] = {"geo-small", "weights/geo-small"},
             *overrides[] = {"time.end=0.03"};
  double errors[2];
  for (int k = 0; k < 2; k++) {
    LabPareto pareto = small();
    ck_assert_ok(lab_pareto_create(&pareto));
    ck_assert_ok(lab_pareto_add_model(&pareto, sources[k]));
    ck_assert_ok(lab_pareto_scenes_measure(&pareto, TETLAP_SOURCE_DIR "/tests/scenes/collision.yaml", "clip",
                                           overrides, 1));
    const LabParetoPoint *point = find(&pareto, names[k], "force");
    ck_assert_str_eq(point->outcome, "finished");
    errors[k] = point->trajectory_error;
    lab_pareto_destroy(&pareto);
  }
  ck_assert_double_gt(errors[0], 0);
  ck_assert_double_eq(errors[0], errors[1]);
}
END_TEST

START_TEST(a_run_that_takes_too_long_is_cut_short_and_still_a_point) {
  LabPareto pareto = small();
  pareto.scene_wall_s = 1e-6;
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  const char *overrides[] = {"time.end=0.03"};
  ck_assert_ok(lab_pareto_scenes_measure(&pareto, TETLAP_SOURCE_DIR "/tests/scenes/collision.yaml", "clip",
                                         overrides, 1));
  const LabParetoPoint *point = find(&pareto, "clip", "force");
  ck_assert_str_eq(point->outcome, "cut short");
  ck_assert(isnan(point->trajectory_error) && isfinite(point->error));
  lab_pareto_destroy(&pareto);
}
END_TEST

START_TEST(a_scene_without_contact_is_refused) {
  LabPareto pareto = small();
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_int_eq(
      lab_pareto_scenes_measure(&pareto, TETLAP_SOURCE_DIR "/tests/scenes/cantilever.yaml", "clip", NULL, 0),
      STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "contact"));
  lab_pareto_destroy(&pareto);
}
END_TEST

static char directory[64];

static const char *place(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", directory, name);
  return path;
}

static void write_file(const char *name, const char *text) {
  FILE *file = fopen(place(name), "w");
  ck_assert_ptr_nonnull(file);
  fputs(text, file);
  fclose(file);
}

static const char config[] = "name: base\n"
                             "model: {kind: geo, features: 36, width: 4, depth: 1}\n"
                             "data:\n"
                             "  training: [{law: scene, mix: scene=1, count: 300, seed: 1}]\n"
                             "  validation: [{law: scene, mix: scene=1, count: 100, seed: 2}]\n"
                             "optimiser: {rate: 5e-3, batch: 64, samples: 2000}\n"
                             "validations: 1\n";

START_TEST(a_sweep_trains_what_is_missing_and_gives_networks_of_the_sizes) {
  AppSweep sweep;
  AppModelCard card;
  OverlapModel model = {.ops = NULL};
  write_file("geo.yaml", config);
  write_file("sizes",
             "# two widths\ngeo.yaml name=one model.width=4\n\ngeo.yaml  name=two model.width=8 # wider\n");
  ck_assert_ok(app_sweep_train(&sweep, directory, place("weights"), 1, NULL));
  ck_assert_int_eq(sweep.count, 2);
  const int widths[2] = {4, 8};
  for (int w = 0; w < 2; w++) {
    ck_assert_ok(overlap_model_create(&model, sweep.weights[w]));
    ck_assert_ok(app_evaluation_card_read(&model, sweep.weights[w], &card));
    ck_assert_int_eq(card.width, widths[w]);
    overlap_model_destroy(&model);
  }
  app_sweep_destroy(&sweep);
  // what is there is not trained again: it would be refused
  write_file("geo.yaml", "name: base\nmodel: {kind: geo, features: 36}\n"
                         "data: {training: [{file: none.h5}], validation: [{file: none.h5}]}\n"
                         "optimiser: {samples: 10}\n");
  ck_assert_ok(app_sweep_train(&sweep, directory, place("weights"), 1, NULL));
  ck_assert_int_eq(sweep.count, 2);
  app_sweep_destroy(&sweep);
}
END_TEST

START_TEST(tpn_can_be_wider_and_deeper_than_published) {
  static const char tpn[] = "name: base\n"
                            "model: {kind: tpn}\n"
                            "data:\n"
                            "  training: [{law: paper-train, mix: volumetric=1, count: 200, seed: 1}]\n"
                            "  validation: [{law: paper-test, mix: volumetric=1, count: 50, seed: 2}]\n"
                            "optimiser: {batch: 64, samples: 200}\n"
                            "validations: 1\n";
  AppSweep sweep;
  AppModelCard cards[3];
  write_file("tpn.yaml", tpn);
  write_file("sizes", "tpn.yaml name=published\ntpn.yaml name=half model.scale=0.5 model.layers=1\n"
                      "tpn.yaml name=deep model.layers=3\n");
  ck_assert_ok(app_sweep_train(&sweep, directory, place("weights"), 1, NULL));
  for (int w = 0; w < 3; w++) {
    LabPareto pareto = small();
    ck_assert_ok(lab_pareto_create(&pareto));
    ck_assert_ok(lab_pareto_add_model(&pareto, sweep.weights[w]));
    cards[w] = pareto.models[0].card;
    ck_assert_str_eq(cards[w].family, "tpn");
    lab_pareto_destroy(&pareto);
  }
  ck_assert_int_eq((int)cards[0].parameters, 73370);
  ck_assert_int_eq(cards[0].width, 96);
  ck_assert_int_eq(cards[1].width, 48);
  ck_assert_int_eq(cards[1].depth, 1);
  // a layer more in each block: 24 + 1, 48 + 1 and 96 + 1 numbers a neuron
  ck_assert_int_eq((int)cards[2].parameters, 73370 + 24 * 25 + 48 * 49 + 96 * 97);
  app_sweep_destroy(&sweep);
}
END_TEST

START_TEST(a_sweep_names_the_line_that_is_wrong) {
  AppSweep sweep;
  write_file("geo.yaml", config);
  write_file("sizes", "# one\n\ngeo.yaml name=one model.widht=4\n");
  ck_assert_int_eq(app_sweep_train(&sweep, directory, place("weights"), 1, NULL), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "sizes:3"));
  write_file("sizes", "# nothing\n");
  ck_assert_int_eq(app_sweep_train(&sweep, directory, place("weights"), 1, NULL), STATUS_INPUT);
}
END_TEST

static int run(const char *arguments) {
  char command[1024];
  snprintf(command, sizeof command, "cd '%s' && '%s' pareto %s >/dev/null 2>&1", TETLAP_SOURCE_DIR,
           TETLAP_LAB, arguments);
  int ended = system(command);
  return WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
}

START_TEST(the_command_writes_the_promised_keys) {
  char arguments[512], *text;
  size_t size;
  snprintf(
      arguments, sizeof arguments,
      "tests/scenes/collision.yaml --set time.end=0.03 --model clip,geo-small --pairs near -n 100 --batch 50 "
      "--repeat 1 --audit 5 -o %s",
      place("out"));
  ck_assert_int_eq(run(arguments), 0);
  ck_assert_ok(file_read(place("out/pareto.json"), &text, &size));
  static const char *const keys[] = {"format",
                                     "command",
                                     "versions",
                                     "processor",
                                     "simd",
                                     "peak_double_flops",
                                     "peak_float_flops",
                                     "threads",
                                     "repeats",
                                     "batch",
                                     "reference",
                                     "points",
                                     "comparisons",
                                     "model",
                                     "family",
                                     "quantity",
                                     "set",
                                     "features",
                                     "width",
                                     "depth",
                                     "parameters",
                                     "seconds_per_pair",
                                     "seconds_per_pair_min",
                                     "seconds_per_pair_max",
                                     "cpu_seconds_per_pair",
                                     "error",
                                     "error_median",
                                     "error_p90",
                                     "samples",
                                     "fallback_share",
                                     "frontier",
                                     "outcome",
                                     "seconds_per_step",
                                     "overlap_share",
                                     "amdahl_limit",
                                     "trajectory_error",
                                     "run_force_error",
                                     "steps",
                                     "rejected"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\":", keys[k]);
    ck_assert_msg(strstr(text, quoted) != NULL, "no %s", quoted);
  }
  memory_free(text);
  ck_assert_ok(file_read(place("out/pareto.csv"), &text, &size));
  int lines = 0;
  for (size_t i = 0; i < size; i++) lines += text[i] == '\n';
  ck_assert_int_eq(lines, 1 + 2 * 2 + 2); // names; two models, V and ∇V; two models, force
  memory_free(text);
  ck_assert_int_eq(access(place("out/pareto.svg.gp"), R_OK), 0);
}
END_TEST

START_TEST(wrong_arguments_are_usage_errors) {
  ck_assert_int_eq(run("--model clap"), 64);
  ck_assert_int_eq(run("--pairs disjoint"), 64);
  ck_assert_int_eq(run("--count 0"), 64);
  char arguments[512];
  snprintf(arguments, sizeof arguments, "--sweep /nowhere --model clip -o '%s'", directory);
  ck_assert_int_eq(run(arguments), 74);
}
END_TEST

// A second scene that is not there is told before the first is run, which would take hours.
START_TEST(all_scenes_are_opened_before_anything_is_measured) {
  ck_assert_int_eq(run("examples/02_two_blocks.yaml nowhere.yaml --model cgal -n 1000000 --wall 100000"), 74);
}
END_TEST

START_TEST(a_signal_ends_it) {
  volatile sig_atomic_t stop = 1;
  LabPareto pareto = small();
  pareto.stop = &stop;
  ck_assert_ok(lab_pareto_create(&pareto));
  ck_assert_ok(lab_pareto_add_model(&pareto, "clip"));
  ck_assert_int_eq(lab_pareto_pairs_measure(&pareto, "near"), STATUS_INTERRUPTED);
  ck_assert_int_eq(
      lab_pareto_scenes_measure(&pareto, TETLAP_SOURCE_DIR "/tests/scenes/collision.yaml", "clip", NULL, 0),
      STATUS_INTERRUPTED);
  ck_assert_int_eq((int)pareto.point_count, 0);
  lab_pareto_destroy(&pareto);
}
END_TEST

int main(void) {
  snprintf(directory, sizeof directory, "/tmp/tetlap_pareto_%ld", (long)getpid());
  if (file_make_directories(directory) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("pareto");
  tcase_add_test(cases, the_frontier_is_what_nothing_beats);
  tcase_add_test(cases, exact_has_no_error_clip_rounding_and_a_learned_model_its_own);
  tcase_add_test(cases, a_comparison_names_both_and_takes_its_ratio_within_a_round);
  tcase_add_test(cases, a_device_adds_points_of_the_models_that_have_kernels);
  tcase_add_test(cases, files_of_one_base_name_have_names_of_their_own);
  tcase_add_test(cases, models_of_one_name_are_refused);
  tcase_add_test(cases, a_scene_gives_forces_in_the_same_configurations_and_a_run_of_each_model);
  tcase_add_test(cases, a_weights_file_runs_a_scene_as_its_name_does);
  tcase_add_test(cases, a_run_that_takes_too_long_is_cut_short_and_still_a_point);
  tcase_add_test(cases, a_scene_without_contact_is_refused);
  tcase_add_test(cases, a_sweep_trains_what_is_missing_and_gives_networks_of_the_sizes);
  tcase_add_test(cases, tpn_can_be_wider_and_deeper_than_published);
  tcase_add_test(cases, a_sweep_names_the_line_that_is_wrong);
  tcase_add_test(cases, the_command_writes_the_promised_keys);
  tcase_add_test(cases, wrong_arguments_are_usage_errors);
  tcase_add_test(cases, all_scenes_are_opened_before_anything_is_measured);
  tcase_add_test(cases, a_signal_ends_it);
  int failed = suite_run("pareto", cases, 60);
  char command[128];
  snprintf(command, sizeof command, "rm -r '%s'", directory);
  return system(command) == 0 ? failed : EXIT_FAILURE;
}
