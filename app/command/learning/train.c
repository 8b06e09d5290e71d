// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/learning/train.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>

#include "app/cli/argument.h"
#include "app/job/job.h"
#include "app/training/log.h"
#include "app/training/training.h"
#include "base/log.h"

enum { KEY_RESUME = 256, KEY_FORCE };

typedef struct Options {
  const char *config, *directory;
  const char *overrides[APP_MAX_OVERRIDES];
  int override_count, threads; // 0: all
  bool resumes, replaces, is_quiet;
} Options;

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Write into DIR (default: out/train/ and the configuration's name)", 0},
    {"set", 's', "KEY=VALUE", 0, "Replace a value of the configuration, as in optimiser.rate=1e-3", 0},
    {"threads", 't', "N", 0, "Threads (default: all); the result does not depend on it", 0},
    {"resume", KEY_RESUME, NULL, 0, "Go on from the checkpoint in DIR", 0},
    {"force", KEY_FORCE, NULL, 0, "Replace files in DIR that are not of this training", 0},
    {"quiet", 'q', NULL, 0, "Say errors only", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case 'o':
    options->directory = text;
    return 0;
  case 's':
    app_argument_add(state, "--set", text, APP_MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case 't':
    options->threads = app_argument_threads(state, text);
    return 0;
  case KEY_RESUME:
    options->resumes = true;
    return 0;
  case KEY_FORCE:
    options->replaces = true;
    return 0;
  case 'q':
    options->is_quiet = true;
    return 0;
  case ARGP_KEY_ARG:
    if (options->config) argp_error(state, "one configuration at a time; '%s' is the second", text);
    options->config = text;
    return 0;
  case ARGP_KEY_END:
    if (!options->config) argp_error(state, "name a configuration, as in examples/train/smoke.yaml");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static void show_progress(void *observer, const AppTrainingProgress *progress) {
  LogPace *pace = observer;
  double share = (double)progress->step / (double)progress->step_count;
  log_progress("%3.0f %%  %.3g M samples  loss %.3g  score %.4g, best %.4g  %.0f samples/s  %.0f s left",
               100 * share, progress->samples / 1e6, progress->loss, progress->score, progress->best_score,
               progress->samples_per_s, progress->seconds_left);
  if (!log_pace_is_due(pace, share)) return;
  if (isfinite(progress->score))
    log_info("%.0f %%: step %lld of %lld, loss %.3g, score %.4g, best %.4g, about %.3g s left",
             floor(100 * share), progress->step, progress->step_count, progress->loss, progress->score,
             progress->best_score, progress->seconds_left);
  else
    log_info("%.0f %%: step %lld of %lld, loss %.3g, not validated yet, about %.3g s left",
             floor(100 * share), progress->step, progress->step_count, progress->loss,
             progress->seconds_left);
}

static void log_line(void *observer, const char *text) {
  (void)observer;
  log_progress_end();
  log_info("%s", text);
}

static Status train(const Options *options, const AppTrainingConfig *config) {
  char directory[512];
  snprintf(directory, sizeof directory, "out/train/%s", config->name);
  LogPace pace = {0};
  AppTrainingOptions run = {.directory = options->directory ? options->directory : directory,
                            .threads = omp_get_max_threads(),
                            .resumes = options->resumes,
                            .replaces = options->replaces,
                            .stop = app_job_stop_flag(),
                            .observe = show_progress,
                            .tell = log_line,
                            .observer = &pace};
  AppTrainingResult result;
  if (options->resumes && !app_training_has_checkpoint(run.directory))
    return status_fail(
        STATUS_USAGE,
        "%s: there is nothing to resume, as it holds no checkpoint; leave out --resume, or name "
        "the training's directory by -o",
        run.directory);
  Status status = app_training_run(config, &run, &result);
  log_progress_end();
  if (!status)
    log_info("%s: best score %.4g at step %lld of %lld%s, %.0f s", run.directory, result.best_score,
             result.best_step, result.step, result.has_stopped_early ? " (stopped early)" : "",
             result.seconds);
  if (!status && app_training_log_plot(run.directory, config->name) != STATUS_OK)
    log_warning("no picture: %s", status_message());
  return status;
}

static Status read_and_train(const Options *options) {
  AppTrainingConfig config;
  TRY(app_training_config_read(options->config, options->overrides, options->override_count, &config));
  Status status = train(options, &config);
  app_training_config_destroy(&config);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "CONFIG",
    .doc = "Train a learned overlap model: data, network, loss and schedule as CONFIG says. The best "
           "weights, a checkpoint, a log and its picture are written.",
};

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(read_and_train(&options));
}

const AppCommand app_command_train = {.name = "train",
                                      .help = "train a learned overlap model",
                                      .argp = &argp,
                                      .run = run_command,
                                      .has_threads = true};
