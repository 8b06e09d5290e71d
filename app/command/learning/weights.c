// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/training/task.h"
#include "app/training/tpn.h"
#include "base/log.h"
#include "overlap/models.h"
#include "overlap/weights.h"

typedef struct Options {
  const char *name, *config;
} Options;

static const AppOption option_table[] = {
    {"range", 'r', "CONFIG",
     "Write into the file the range of the training data of this `tetlap train` configuration (kind tpn)", 0,
     CLI_TEXT, CLI_TO(Options, config)},
    {0},
};

static Status print(const char *path, const NetModel_f32 *model, const NetCard *card) {
  char shape[NET_SHAPE_TEXT];
  TRY(app_training_task_fail(net_shape_print(&model->plan->shape, shape)));
  printf("file           %s\nparameters     %zu\nshape          %s\nnormalisation  %s\nrange          "
         "%s\n\n%s\n",
         path, model->plan->parameter_count, shape, card->normalisation, card->range, card->provenance);
  return STATUS_OK;
}

// The card gets another range; all else, the numbers too, stays.
static Status stamp(const char *path, const char *config_path, const NetModel_f32 *model,
                    const NetCard *card) {
  AppTrainingConfig config;
  OverlapRange range;
  char text[OVERLAP_RANGE_TEXT];
  if (model->plan->shape.kind != NET_TPN)
    return status_fail(STATUS_INPUT, "%s: --range is for a TetrahedronPairNet, this is another network",
                       path);
  TRY(app_training_config_read(config_path, NULL, 0, &config));
  Status status = config.model.kind == APP_MODEL_TPN
                      ? app_training_tpn_range(&config, &range)
                      : status_fail(STATUS_INPUT, "%s: does not train a tpn", config_path);
  app_training_config_destroy(&config);
  TRY(status);
  overlap_range_print(&range, text);
  NetCard stamped = {.normalisation = card->normalisation, .range = text, .provenance = card->provenance};
  TRY(app_training_task_fail(net_weights_write_f32(path, model, &stamped)));
  log_info("%s: range %s", path, text);
  return STATUS_OK;
}

static const OverlapOps *find_model(const char *name) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++)
    if (strcmp(models[m]->name, name) == 0) return models[m];
  return NULL;
}

// Of the program's own: a name that has none is a wrong word, weights that are lost are a missing file.
static Status find(const char *name, char *path, size_t size) {
  const OverlapOps *model = find_model(name);
  if (model && (!model->create || strcmp(name, "hybrid") == 0))
    return status_fail(STATUS_USAGE,
                       "the overlap model '%s' has no weights of its own; give geo, geo-small, tpn "
                       "or the path of a file",
                       name);
  Status status = overlap_weights_find(model && model->weights ? model->weights : name, path, size);
  if (status != STATUS_IO || model) return status;
  char other[4096];
  bool is_lost = overlap_weights_find("geo", other, sizeof other) != STATUS_OK;
  overlap_weights_find(name, path, size); // for its message
  return is_lost ? STATUS_IO : STATUS_USAGE;
}

static Status print_weights(const Options *options) {
  char found[4096];
  const char *path = options->name;
  if (!overlap_weights_is_path(path)) {
    TRY(find(path, found, sizeof found));
    path = found;
  }
  NetModel_f32 model;
  NetCard card;
  TRY(app_training_task_fail(net_weights_read_f32(path, &model, &card)));
  Status status = options->config ? stamp(path, options->config, &model, &card) : print(path, &model, &card);
  net_weights_card_destroy(&card);
  net_model_destroy_f32(&model);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_weights, argument_count, arguments, &options);
  return app_cli_command_end(print_weights(&options));
}

const AppCommand app_command_weights = {
    .name = "weights",
    .help = "print the metadata of a weights file",
    .options = option_table,
    .arguments = &(const AppArguments){"NAME|FILE", offsetof(Options, name), 1,
                                       .missing = "name a weights file, or a model whose weights ship",
                                       .excess = "one file at a time; '%s' is the second"},
    .doc = "Print the metadata of a weights file: the network's shape, the normalisation of its input, the "
           "range of its training data, and its provenance.",
    .run = run_command};
