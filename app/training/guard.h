// SPDX-License-Identifier: GPL-3.0-or-later
// What a training may write over: files of an earlier training with the same configuration, no others. The
// weights and the checkpoint of a training hold its configuration.
#ifndef TETLAP_APP_TRAINING_GUARD_H
#define TETLAP_APP_TRAINING_GUARD_H

#include "app/training/config.h"
#include "base/status.h"

#define APP_TRAINING_CHECKPOINT "checkpoint.safetensors"

// Whether weights that the training reads, of the network that it bounds or begins from, lie where its own
// go. STATUS_USAGE names the key. `weights`: the path of its own.
Status app_training_guard_inputs(const AppTrainingConfig *config, const char *weights);

// Whether all files in the directory that a training begun there would replace are of this configuration.
// `description` is that of app_training_config_print. STATUS_USAGE names the file and what to do.
Status app_training_guard_files(const AppTrainingConfig *config, const char *description,
                                const char *directory, const char *weights);

#endif
