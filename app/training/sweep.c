// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/sweep.h"

#include <stdio.h>
#include <string.h>

#include "app/training/training.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"

enum { MAX_OVERRIDES = 32 };

typedef struct Sweep {
  AppSweep *sweep;
  const char *directory, *weights;
  int threads;
  const volatile sig_atomic_t *stop;
} Sweep;

void app_sweep_destroy(AppSweep *sweep) {
  for (int i = 0; i < sweep->count; i++) memory_free(sweep->weights[i]);
  *sweep = (AppSweep){0};
}

static void show_progress(void *observer, const AppTrainingProgress *progress) {
  log_progress("%s: %3.0f %%, %.0f samples/s, %.0f s left", (const char *)observer,
               100 * (double)progress->step / (double)progress->step_count, progress->samples_per_s,
               progress->seconds_left);
}

static Status train(const Sweep *sweep, const AppTrainingConfig *config, const char *home) {
  AppTrainingOptions options = {.directory = home,
                                .threads = sweep->threads,
                                .resumes = true,
                                .stop = sweep->stop,
                                .observe = show_progress,
                                .observer = config->name};
  AppTrainingResult result;
  Status status = app_training_run(config, &options, &result);
  log_progress_end();
  if (!status) log_info("%s: score %.4g, %.1f s", config->name, result.best_score, result.seconds);
  return status;
}

// A training that was stopped has weights too, of its best validation: they are in the way of going on. So
// the weights count only once the training says that it is whole: it is trained under another name.
static Status train_whole(const Sweep *sweep, const AppTrainingConfig *config) {
  char *home = file_join(sweep->weights, config->name), name[256];
  snprintf(name, sizeof name, "%s.safetensors", config->name);
  char *trained = home ? file_join(home, name) : NULL, *path = file_join(sweep->weights, name);
  Status status = trained && path ? STATUS_OK : status_no_memory("a sweep");
  if (!status && !file_exists(path)) {
    status = train(sweep, config, home);
    if (!status && rename(trained, path) != 0)
      status = status_fail(STATUS_IO, "%s: cannot be moved to %s", trained, path);
  }
  memory_free(home), memory_free(trained);
  if (!status)
    sweep->sweep->weights[sweep->sweep->count++] = path;
  else
    memory_free(path);
  return status;
}

// "CONFIG KEY=VALUE …"; empty lines are nothing.
static Status take_line(const Sweep *sweep, char *line) {
  const char *overrides[MAX_OVERRIDES];
  int count = 0;
  char *rest = NULL;
  line[strcspn(line, "#")] = 0;
  char *file = strtok_r(line, " \t\r", &rest);
  if (!file) return STATUS_OK;
  if (sweep->sweep->count == APP_SWEEP_MAX)
    return status_fail(STATUS_INPUT, "at most %d trainings", APP_SWEEP_MAX);
  for (char *word = strtok_r(NULL, " \t\r", &rest); word; word = strtok_r(NULL, " \t\r", &rest)) {
    if (count == MAX_OVERRIDES) return status_fail(STATUS_INPUT, "at most %d settings a line", MAX_OVERRIDES);
    overrides[count++] = word;
  }
  char *path = file_join(sweep->directory, file);
  if (!path) return status_no_memory("a sweep");
  AppTrainingConfig config = {0};
  Status status = app_training_config_read(path, overrides, count, &config);
  memory_free(path);
  if (!status) status = train_whole(sweep, &config);
  app_training_config_destroy(&config);
  return status;
}

static Status take_lines(const Sweep *sweep, char *text, const char *path) {
  int number = 1;
  for (char *line = text; line; number++) {
    char *end = strchr(line, '\n');
    if (end) *end = 0;
    Status status = take_line(sweep, line);
    // a setting that is wrong is the file's mistake here, not the command line's
    if (status) return status_prefix(status == STATUS_USAGE ? STATUS_INPUT : status, "%s:%d", path, number);
    line = end ? end + 1 : NULL;
  }
  return STATUS_OK;
}

Status app_sweep_train(AppSweep *sweep, const char *directory, const char *weights, int threads,
                       const volatile sig_atomic_t *stop) {
  *sweep = (AppSweep){0};
  Sweep how = {.sweep = sweep, .directory = directory, .weights = weights, .threads = threads, .stop = stop};
  char *path = file_join(directory, "sizes"), *text = NULL;
  size_t size;
  Status status = path ? file_read(path, &text, &size) : status_no_memory("a sweep");
  if (!status) status = take_lines(&how, text, path);
  if (!status && sweep->count == 0) status = status_fail(STATUS_INPUT, "%s: names no training", path);
  if (status) app_sweep_destroy(sweep);
  memory_free(path), memory_free(text);
  return status;
}
