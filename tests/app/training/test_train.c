// SPDX-License-Identifier: GPL-3.0-or-later
// Training: that a loss has the gradient it claims, that a resumed training ends with the same bits, and that
// what was trained is better than what was not.
#include "pairs.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/evaluation/bounds.h"
#include "app/evaluation/evaluation.h"
#include "app/evaluation/model.h"
#include "app/training/geo/pool.h"
#include "app/training/geo/vectors.h"
#include "app/training/start.h"
#include "app/training/training.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "overlap/geo/geo.h"
#include "overlap/geo/network.h"
#include "overlap/models.h"
#include "overlap/weights.h"

static char directory[64];

static void make_directory(void) {
  snprintf(directory, sizeof directory, "/tmp/test_train_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static void remove_directory(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -r '%s'", directory);
  ck_assert_int_eq(system(command), 0);
}

static const char *path_in(const char *name) {
  static char paths[4][128];
  static int next;
  char *path = paths[next++ % 4];
  snprintf(path, sizeof paths[0], "%s/%s", directory, name);
  return path;
}

static void write_text(const char *path, const char *text) {
  FileWriter writer;
  ck_assert_ok(file_begin(&writer, path));
  fputs(text, writer.stream);
  ck_assert_ok(file_commit(&writer));
}

static const char geo_config[] =
    "name: t\n"
    "model: {kind: geo, features: 36, width: 8, depth: 1}\n"
    "data:\n"
    "  training: [{law: scene, mix: scene=1, count: 2000, seed: 11}]\n"
    "  validation: [{name: scene, law: scene, mix: scene=1, count: 300, seed: 12}]\n"
    "optimiser: {rate: 1e-2, batch: 100, samples: 40000}\n"
    "validations: 4\n";

static const char bound_config[] =
    "name: t-bound\n"
    "model: {kind: bound, of: geo-small, features: 56, width: 8, depth: 1}\n"
    "data:\n"
    "  training: [{law: scene, mix: scene=1, count: 4000, seed: 11}]\n"
    "  validation: [{name: scene, law: scene, mix: scene=1, count: 2000, seed: 12}]\n"
    "optimiser: {rate: 1e-2, batch: 100, samples: 40000}\n"
    "validations: 4\n";

static const char tpn_config[] = "name: t\n"
                                 "model: {kind: tpn, normalisation: pca}\n"
                                 "data:\n"
                                 "  training: [{law: paper-train, count: 2000, seed: 11}]\n"
                                 "  validation: [{name: paper, law: paper-test, count: 500, seed: 12}]\n"
                                 "optimiser: {rate: 1e-3, batch: 200, samples: 12000}\n"
                                 "validations: 3\n";

// Cuts fall on either side of where it is interrupted.
static const char published_config[] =
    "name: t\n"
    "model: {kind: tpn, reading: c, normalisation: unscaled}\n"
    "data:\n"
    "  training: [{law: paper-train, count: 2000, seed: 11}]\n"
    "  validation: [{name: paper, law: paper-test, count: 500, seed: 12}]\n"
    "optimiser: {rate: 1e-3, schedule: plateau, plateau_patience: 0, plateau_factor: 0.9, batch: 200, "
    "samples: 12000}\n"
    "validations: 12\n";

static const char sobolev_config[] = "name: t\n"
                                     "model: {kind: tpn, activation: silu, pool: sum, output_scale: 30}\n"
                                     "data:\n"
                                     "  training: [{law: scene, count: 2000, seed: 11}]\n"
                                     "  validation: [{name: scene, law: scene, count: 500, seed: 12}]\n"
                                     "loss: {sobolev: 5}\n"
                                     "optimiser: {rate: 1e-3, batch: 200, samples: 12000}\n"
                                     "validations: 3\n";

static AppTrainingConfig read_config(const char *text) {
  AppTrainingConfig config;
  write_text(path_in("train.yaml"), text);
  ck_assert_ok(app_training_config_read(path_in("train.yaml"), NULL, 0, &config));
  return config;
}

