// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "app/job/job.h"
#include "app/training/log.h"
#include "app/training/training.h"
#include "base/log.h"

typedef struct Options {
  const char *config, *directory;
  const char *overrides[APP_MAX_OVERRIDES];
  int override_count, threads; // 0: all
  bool resumes, replaces, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "DIR", "Write into DIR (default: out/train/ and the configuration's name)", 0, CLI_TEXT,
     CLI_TO(Options, directory)},
    {"set", 's', "KEY=VALUE", "Replace a value of the configuration, as in optimiser.rate=1e-3", 0,
     CLI_REPEATED, CLI_TO(Options, overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(Options, override_count)},
    {"threads", 't', "N", "Threads (default: all); the result does not depend on it", 0, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"resume", 0, NULL, "Go on from the checkpoint in DIR", 0, CLI_FLAG, CLI_TO(Options, resumes)},
    {"force", 0, NULL, "Replace files in DIR that are not of this training", 0, CLI_FLAG,
     CLI_TO(Options, replaces)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

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

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_train, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(read_and_train(&options));
}

const AppCommand app_command_train = {
    .name = "train",
    .help = "train a learned overlap model",
    .options = option_table,
    .arguments = &(const AppArguments){"CONFIG", offsetof(Options, config), 1,
                                       .missing = "name a configuration, as in examples/train/smoke.yaml",
                                       .excess = "one configuration at a time; '%s' is the second"},
    .doc = "Train a learned overlap model: data, network, loss and schedule as CONFIG says. The best "
           "weights, a checkpoint, a log and its picture are written.",
    .run = run_command,
    .has_threads = true};
