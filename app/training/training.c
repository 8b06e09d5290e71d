// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/training.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "app/cli/versions.h"
#include "app/training/guard.h"
#include "app/training/log.h"
#include "base/files/file.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "datagen/law/plan.h"

enum { MOST_SKIPPED = 100 }; // steps in a row whose gradient was not finite

// What a checkpoint keeps in its note, beside the configuration.
typedef struct Counts {
  long long step, best_step;
  int stale;                 // validations since the best
  double seconds;            // spent
  double loss_sum, norm_sum; // since the last validation
  long long loss_count;
} Counts;

typedef struct Training {
  const AppTrainingConfig *config;
  const AppTrainingOptions *options;
  AppTrainingTask task;
  NetModel_f32 model;
  NetAdam_f32 adam;
  NetWork_f32 work;
  NetSchedule schedule;
  NetPlateau plateau;
  AppTrainingLog log;
  float *gradient, *best; // (parameter_count)
  double best_score, score;
  Counts counts;
  double began_s;                         // wall clock, less what was spent before
  int skipped;                            // in a row
  double loss;                            // mean before the last validation
  char *description;                      // of the configuration, owned
  char *weights, *candidate, *checkpoint; // paths, owned
} Training;

static void report_line(const Training *training, const char *text) {
  if (training->options->tell) training->options->tell(training->options->observer, text);
}

static void destroy(Training *training) {
  if (training->task.ops) training->task.ops->destroy(&training->task);
  net_work_destroy_f32(&training->work);
  net_adam_destroy_f32(&training->adam);
  net_model_destroy_f32(&training->model);
  app_training_log_close(&training->log);
  memory_free(training->gradient), memory_free(training->best), memory_free(training->description);
  memory_free(training->weights), memory_free(training->candidate), memory_free(training->checkpoint);
}

static NetSchedule schedule_of(const AppTrainingConfig *config) {
  const AppTrainingOptimiserDef *def = &config->optimiser;
  int64_t steps = (int64_t)ceil(def->samples / def->batch);
  return (NetSchedule){.peak = def->rate,
                       .final = def->final_rate,
                       .warmup_steps = (int64_t)(def->warmup * (double)steps),
                       .total_steps = steps};
}

// The rate of a step.
static double rate_of(const Training *training, long long step) {
  const NetSchedule *schedule = &training->schedule;
  bool is_warm = step >= schedule->warmup_steps;
  if (is_warm && training->config->optimiser.schedule == APP_SCHEDULE_PLATEAU)
    return net_plateau_rate(&training->plateau, schedule->peak, schedule->final);
  return net_schedule_rate(schedule, step);
}

bool app_training_has_checkpoint(const char *directory) {
  char *path = file_join(directory, APP_TRAINING_CHECKPOINT);
  bool is_there = path && file_exists(path);
  memory_free(path);
  return is_there;
}

static Status name_files(Training *training) {
  const char *directory = training->options->directory;
  char name[256];
  snprintf(name, sizeof name, "%s.safetensors", training->config->name);
  training->weights = file_join(directory, name);
  training->candidate = file_join(directory, "candidate.safetensors");
  training->checkpoint = file_join(directory, APP_TRAINING_CHECKPOINT);
  training->description = app_training_config_print(training->config);
  bool fits = training->weights && training->candidate && training->checkpoint && training->description;
  return fits ? STATUS_OK : status_no_memory("a training");
}

static Status copy_config(const Training *training) {
  char *path = file_join(training->options->directory, "config.yaml");
  if (!path) return status_no_memory("a training");
  FileWriter writer;
  Status status = file_begin(&writer, path);
  if (!status) {
    fputs(training->config->text, writer.stream);
    status = file_commit(&writer);
  }
  memory_free(path);
  return status;
}