// Parameters are moved by ±1e-2 of their norm along a random direction; float carries six digits or so.
static void check_gradient(const char *text) {
  make_directory();
  AppTrainingConfig config = read_config(text);
  AppTrainingTask task = {.ops = app_training_task_find(config.model.kind), .config = &config};
  NetWhitening none = {0};
  ck_assert_ok(task.ops->create(&task, &none));
  NetShape shape = task.ops->shape(&config);
  NetModel_f32 model;
  NetWork_f32 work;
  NetWorkDef def = net_work_default();
  def.tangent_count = task.ops->tangents(&config);
  def.batch = config.optimiser.batch + task.ops->rows;
  ck_assert_int_eq(net_model_create_f32(&shape, &model), NET_OK);
  ck_assert_int_eq(net_work_create_f32(model.plan, &def, &work), NET_OK);
  net_model_initialise_f32(&model, 7);
  size_t count = model.plan->parameter_count;
  float *gradient = memory_zeroed(count, sizeof(float)), *other = memory_zeroed(count, sizeof(float)),
        *kept = memory_copy(model.parameters, count, sizeof(float));
  double loss = task.ops->step(&task, &model, &work, 3, gradient), size = 0, expected = 0;
  ck_assert(loss > 0);
  // along the gradient itself: the loss falls as fast as the gradient is long
  for (size_t i = 0; i < count; i++) size += (double)gradient[i] * (double)gradient[i];
  size = sqrt(size);
  double step = 2e-3 * loss / size, above, below;
  for (size_t i = 0; i < count; i++) model.parameters[i] = kept[i] + (float)(step / size) * gradient[i];
  above = task.ops->step(&task, &model, &work, 3, other);
  for (size_t i = 0; i < count; i++) model.parameters[i] = kept[i] - (float)(step / size) * gradient[i];
  below = task.ops->step(&task, &model, &work, 3, other);
  expected = (above - below) / (2 * step);
  ck_assert_near(size, expected, 0.01 * expected);
  memory_free(gradient), memory_free(other), memory_free(kept);
  net_work_destroy_f32(&work);
  net_model_destroy_f32(&model);
  task.ops->destroy(&task);
  app_training_config_destroy(&config);
  remove_directory();
}

START_TEST(gradient_of_the_geo_loss_is_that_of_the_loss) {
  check_gradient(geo_config);
}
END_TEST

START_TEST(gradient_of_the_tpn_loss_is_that_of_the_loss) {
  check_gradient(tpn_config);
}
END_TEST

START_TEST(gradient_of_the_tpn_loss_with_tangents_is_that_of_the_loss) {
  check_gradient(sobolev_config);
}
END_TEST

// Stops a training from its observer.
typedef struct Stopper {
  long long step;
  volatile sig_atomic_t flag;
} Stopper;

static void observe(void *observer, const AppTrainingProgress *progress) {
  Stopper *stopper = observer;
  if (progress->step == stopper->step) stopper->flag = 1;
}

static void read_parameters(const char *path, NetModel_f64 *model) {
  NetCard card;
  ck_assert_int_eq(net_weights_read_f64(path, model, &card), NET_OK);
  net_weights_card_destroy(&card);
}

static void check_same_weights(const char *a, const char *b) {
  NetModel_f64 first, second;
  read_parameters(a, &first);
  read_parameters(b, &second);
  ck_assert_mem_eq(first.parameters, second.parameters, first.plan->parameter_count * sizeof(double));
  net_model_destroy_f64(&first);
  net_model_destroy_f64(&second);
}

static Status train(const AppTrainingConfig *config, const char *where, int threads, bool resumes,
                    Stopper *stopper, AppTrainingResult *result) {
  AppTrainingOptions options = {.directory = where, .threads = threads, .resumes = resumes};
  if (stopper) options.stop = &stopper->flag, options.observe = observe, options.observer = stopper;
  return app_training_run(config, &options, result);
}

static void check_resume(const char *text, const char *name) {
  make_directory();
  char whole[80], parts[80], weights[2][128];
  snprintf(whole, sizeof whole, "%s/whole", directory);
  snprintf(parts, sizeof parts, "%s/parts", directory);
  snprintf(weights[0], sizeof weights[0], "%s/%s.safetensors", whole, name);
  snprintf(weights[1], sizeof weights[1], "%s/%s.safetensors", parts, name);
  AppTrainingConfig config = read_config(text);
  AppTrainingResult result;
  Stopper stopper = {.step = 37};
  ck_assert_ok(train(&config, whole, 1, false, NULL, &result));
  ck_assert_int_eq(train(&config, parts, 2, false, &stopper, &result), STATUS_INTERRUPTED);
  ck_assert_int_eq(result.step, 37);
  ck_assert_ok(train(&config, parts, 2, true, NULL, &result));
  ck_assert(result.best_step > 37);
  check_same_weights(weights[0], weights[1]);
  app_training_config_destroy(&config);
  remove_directory();
}

