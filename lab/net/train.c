// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/net/train.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/bench/command.h"
#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/argument.h"
#include "app/training/task.h"
#include "base/clock.h"
#include "base/files/temporary.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/random.h"
#include "lab/net/torch_peer.h"

enum { MAX_CONFIGS = 8, MAX_OVERRIDES = 64 };
static const double ROUND_S = 0.5; // what a round shall take

typedef struct Options {
  AppBenchOptions common;
  const char *configs[MAX_CONFIGS];
  int config_count;
  int pairs, batches[APP_BENCH_MAX_LIST], batch_count; // no batches: the configurations' own
  bool has_torch;
  const char *overrides[MAX_OVERRIDES];
  int override_count;
} Options;

enum { KEY_PAIRS = 256, KEY_NO_TORCH };

static const struct argp_option option_table[] = {
    {"batch", 'b', "N,...", 0, "Samples a step (default: as the configuration says)", 1},
    {"pairs", KEY_PAIRS, "N", 0, "Pairs of each source that are made at most (default: 20000)", 1},
    {"set", 's', "KEY=VALUE", 0, "Replace a value of the configurations; may be repeated", 1},
    {"no-torch", KEY_NO_TORCH, NULL, 0, "Leave PyTorch out", 1},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
  case ARGP_KEY_INIT:
    state->child_inputs[0] = &options->common;
    return 0;
  case 'b':
    options->batch_count = app_bench_options_counts(state, "batch", text, 65536, options->batches);
    return 0;
  case KEY_PAIRS:
    options->pairs = (int)app_argument_integer(state, "pairs", text, 1, 100000000);
    return 0;
  case KEY_NO_TORCH:
    options->has_torch = false;
    return 0;
  case 's':
    app_argument_add(state, "--set", text, MAX_OVERRIDES, options->overrides, &options->override_count);
    return 0;
  case ARGP_KEY_ARG:
    app_argument_add(state, "configurations", text, MAX_CONFIGS, options->configs, &options->config_count);
    return 0;
  case ARGP_KEY_NO_ARGS:
    argp_error(state, "name training configurations, as in examples/train/sweep/tpn.yaml");
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

// A training without files: the same steps as `tetlap train` takes, or PyTorch's.
typedef struct Trainer {
  AppTrainingConfig config; // owned
  AppTrainingTask task;
  NetModel_f32 model;
  NetAdam_f32 adam;
  NetWork_f32 work;
  float *gradient; // (parameter_count), owned
  int threads, steps;
  long long step;
  bool is_torch;
  LabTorchPeer torch;
  AppBenchTimer timer; // of a sample
} Trainer;

static void trainer_destroy(Trainer *trainer) {
  if (trainer->task.ops) trainer->task.ops->destroy(&trainer->task);
  net_work_destroy_f32(&trainer->work);
  net_adam_destroy_f32(&trainer->adam);
  net_model_destroy_f32(&trainer->model);
  memory_free(trainer->gradient);
  lab_torch_peer_stop(&trainer->torch);
  app_training_config_destroy(&trainer->config);
}

static void limit(AppTrainingSourceDef *sources, int count, int pairs) {
  for (int s = 0; s < count; s++)
    if (sources[s].count == 0 || sources[s].count > pairs) sources[s].count = pairs;
}

static Status make_network(Trainer *trainer) {
  const AppTrainingOptimiserDef *def = &trainer->config.optimiser;
  NetShape shape = trainer->task.ops->shape(&trainer->config);
  TRY(app_training_task_fail(net_model_create_f32(&shape, &trainer->model)));
  net_model_initialise_f32(&trainer->model, (uint64_t)trainer->config.seed);
  size_t count = trainer->model.plan->parameter_count;
  NetAdamDef adam = net_adam_default();
  adam.beta1 = def->beta1, adam.beta2 = def->beta2, adam.weight_decay = def->weight_decay;
  TRY(app_training_task_fail(net_adam_create_f32(count, &adam, &trainer->adam)));
  if (!(trainer->gradient = memory_zeroed(count, sizeof(float)))) return status_no_memory("a training");
  NetWorkDef work = net_work_default();
  work.thread_count = trainer->threads;
  work.tangent_count = trainer->task.ops->tangents(&trainer->config);
  work.batch = def->batch + trainer->task.ops->rows;
  return app_training_task_fail(net_work_create_f32(trainer->model.plan, &work, &trainer->work));
}

static Status start_torch(Trainer *trainer) {
  char *path;
  int batch = trainer->config.optimiser.batch;
  TRY(temporary_file("weights", ".safetensors", &path));
  size_t numbers = (size_t)batch * (size_t)trainer->model.plan->shape.input_count;
  float *inputs = memory_zeroed(numbers, sizeof *inputs);
  Random random = random_seeded(3, 0);
  for (size_t i = 0; inputs && i < numbers; i++) inputs[i] = (float)random_between(&random, -1, 1);
  Status status = inputs ? trainer->task.ops->write(&trainer->task, &trainer->model, "bench", path)
                         : status_no_memory("the inputs");
  if (!status)
    status = lab_torch_peer_start(&trainer->torch, &(LabTorchDef){.weights = path,
                                                                  .precision = LAB_TORCH_FLOAT,
                                                                  .device = "cpu",
                                                                  .inputs = inputs,
                                                                  .size = numbers * sizeof *inputs,
                                                                  .threads = trainer->threads});
  memory_free(inputs);
  temporary_remove(path);
  return status;
}

static Status trainer_make(Trainer *trainer, const Options *options, const char *path, int batch,
                           int threads) {
  NetWhitening none = {0};
  omp_set_num_threads(threads);
  TRY(app_training_config_read(path, options->overrides, options->override_count, &trainer->config));
  limit(trainer->config.training, trainer->config.training_count, options->pairs);
  limit(trainer->config.validation, trainer->config.validation_count, 100);
  if (batch > 0) trainer->config.optimiser.batch = batch;
  trainer->threads = threads;
  trainer->task = (AppTrainingTask){.config = &trainer->config,
                                    .ops = app_training_task_find(trainer->config.model.kind)};
  log_progress("%s: making %d pairs", path, options->pairs);
  TRY(make_network(trainer));
  Status status = trainer->task.ops->create(&trainer->task, &none);
  log_progress_end();
  TRY(status);
  return trainer->is_torch ? start_torch(trainer) : STATUS_OK;
}

static Status take_steps(Trainer *trainer, int count) {
  size_t size = trainer->model.plan->parameter_count;
  for (int k = 0; k < count; k++) {
    double loss = trainer->task.ops->step(&trainer->task, &trainer->model, &trainer->work, trainer->step++,
                                          trainer->gradient);
    double norm = net_adam_clip_f32(size, trainer->config.optimiser.clip, trainer->gradient);
    if (!isfinite(loss) || !isfinite(norm))
      return status_fail(STATUS_SOLVER, "%s: the loss is not finite at step %lld", trainer->config.path,
                         trainer->step);
    net_adam_step_f32(&trainer->adam, trainer->config.optimiser.rate, trainer->gradient,
                      trainer->model.parameters);
  }
  return STATUS_OK;
}

static Status find_steps(Trainer *trainer) {
  LabTorchTime time = {0};
  double began = 0;
  for (int attempt = 0; attempt < 2; attempt++) { // the first one wakes threads and loads caches
    began = clock_wall_s();
    TRY(trainer->is_torch
            ? lab_torch_peer_time(&trainer->torch, "train", trainer->config.optimiser.batch, 1, &time)
            : take_steps(trainer, 1));
  }
  trainer->steps = (int)fmin(1e6, fmax(1, ROUND_S / (clock_wall_s() - began + 1e-9)));
  return STATUS_OK;
}

static Status take_turn(void *self, int round) {
  Trainer *trainer = self;
  int batch = trainer->config.optimiser.batch;
  omp_set_num_threads(trainer->threads);
  if (trainer->steps == 0) TRY(find_steps(trainer));
  double samples = (double)trainer->steps * batch;
  if (trainer->is_torch) {
    LabTorchTime time;
    TRY(lab_torch_peer_time(&trainer->torch, "train", batch, trainer->steps, &time));
    trainer->timer.wall[round] = time.wall_s / samples, trainer->timer.cpu[round] = time.cpu_s / samples;
    return STATUS_OK;
  }
  app_bench_timer_start(&trainer->timer);
  TRY(take_steps(trainer, trainer->steps));
  app_bench_timer_stop(&trainer->timer, round, samples);
  return STATUS_OK;
}

typedef struct Row {
  const char *config, *model, *implementation;
  long long batch, threads, parameters;
  double rate, cpu_rate, spread, ratio, ratio_min, ratio_max, cpu_ratio;
} Row;

static const AppBenchColumn columns[] = {
    {"config", APP_BENCH_TEXT, offsetof(Row, config), "configuration", "file"},
    {"model", APP_BENCH_TEXT, offsetof(Row, model), NULL, "geo or tpn"},
    {"implementation", APP_BENCH_TEXT, offsetof(Row, implementation), "by",
     "tetlap, or PyTorch and its version"},
    {"parameters", APP_BENCH_INTEGER, offsetof(Row, parameters), "parameters", "of the network"},
    {"batch", APP_BENCH_INTEGER, offsetof(Row, batch), "batch", "samples a step"},
    {"threads", APP_BENCH_INTEGER, offsetof(Row, threads), "threads", "threads"},
    {"samples_per_second", APP_BENCH_NUMBER, offsetof(Row, rate), "samples/s", "of wall time"},
    {"samples_per_cpu_second", APP_BENCH_NUMBER, offsetof(Row, cpu_rate), "samples/cpu s",
     "of processor time"},
    {"spread", APP_BENCH_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
    {"ratio_to_torch", APP_BENCH_NUMBER, offsetof(Row, ratio), "× PyTorch",
     "speed over PyTorch's in the same round, median of the rounds. PyTorch takes the same batch over and "
     "over (forward, loss, backward, AdamW); ours also gathers each batch from all pairs and clips the "
     "gradient"},
    {"ratio_to_torch_min", APP_BENCH_NUMBER, offsetof(Row, ratio_min), NULL, "smallest of the rounds"},
    {"ratio_to_torch_max", APP_BENCH_NUMBER, offsetof(Row, ratio_max), NULL, "largest of the rounds"},
    {"cpu_ratio_to_torch", APP_BENCH_NUMBER, offsetof(Row, cpu_ratio), NULL,
     "the same of processor times, median of the rounds"},
};
static const AppBenchReport report = {"train", columns, sizeof columns / sizeof *columns, sizeof(Row), true};

static const Trainer *find_torch(const Trainer *trainers, int count, const Trainer *like) {
  for (int t = 0; t < count; t++)
    if (trainers[t].is_torch && strcmp(trainers[t].config.path, like->config.path) == 0 &&
        trainers[t].config.optimiser.batch == like->config.optimiser.batch &&
        trainers[t].threads == like->threads)
      return &trainers[t];
  return NULL;
}

static Row row_of(const Trainer *trainers, int count, const Trainer *trainer, int rounds) {
  AppBenchTime time = app_bench_timer_time(&trainer->timer, rounds);
  const Trainer *torch = find_torch(trainers, count, trainer);
  AppBenchRatio ratio = {NAN, NAN, NAN};
  double cpu_ratio = NAN;
  if (torch) ratio = app_bench_timer_ratio(&trainer->timer, &torch->timer, rounds);
  if (torch) cpu_ratio = app_bench_timer_cpu_ratio(&trainer->timer, &torch->timer, rounds).median;
  return (Row){.config = trainer->config.path,
               .model = trainer->config.model.kind == APP_MODEL_GEO ? "geo" : "tpn",
               .implementation = trainer->is_torch ? trainer->torch.name : "tetlap",
               .parameters = (long long)trainer->model.plan->parameter_count,
               .batch = trainer->config.optimiser.batch,
               .threads = trainer->threads,
               .rate = 1 / time.wall,
               .cpu_rate = 1 / time.cpu,
               .spread = (time.wall_max - time.wall_min) / time.wall,
               .ratio = ratio.median,
               .ratio_min = ratio.min,
               .ratio_max = ratio.max,
               .cpu_ratio = cpu_ratio};
}

// PyTorch takes part where the loss is the paper's; where it is not installed, it is left out.
static Status add(Trainer *trainers, int *count, const Options *options, const char *path, int batch,
                  int threads) {
  TRY(trainer_make(&trainers[(*count)++], options, path, batch, threads));
  const AppTrainingConfig *config = &trainers[*count - 1].config;
  if (!options->has_torch || config->model.kind != APP_MODEL_TPN || config->loss.sobolev > 0)
    return STATUS_OK;
  Trainer *peer = &trainers[*count];
  peer->is_torch = true;
  Status status = trainer_make(peer, options, path, batch, threads);
  if (status == STATUS_OK) {
    (*count)++;
    return STATUS_OK;
  }
  trainer_destroy(peer);
  *peer = (Trainer){0};
  if (status == STATUS_IO) log_warning("left out: PyTorch: %s", status_message());
  return status == STATUS_IO ? STATUS_OK : status;
}

static Status measure(Trainer *trainers, int *count, const Options *options, Row *rows) {
  int batches = options->batch_count ? options->batch_count : 1, rounds = options->common.repeats;
  for (int c = 0; c < options->config_count; c++)
    for (int b = 0; b < batches; b++)
      for (int t = 0; t < options->common.thread_list_count; t++)
        TRY(add(trainers, count, options, options->configs[c], options->batch_count ? options->batches[b] : 0,
                options->common.thread_list[t]));
  TRY(app_bench_timer_take_turns(trainers, sizeof *trainers, *count, rounds, true, take_turn));
  for (int t = 0; t < *count; t++) rows[t] = row_of(trainers, *count, &trainers[t], rounds);
  return app_bench_report_print(&report, &options->common, rows, *count);
}

static Status run(const Options *options) {
  int count = 0, batches = options->batch_count ? options->batch_count : 1;
  size_t places = (size_t)(2 * options->config_count * batches * options->common.thread_list_count + 1);
  Trainer *trainers = memory_zeroed(places, sizeof *trainers);
  Row *rows = memory_zeroed(places, sizeof *rows);
  Status status =
      trainers && rows ? measure(trainers, &count, options, rows) : status_no_memory("the trainings");
  for (int t = 0; trainers && t < count; t++) trainer_destroy(&trainers[t]);
  memory_free(trainers), memory_free(rows);
  return status;
}

static const struct argp argp = {.options = option_table,
                                 .parser = parse,
                                 .args_doc = "CONFIG…",
                                 .doc = "Measure the steps of trainings, data and validation left out.",
                                 .children = app_bench_command_children,
                                 .help_filter = app_bench_command_help};

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(3), .pairs = 20000, .has_torch = true};
  options.common.takes_thread_list = true;
  app_bench_command_read(&lab_train, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_train = {.name = "train",
                              .help = "training, beside PyTorch: samples a second",
                              .argp = &argp,
                              .run = run_command,
                              .has_threads = true,
                              .rows = &report,
                              .describe_rows = app_bench_command_rows};