static Status create_network(Training *training) {
  const AppTrainingOptimiserDef *def = &training->config->optimiser;
  NetShape shape = training->task.ops->shape(training->config);
  TRY(app_training_task_fail(net_model_create_f32(&shape, &training->model)));
  net_model_initialise_f32(&training->model, (uint64_t)training->config->seed);
  size_t count = training->model.plan->parameter_count;
  NetAdamDef adam = net_adam_default();
  adam.beta1 = def->beta1;
  adam.beta2 = def->beta2;
  adam.weight_decay = def->weight_decay;
  TRY(app_training_task_fail(net_adam_create_f32(count, &adam, &training->adam)));
  training->gradient = memory_zeroed(count, sizeof(float));
  training->best = memory_copy(training->model.parameters, count, sizeof(float));
  if (!training->gradient || !training->best) return status_no_memory("a training");
  NetWorkDef work = net_work_default();
  work.thread_count = training->options->threads;
  work.tangent_count = training->task.ops->tangents ? training->task.ops->tangents(training->config) : 0;
  work.batch = def->batch + training->task.ops->rows;
  return app_training_task_fail(net_work_create_f32(training->model.plan, &work, &training->work));
}

static void print_note(const Training *training, char *note, size_t size) {
  const Counts *counts = &training->counts;
  const NetPlateau *plateau = &training->plateau;
  snprintf(note, size,
           "step %lld best_step %lld stale %d seconds %.3f loss %.17g norm %.17g over %lld plateau %.17g "
           "stale %d cuts %d\n%s",
           counts->step, counts->best_step, counts->stale, counts->seconds, counts->loss_sum,
           counts->norm_sum, counts->loss_count, plateau->best, plateau->stale, plateau->cuts,
           training->description);
}

static Status parse_note(Training *training, const char *note) {
  Counts *counts = &training->counts;
  const char *rest = strchr(note, '\n');
  NetPlateau *plateau = &training->plateau;
  if (!rest ||
      sscanf(note,
             "step %lld best_step %lld stale %d seconds %lf loss %lf norm %lf over %lld plateau %lf stale %d "
             "cuts %d",
             &counts->step, &counts->best_step, &counts->stale, &counts->seconds, &counts->loss_sum,
             &counts->norm_sum, &counts->loss_count, &plateau->best, &plateau->stale, &plateau->cuts) != 10)
    return status_fail(STATUS_INPUT, "%s: its note is not one of `tetlap train`", training->checkpoint);
  if (strcmp(rest + 1, training->description) != 0)
    return status_fail(STATUS_INPUT,
                       "%s: of another configuration; resume with its own, or train in another directory. "
                       "Its configuration is:\n%s",
                       training->checkpoint, rest + 1);
  return STATUS_OK;
}

static Status write_checkpoint(Training *training) {
  size_t size = strlen(training->description) + 512;
  char *note = memory_zeroed(size, 1);
  if (!note) return status_no_memory("a checkpoint");
  training->counts.seconds = clock_wall_s() - training->began_s;
  print_note(training, note, size);
  NetCheckpoint_f32 checkpoint = {.model = &training->model,
                                  .adam = &training->adam,
                                  .best = training->best,
                                  .best_score = training->best_score,
                                  .schedule = training->schedule,
                                  .random = net_random_seeded((uint64_t)training->config->seed, 0),
                                  .note = note};
  const AppTrainingTask *task = &training->task;
  if (task->ops->whitening) checkpoint.whitening = *task->ops->whitening(task);
  Status status = app_training_task_fail(net_checkpoint_write_f32(training->checkpoint, &checkpoint));
  memory_free(note);
  return status;
}

// Reads the checkpoint into the network; its whitening is the caller's to release.
static Status read_checkpoint(Training *training, NetCheckpoint_f32 *checkpoint) {
  *checkpoint =
      (NetCheckpoint_f32){.model = &training->model, .adam = &training->adam, .best = training->best};
  TRY(app_training_task_fail(net_checkpoint_read_f32(training->checkpoint, checkpoint)));
  training->best_score = checkpoint->best_score;
  Status status = parse_note(training, checkpoint->note);
  if (status) net_checkpoint_release_f32(checkpoint);
  return status;
}