START_TEST(resumed_geo_training_ends_with_the_same_bits) {
  check_resume(geo_config, "t");
}
END_TEST

START_TEST(resumed_tpn_training_ends_with_the_same_bits) {
  check_resume(tpn_config, "t");
}
END_TEST

START_TEST(resumed_training_on_a_plateau_ends_with_the_same_bits) {
  check_resume(published_config, "t");
}
END_TEST

START_TEST(checkpoint_of_another_configuration_is_refused) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  AppTrainingResult result;
  Stopper stopper = {.step = 5};
  ck_assert_int_eq(train(&config, directory, 1, false, &stopper, &result), STATUS_INTERRUPTED);
  config.loss.huber = 0.2;
  ck_assert_int_eq(train(&config, directory, 1, true, NULL, &result), STATUS_INPUT);
  ck_assert(strstr(status_message(), "huber 0.1"));
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

static Status train_over(const AppTrainingConfig *config, bool replaces) {
  AppTrainingResult result;
  AppTrainingOptions options = {.directory = directory, .threads = 1, .replaces = replaces};
  return app_training_run(config, &options, &result);
}

// What a training of this configuration would write over, and leaves as it is.
static void check_kept(const AppTrainingConfig *config, const char *name) {
  char *before, *after;
  size_t size, size_after;
  ck_assert_ok(file_read(path_in(name), &before, &size));
  ck_assert_int_eq(train_over(config, false), STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), name));
  ck_assert_ptr_nonnull(strstr(status_message(), "--force"));
  ck_assert_ok(file_read(path_in(name), &after, &size_after));
  ck_assert_uint_eq(size, size_after);
  ck_assert_int_eq(memcmp(before, after, size), 0);
  memory_free(before), memory_free(after);
}

START_TEST(training_writes_over_its_own_files_alone) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  config.optimiser.samples = 2000, config.validations = 1;
  ck_assert_ok(train_over(&config, false));
  ck_assert_ok(train_over(&config, false)); // the same training once more
  config.seed++;
  check_kept(&config, "t.safetensors"); // of another seed
  ck_assert_int_eq(remove(path_in("t.safetensors")), 0);
  check_kept(&config, "checkpoint.safetensors");
  ck_assert_int_eq(remove(path_in("checkpoint.safetensors")), 0);
  ck_assert_int_eq(remove(path_in("config.yaml")), 0);
  check_kept(&config, "log.csv");
  ck_assert_ok(train_over(&config, true));
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

