// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/training/guard.h"

#include <string.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "net/files/safetensors.h"
#include "overlap/weights.h"

static Status check_input(const char *key, const char *name, const char *weights) {
  if (!name || !overlap_weights_is_path(name) || !file_is_same(name, weights)) return STATUS_OK;
  return status_fail(
      STATUS_USAGE,
      "%s: the training reads this file by '%s' and would write its own weights over it; give the "
      "training another `name`, or another directory by -o",
      weights, key);
}

Status app_training_guard_inputs(const AppTrainingConfig *config, const char *weights) {
  TRY(check_input("model.of", config->model.of, weights));
  return check_input("start", config->start, weights);
}

// Whether a text of the file's metadata ends in a line break and the description.
static bool is_described(const char *path, const char *key, const char *description) {
  NetTensorFile file = {0};
  const char *text;
  bool is_ours = false;
  if (net_safetensors_read(path, &file) == NET_OK &&
      net_safetensors_text(&file, path, key, &text) == NET_OK) {
    size_t length = strlen(text), size = strlen(description);
    is_ours =
        length > size && text[length - size - 1] == '\n' && strcmp(text + length - size, description) == 0;
  }
  net_safetensors_destroy(&file);
  return is_ours;
}

static bool holds(const char *path, const char *wanted) {
  char *text = NULL;
  size_t size;
  bool is_same = file_read(path, &text, &size) == STATUS_OK && strcmp(text, wanted) == 0;
  memory_free(text);
  return is_same;
}

static Status fail(const char *path) {
  return status_fail(
      STATUS_USAGE,
      "%s: is there, and not of this training, which would write over it; name another directory by "
      "-o, or add --force to replace it",
      path);
}

// A file of the directory that no training of this configuration is known to have made.
static Status check_absent(const char *directory, const char *name) {
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  Status status = file_exists(path) ? fail(path) : STATUS_OK;
  memory_free(path);
  return status;
}

// Of a directory without weights and checkpoint: a training that ended before its first validation has left
// its configuration.
static Status check_others(const AppTrainingConfig *config, const char *directory) {
  static const char *const names[] = {"config.yaml", "log.csv", "candidate.safetensors", "learning.gp",
                                      "learning.png"};
  char *path = file_join(directory, names[0]);
  if (!path) return status_no_memory("a file name");
  bool is_ours = holds(path, config->text);
  memory_free(path);
  for (int k = 0; k < 5 && !is_ours; k++) TRY(check_absent(directory, names[k]));
  return STATUS_OK;
}

Status app_training_guard_files(const AppTrainingConfig *config, const char *description,
                                const char *directory, const char *weights) {
  char *checkpoint = file_join(directory, APP_TRAINING_CHECKPOINT);
  if (!checkpoint) return status_no_memory("a file name");
  bool has_checkpoint = file_exists(checkpoint), has_weights = file_exists(weights);
  Status status = STATUS_OK;
  if (has_weights && !is_described(weights, "provenance", description)) status = fail(weights);
  if (!status && has_checkpoint && !is_described(checkpoint, "note", description)) status = fail(checkpoint);
  if (!status && !has_checkpoint && !has_weights) status = check_others(config, directory);
  memory_free(checkpoint);
  return status;
}