static Status load_task(Training *training, const NetWhitening *whitening) {
  report_line(training, "making the data");
  TRY(training->task.ops->create(&training->task, whitening));
  report_line(training, training->task.summary);
  return STATUS_OK;
}

static Status resume(Training *training) {
  NetCheckpoint_f32 checkpoint;
  TRY(read_checkpoint(training, &checkpoint));
  Status status = load_task(training, &checkpoint.whitening);
  net_checkpoint_release_f32(&checkpoint);
  TRY(status);
  char text[128];
  snprintf(text, sizeof text, "resumed at step %lld of %lld", training->counts.step,
           (long long)training->schedule.total_steps);
  report_line(training, text);
  return app_training_log_open(&training->log, training->options->directory, training->counts.step);
}

static Status begin(Training *training) {
  NetWhitening none = {0};
  TRY(load_task(training, &none));
  if (training->config->start) TRY(training->task.ops->start(&training->task, &training->model));
  return app_training_log_open(&training->log, training->options->directory, -1);
}

// A checkpoint that is resumed from is compared when it is read.
static Status guard_files(const Training *training, bool resumes) {
  TRY(app_training_guard_inputs(training->config, training->weights));
  if (resumes || training->options->replaces) return STATUS_OK;
  return app_training_guard_files(training->config, training->description, training->options->directory,
                                  training->weights);
}

static Status prepare(Training *training) {
  training->schedule = schedule_of(training->config);
  training->best_score = INFINITY;
  training->score = NAN;
  training->plateau = (NetPlateau){.factor = training->config->optimiser.plateau_factor,
                                   .patience = training->config->optimiser.plateau_patience,
                                   .best = INFINITY};
  training->task = (AppTrainingTask){.config = training->config,
                                     .ops = app_training_task_find(training->config->model.kind)};
  TRY(name_files(training));
  bool resumes = training->options->resumes && file_exists(training->checkpoint);
  TRY(guard_files(training, resumes));
  TRY(create_network(training));
  TRY(resumes ? resume(training) : begin(training));
  TRY(file_make_directories(training->options->directory));
  TRY(copy_config(training));
  training->began_s = clock_wall_s() - training->counts.seconds;
  return STATUS_OK;
}

static Status write_best(Training *training) {
  char date[32], *story;
  time_t now = time(NULL);
  struct tm utc;
  gmtime_r(&now, &utc);
  strftime(date, sizeof date, "%Y-%m-%d", &utc);
  size_t size = strlen(training->description) + 1024;
  story = memory_zeroed(size, 1);
  if (!story) return status_no_memory("the weights' provenance");
  const Counts *counts = &training->counts;
  double batch = training->config->optimiser.batch;
  snprintf(story, size,
           "%s by tetlap %s, %s, pair generator %d; %s; best of step %lld (%.0f samples), score %.6g, after "
           "%.0f s with %d threads\n%s",
           training->config->name, app_versions_program(), date, DATAGEN_GENERATOR_VERSION,
           training->task.summary, counts->best_step, (double)counts->best_step * batch, training->best_score,
           clock_wall_s() - training->began_s, training->options->threads, training->description);
  Status status = training->task.ops->write(&training->task, &training->model, story, training->weights);
  memory_free(story);
  return status;
}

static Status keep_if_better(Training *training, double score) {
  training->score = score;
  if (!(score < training->best_score)) {
    training->counts.stale++;
    return STATUS_OK;
  }
  training->best_score = score;
  training->counts.stale = 0;
  training->counts.best_step = training->counts.step;
  memcpy(training->best, training->model.parameters, training->model.plan->parameter_count * sizeof(float));
  return write_best(training);
}