// A bound, or a network that begins from another one, by the name of the file that it reads.
START_TEST(training_never_writes_over_the_network_that_it_reads) {
  make_directory();
  char command[256], network[4096];
  ck_assert_ok(overlap_weights_find("geo-small", network, sizeof network));
  snprintf(command, sizeof command, "cp '%.150s' '%s'", network, path_in("t-bound.safetensors"));
  ck_assert_int_eq(system(command), 0);
  AppTrainingConfig config = read_config(bound_config);
  memory_free(config.model.of);
  config.model.of =
      memory_copy(path_in("t-bound.safetensors"), strlen(path_in("t-bound.safetensors")) + 1, 1);
  ck_assert_int_eq(train_over(&config, true), STATUS_USAGE);
  ck_assert_ptr_nonnull(strstr(status_message(), "model.of"));
  snprintf(command, sizeof command, "cmp '%.150s' '%s'", network, path_in("t-bound.safetensors"));
  ck_assert_int_eq(system(command), 0);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

START_TEST(a_refused_training_leaves_no_folder) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  AppTrainingResult result;
  memory_free(config.start);
  config.start = memory_copy("goe", 4, 1);
  char home[80];
  snprintf(home, sizeof home, "%s/new/home", directory);
  ck_assert(train(&config, home, 1, false, NULL, &result) != STATUS_OK);
  ck_assert(!file_exists(path_in("new")));
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

static AppEvaluation evaluate(const char *model_name) {
  AppSourceDef def = {.law = "scene", .count = 1000, .seed = 77};
  DatagenPairs pairs;
  size_t count;
  OverlapModel model;
  AppEvaluationRun run;
  AppEvaluation result;
  ck_assert_ok(app_dataset_source_load(&def, &pairs, &count));
  ck_assert_ok(app_evaluation_model_open(&model, model_name));
  app_evaluation_begin(&run, &model, NULL);
  ck_assert_ok(app_evaluation_add(&run, &pairs, count));
  app_evaluation_finish(&run, &result);
  app_evaluation_end(&run);
  overlap_model_destroy(&model);
  datagen_pairs_destroy(&pairs);
  return result;
}

START_TEST(trained_network_is_far_better_than_none) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  AppTrainingResult result;
  ck_assert_ok(train(&config, directory, 2, false, NULL, &result));
  AppEvaluation none = evaluate("geo-constant"), trained = evaluate(path_in("t.safetensors"));
  ck_assert(trained.volume_error_sum < 0.2 * none.volume_error_sum);
  ck_assert(trained.gradient_error < 0.5 * none.gradient_error);
  ck_assert(trained.ghost_volume == 0 && trained.ghost_gradient == 0);
  ck_assert(trained.defect_vertex_order < 1e-9 && trained.defect_swap < 1e-9);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

// The bound, made beside its network, serves hybrid, and holds of other pairs for the share that was asked.
START_TEST(trained_bound_holds_of_other_pairs) {
  make_directory();
  char command[256], network[4096];
  AppTrainingConfig config = read_config(bound_config);
  AppTrainingResult result;
  ck_assert_ok(train(&config, directory, 2, false, NULL, &result));
  ck_assert_ok(overlap_weights_find("geo-small", network, sizeof network));
  snprintf(command, sizeof command, "cp '%.150s' '%s'", network, path_in("t.safetensors"));
  ck_assert_int_eq(system(command), 0);
  OverlapModel hybrid;
  ck_assert_ok(overlap_models_create_with(&hybrid, "hybrid", path_in("t.safetensors"), NULL));
  DatagenPairs pairs;
  size_t count;
  AppSourceDef def = {.law = "scene", .mix = "scene=1", .count = 4000, .seed = 13};
  ck_assert_ok(app_dataset_source_load(&def, &pairs, &count));
  AppEvaluationBoundsRun run = {0};
  ck_assert_ok(app_evaluation_bounds_add(&run, &hybrid, &pairs, count));
  AppEvaluationBounds bounds = app_evaluation_bounds_finish(&run);
  ck_assert_near(bounds.coverage, 0.95, 0.02);
  ck_assert(bounds.width_median < bounds.error_p95); // it tells pairs apart: a constant would be the latter
  app_evaluation_bounds_end(&run);
  datagen_pairs_destroy(&pairs);
  overlap_model_destroy(&hybrid);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

START_TEST(resumed_bound_training_ends_with_the_same_bits) {
  check_resume(bound_config, "t-bound");
}
END_TEST

START_TEST(fine_tuning_begins_where_shipped_weights_ended) {
  make_directory();
  AppTrainingConfig config = read_config("name: t\n"
                                         "start: geo-small\n"
                                         "model: {kind: geo, features: 56, width: 16, depth: 2}\n"
                                         "data:\n"
                                         "  training: [{law: scene, mix: scene=1, count: 2000, seed: 11}]\n"
                                         "  validation: [{law: scene, mix: scene=1, count: 300, seed: 12}]\n"
                                         "optimiser: {rate: 1e-5, batch: 100, samples: 2000}\n"
                                         "validations: 1\n");
  AppTrainingResult result;
  ck_assert_ok(train(&config, directory, 1, false, NULL, &result));
  AppEvaluation shipped = evaluate("geo-small"), tuned = evaluate(path_in("t.safetensors"));
  ck_assert_near(tuned.gradient_error, shipped.gradient_error, 0.05 * shipped.gradient_error);
  memory_free(config.start);
  config.start = memory_copy("goe", 4, 1);
  ck_assert(train(&config, path_in("other"), 1, false, NULL, &result) != STATUS_OK);
  ck_assert(strstr(status_message(), "goe"));
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

static void check_start(const char *text, const char *const *words) {
  AppTrainingConfig config = read_config(text);
  AppTrainingResult result;
  ck_assert_int_eq(train(&config, directory, 1, false, NULL, &result), STATUS_INPUT);
  for (; *words; words++)
    ck_assert_msg(strstr(status_message(), *words) != NULL, "'%s' does not say '%s'", status_message(),
                  *words);
  app_training_config_destroy(&config);
}

#define SMALL_DATA                                                                                           \
  "data:\n  training: [{law: scene, mix: scene=1, count: 200, seed: 11}]\n"                                  \
  "  validation: [{law: scene, mix: scene=1, count: 100, seed: 12}]\noptimiser: {samples: 1000}\n"

START_TEST(a_start_of_another_shape_is_refused_with_both_shapes) {
  make_directory();
  check_start("name: t\nstart: geo-small\nmodel: {kind: geo, features: 36, width: 8, depth: 1}\n" SMALL_DATA,
              (const char *const[]){"56 inputs, hidden layers 16 16,", "36 inputs, hidden layers 8,",
                                    "'inputs' is 56 in the file and 36 by `model`", NULL});
  check_start("name: t\nstart: geo-small\nmodel: {kind: tpn}\n" SMALL_DATA,
              (const char *const[]){"mlp: 56 inputs", "tpn: 24 inputs", "73370 parameters", NULL});
  check_start("name: t\nstart: tpn\nmodel: {kind: tpn, pool: sum, activation: silu, scale: 2}\n" SMALL_DATA,
              (const char *const[]){"the file has tpn: 24 inputs", "'activation' is", NULL});
  remove_directory();
}
END_TEST

static void keep_summary(void *observer, const char *text) {
  if (strstr(text, "to train on")) snprintf(observer, 512, "%s", text);
}

static void summarise(const char *text, char summary[512]) {
  AppTrainingConfig config = read_config(text);
  AppTrainingResult result;
  AppTrainingOptions options = {
      .directory = directory, .threads = 1, .replaces = true, .tell = keep_summary, .observer = summary};
  ck_assert_ok(app_training_run(&config, &options, &result));
  app_training_config_destroy(&config);
}

// 200 uniform pairs are mostly apart.
START_TEST(pairs_that_are_left_out_are_told_with_the_reason) {
  make_directory();
  char summary[512];
  int kept, left_out, apart;
  summarise("name: t\nmodel: {kind: geo, features: 36, width: 4, depth: 1}\ndata:\n"
            "  training: [{law: paper-train, count: 300, seed: 11}]\n"
            "  validation: [{law: scene, mix: scene=1, count: 100, seed: 12}]\n"
            "optimiser: {batch: 10, samples: 20}\nvalidations: 1\n",
            summary);
  ck_assert_msg(
      sscanf(summary, "%d pairs to train on; %d left out: %d share no volume", &kept, &left_out, &apart) == 3,
      "%s", summary);
  ck_assert_int_eq(kept + left_out, 300);
  ck_assert(apart > 0 && apart <= left_out);
  summarise("name: t\nmodel: {kind: tpn}\ndata:\n"
            "  training: [{law: paper-train, count: 300, seed: 11}]\n"
            "  validation: [{law: scene, mix: scene=1, count: 100, seed: 12}]\n"
            "optimiser: {batch: 10, samples: 20}\nvalidations: 1\n",
            summary);
  ck_assert_str_eq(summary, "300 pairs to train on");
  remove_directory();
}
END_TEST

START_TEST(training_stops_when_it_gets_no_better) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  AppTrainingResult result;
  config.optimiser.rate = 1e-30; // nothing changes, so no score is better than the first
  config.validations = 40;
  config.patience = 3;
  ck_assert_ok(train(&config, directory, 1, false, NULL, &result));
  ck_assert(result.has_stopped_early);
  ck_assert_int_eq(result.best_step, 10);
  ck_assert_int_eq(result.step, 40);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

START_TEST(weights_brought_over_to_another_whitening_are_the_same_function) {
  make_directory();
  AppTrainingConfig config = read_config(geo_config);
  AppTrainingResult result;
  config.optimiser.samples = 2000;
  ck_assert_ok(train(&config, directory, 1, false, NULL, &result));
  size_t count;
  DatagenPairs pairs = load_pairs(300, &count);
  AppTrainingPool pool;
  NetWhitening none = {0};
  ck_assert_ok(app_training_pool_create(&pool, overlap_geo_features_set(36), &pairs, count, &none));
  AppTrainingVectors vectors;
  ck_assert_ok(app_training_vectors_create(&vectors, overlap_geo_features_set(36), &pairs, count));
  NetShape shape = app_training_geo.shape(&config);
  ck_assert_int_eq(shape.output_count, 1 + vectors.vector_count);
  NetModel_f32 model;
  NetModel_f64 folded, file;
  ck_assert_int_eq(net_model_create_f32(&shape, &model), NET_OK);
  ck_assert_int_eq(net_model_create_f64(&shape, &folded), NET_OK);
  ck_assert_ok(app_training_start_read(path_in("t.safetensors"), OVERLAP_GEO_NORMALISATION, &pool.whitening,
                                       &vectors.whitening, &model));
  net_model_widen(&model, &folded);
  ck_assert_int_eq(net_whitening_fold(&pool.whitening, &folded), NET_OK);
  app_training_vectors_fold(&vectors.whitening, &folded);
  read_parameters(path_in("t.safetensors"), &file);
  NetWork_f64 work;
  NetWorkDef def = net_work_default();
  ck_assert_int_eq(net_work_create_f64(file.plan, &def, &work), NET_OK);
  for (size_t n = 0; n < count; n++) {
    double features[36], unused, expected[NET_MAX_OUTPUTS], found[NET_MAX_OUTPUTS];
    if (overlap_geo_features_tangent(pool.set, pairs.coordinates + 24 * n, 0, NULL, features, NULL, &unused,
                                     NULL) != OVERLAP_GEO_INSIDE)
      continue;
    net_forward_eval_f64(&work, &file, 1, features, expected);
    net_forward_eval_f64(&work, &folded, 1, features, found);
    // coefficients of nearly the same vectors cancel: single precision leaves less of them than of ρ
    for (int o = 0; o < shape.output_count; o++)
      ck_assert_near(found[o], expected[o], (o ? 1e-2 : 1e-4) * (1 + fabs(expected[o])));
  }
  net_work_destroy_f64(&work);
  net_model_destroy_f64(&file), net_model_destroy_f64(&folded), net_model_destroy_f32(&model);
  app_training_pool_destroy(&pool);
  app_training_vectors_destroy(&vectors);
  datagen_pairs_destroy(&pairs);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

static void check_refusal(const char *text, const char *word) {
  AppTrainingConfig config;
  write_text(path_in("bad.yaml"), text);
  ck_assert_int_eq(app_training_config_read(path_in("bad.yaml"), NULL, 0, &config), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), word) != NULL, "'%s' does not say '%s'", status_message(), word);
}

// The same pairs, those that were exchanged marked in `is_exchanged`.
static int count_exchanged(const DatagenPairs *given, const DatagenPairs *pairs, size_t count) {
  int exchanged = 0;
  for (size_t i = 0; i < count; i++) {
    const double *a = given->coordinates + 24 * i, *b = pairs->coordinates + 24 * i;
    bool is_same = memcmp(a, b, 24 * sizeof *a) == 0;
    bool is_exchanged = memcmp(a, b + 12, 12 * sizeof *a) == 0 && memcmp(a + 12, b, 12 * sizeof *a) == 0;
    ck_assert(is_same != is_exchanged);
    ck_assert_int_eq(pairs->kind[i], given->kind[i]);
    ck_assert_near(pairs->volume[i], given->volume[i], 1e-12);
    exchanged += is_exchanged;
  }
  return exchanged;
}

START_TEST(a_source_exchanges_the_share_of_pairs_that_it_is_told) {
  make_directory();
  const char *path = path_in("swap.yaml");
  write_text(path, "name: t\nmodel: {kind: tpn}\ndata:\n"
                   "  training: [{law: paper-train, count: 400, swap: 0.5},\n"
                   "             {law: paper-train, count: 400, swap: 1}, {law: paper-train, count: 400}]\n"
                   "  validation: [{law: paper-test, count: 100}]\noptimiser: {samples: 1}\n");
  AppTrainingConfig config;
  ck_assert_ok(app_training_config_read(path, NULL, 0, &config));
  DatagenPairs pairs[3];
  size_t count;
  for (int s = 0; s < 3; s++) {
    AppSourceDef def = app_training_config_source(&config.training[s]);
    ck_assert_ok(app_dataset_source_load(&def, &pairs[s], &count));
    ck_assert_int_eq((int)count, 400);
  }
  int half = count_exchanged(&pairs[2], &pairs[0], count);
  ck_assert(half > 160 && half < 240); // four standard deviations
  ck_assert_int_eq(count_exchanged(&pairs[2], &pairs[1], count), 400);
  for (int s = 0; s < 3; s++) datagen_pairs_destroy(&pairs[s]);
  app_training_config_destroy(&config);
  remove_directory();
}
END_TEST

START_TEST(wrong_configurations_are_refused_by_name) {
  make_directory();
  check_refusal("name: t\n", "model");
  check_refusal("name: t\nmodel: {kind: gio}\n", "geo");
  check_refusal("name: t\nmodel: {kind: geo, features: 37}\n", "36, 56, 70, 100, 120");
  check_refusal("name: t\nmodel: {kind: geo, width: 0}\n", "width");
  check_refusal("name: t\nmodel: {kind: geo}\ndata: {training: [{law: scene, file: x}]}\n", "file");
  check_refusal("name: t\nmodel: {kind: geo}\ndata: {training: [{law: scene, swap: 2}]}\n", "swap");
  check_refusal("name: t\nmodel: {kind: geo}\ndata: {training: [{file: x, swap: 1}]}\n", "swap");
  check_refusal("name: t\nmodel: {kind: tpn, normalisation: pca}\n"
                "data: {training: [{law: scene}], validation: [{law: scene}]}\n"
                "loss: {sobolev: 1}\noptimiser: {samples: 1}\n",
                "normalisation: unit");
  check_refusal("name: t\nmodel: {kind: tpn, reading: c, normalisation: pca}\n"
                "data: {training: [{law: scene}], validation: [{law: scene}]}\noptimiser: {samples: 1}\n",
                "second tetrahedron alone");
  check_refusal("name: t\nmodle: {kind: geo}\n", "model");
  remove_directory();
}
END_TEST

START_TEST(shipped_configurations_are_read) {
  static const char *const names[] = {"geo",   "geo-bound", "geo-small",     "geo-small-bound",
                                      "smoke", "tpn",       "tpn-published", "tpn-scene"};
  for (int n = 0; n < 8; n++) {
    char path[256];
    AppTrainingConfig config;
    snprintf(path, sizeof path, TETLAP_SOURCE_DIR "/examples/train/%s.yaml", names[n]);
    ck_assert_ok(app_training_config_read(path, NULL, 0, &config));
    ck_assert_str_eq(config.name, names[n]);
    app_training_config_destroy(&config);
  }
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("train");
  tcase_add_test(test_case, gradient_of_the_geo_loss_is_that_of_the_loss);
  tcase_add_test(test_case, gradient_of_the_tpn_loss_is_that_of_the_loss);
  tcase_add_test(test_case, gradient_of_the_tpn_loss_with_tangents_is_that_of_the_loss);
  tcase_add_test(test_case, resumed_geo_training_ends_with_the_same_bits);
  tcase_add_test(test_case, resumed_tpn_training_ends_with_the_same_bits);
  tcase_add_test(test_case, resumed_training_on_a_plateau_ends_with_the_same_bits);
  tcase_add_test(test_case, checkpoint_of_another_configuration_is_refused);
  tcase_add_test(test_case, trained_network_is_far_better_than_none);
  tcase_add_test(test_case, trained_bound_holds_of_other_pairs);
  tcase_add_test(test_case, training_writes_over_its_own_files_alone);
  tcase_add_test(test_case, training_never_writes_over_the_network_that_it_reads);
  tcase_add_test(test_case, a_refused_training_leaves_no_folder);
  tcase_add_test(test_case, resumed_bound_training_ends_with_the_same_bits);
  tcase_add_test(test_case, fine_tuning_begins_where_shipped_weights_ended);
  tcase_add_test(test_case, a_start_of_another_shape_is_refused_with_both_shapes);
  tcase_add_test(test_case, pairs_that_are_left_out_are_told_with_the_reason);
  tcase_add_test(test_case, training_stops_when_it_gets_no_better);
  tcase_add_test(test_case, weights_brought_over_to_another_whitening_are_the_same_function);
  tcase_add_test(test_case, wrong_configurations_are_refused_by_name);
  tcase_add_test(test_case, a_source_exchanges_the_share_of_pairs_that_it_is_told);
  tcase_add_test(test_case, shipped_configurations_are_read);
  return suite_run("train", test_case, 60);
}