static Status validate(Training *training) {
  AppTrainingScores scores = {0};
  Counts *counts = &training->counts;
  Status status =
      training->task.ops->validate(&training->task, &training->model, training->candidate, &scores);
  remove(training->candidate);
  TRY(status);
  double count = (double)(counts->loss_count > 0 ? counts->loss_count : 1);
  AppTrainingRow row = {.step = counts->step,
                        .samples = (double)counts->step * training->config->optimiser.batch,
                        .seconds = clock_wall_s() - training->began_s,
                        .rate = rate_of(training, counts->step - 1),
                        .loss = counts->loss_sum / count,
                        .gradient_norm = counts->norm_sum / count,
                        .scores = &scores};
  TRY(app_training_log_add(&training->log, &row));
  training->loss = row.loss;
  counts->loss_sum = counts->norm_sum = 0;
  counts->loss_count = 0;
  net_plateau_add(&training->plateau, scores.score);
  TRY(keep_if_better(training, scores.score));
  return write_checkpoint(training);
}

static Status take_step(Training *training) {
  Counts *counts = &training->counts;
  size_t size = training->model.plan->parameter_count;
  double loss = training->task.ops->step(&training->task, &training->model, &training->work, counts->step,
                                         training->gradient);
  double norm = net_adam_clip_f32(size, training->config->optimiser.clip, training->gradient);
  if (isfinite(loss) && isfinite(norm)) {
    net_adam_step_f32(&training->adam, rate_of(training, counts->step), training->gradient,
                      training->model.parameters);
    counts->loss_sum += loss;
    counts->norm_sum += norm;
    counts->loss_count++;
    training->skipped = 0;
  } else if (++training->skipped == MOST_SKIPPED) {
    return status_fail(STATUS_SOLVER,
                       "the loss or its gradient is not finite in %d steps running, up to step %lld; lower "
                       "optimiser.rate",
                       MOST_SKIPPED, counts->step);
  }
  counts->step++;
  return STATUS_OK;
}

static void report_progress(const Training *training, double first_step) {
  if (!training->options->observe) return;
  const Counts *counts = &training->counts;
  double spent = clock_wall_s() - training->began_s - counts->seconds;
  double done = (double)counts->step - first_step, batch = training->config->optimiser.batch;
  double rate = spent > 0 ? done / spent : 0;
  AppTrainingProgress progress = {
      .step = counts->step,
      .step_count = training->schedule.total_steps,
      .samples = batch * (double)counts->step,
      .samples_per_s = batch * rate,
      .seconds_left = rate > 0 ? ((double)training->schedule.total_steps - (double)counts->step) / rate : 0,
      .loss = counts->loss_count ? counts->loss_sum / (double)counts->loss_count : training->loss,
      .score = training->score,
      .best_score = training->best_score};
  training->options->observe(training->options->observer, &progress);
}

// Validations are after the first steps of every one of `validations` equal parts, the last after the last.
static bool is_validation(const Training *training) {
  long long step = training->counts.step, total = training->schedule.total_steps,
            parts = training->config->validations;
  return step == total || step * parts / total != (step - 1) * parts / total;
}

static Status run_steps(Training *training, AppTrainingResult *result) {
  const AppTrainingOptions *options = training->options;
  double first_step = (double)training->counts.step, spent_before = training->counts.seconds;
  while (training->counts.step < training->schedule.total_steps) {
    if (options->stop && *options->stop) {
      TRY(write_checkpoint(training));
      return status_fail(STATUS_INTERRUPTED, "stopped at step %lld of %lld; --resume continues",
                         training->counts.step, (long long)training->schedule.total_steps);
    }
    TRY(take_step(training));
    if (is_validation(training)) {
      TRY(validate(training));
      training->counts.seconds = spent_before;
      if (training->config->patience && training->counts.stale >= training->config->patience) {
        result->has_stopped_early = true;
        return STATUS_OK;
      }
    }
    report_progress(training, first_step);
  }
  return STATUS_OK;
}

Status app_training_run(const AppTrainingConfig *config, const AppTrainingOptions *options,
                        AppTrainingResult *result) {
  Training training = {.config = config, .options = options};
  *result = (AppTrainingResult){0};
  Status status = prepare(&training);
  if (!status) status = run_steps(&training, result);
  result->step = training.counts.step;
  result->best_step = training.counts.best_step;
  result->best_score = training.best_score;
  result->seconds = training.began_s > 0 ? clock_wall_s() - training.began_s : 0;
  destroy(&training);
  return status;
}
