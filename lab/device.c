// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab device DEVICE`: the models that a device has kernels for, by where the pairs lie.
//
//   device   numbers by column, there already; the answers stay there
//   indices  positions and tetrahedra, there already; a pair is two indices; the answers stay there
//   host     sent from the host as the models take them, and all answers fetched
//
// With --torch PyTorch evaluates networks beside, on the same device: the network alone, whose inputs are
// there, without the gate before it and the frame around it (torch/network.h).
//
// A rate is of complete answers: with the pairs that one kernel hands on to the next, and to the host.
#include "lab/program.h"

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stddef.h>
#include <string.h>

#include "app/bench/overlap/pairs.h"
#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/parse.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "device/overlap/overlap.h"
#include "device/peak/peak.h"
#include "lab/peak.h"
#include "lab/torch/network.h"

enum { DEVICE_COLUMNS, INDICES, HOST, RESIDENCE_COUNT, QUANTITY_COUNT = 3 };
static const char *const residences[RESIDENCE_COUNT] = {"device", "indices", "host"};
static const char *const quantities[QUANTITY_COUNT] = {"V", "V+grad", "V+centroid"}; // of DeviceQuantity

static const uint64_t SEED = 1;
static const double ROUND_S = 0.05; // what a round shall take

typedef struct Options {
  AppBenchOptions common;
  const char *device; // as device_open takes it
  bool wants_model[DEVICE_OVERLAP_MODELS], wants_set[APP_BENCH_SET_COUNT];
  bool wants_quantity[QUANTITY_COUNT], wants_residence[RESIDENCE_COUNT], wants_torch;
  AppBenchList batches;
} Options;

static const AppOption option_table[] = {
    {"model", 'm', "NAME,...", "Overlap models that have kernels (default: all)", 1, CLI_CHOICES,
     CLI_TO(Options, wants_model), .most = DEVICE_OVERLAP_MODELS, .choices = device_overlap_models},
    {"set", 's', "NAME,...", "Sets of pairs: near, uniform, disjoint (default: all)", 1, CLI_CHOICES,
     CLI_TO(Options, wants_set), .most = APP_BENCH_SET_COUNT, .choices = app_bench_sets},
    {"quantity", 'Q', "NAME,...", "V, V+grad, V+centroid (default: all that a model has)", 1, CLI_CHOICES,
     CLI_TO(Options, wants_quantity), .most = QUANTITY_COUNT, .choices = quantities},
    {"batch", 'b', "N,...", "Pairs a call (default: 4096)", 1, CLI_OWN, CLI_TO(Options, batches),
     .read = app_bench_options_read_batches},
    {"residence", 'R', "NAME,...", "Where the pairs lie: device, indices, host (default: all)", 1,
     CLI_CHOICES, CLI_TO(Options, wants_residence), .most = RESIDENCE_COUNT, .choices = residences},
    {"torch", 0, NULL,
     "PyTorch beside models with a network, on the same device: the network alone, without gate and frame", 1,
     CLI_FLAG, CLI_TO(Options, wants_torch)},
    {.table = app_bench_options, .offset = offsetof(Options, common)},
    {0},
};

// Rows on which one takes turns.
typedef struct Contestant {
  DeviceOverlap *overlap; // borrowed
  const double *pairs;    // (batch, 24), borrowed
  double *volume, *more;
  const char *model, *set;
  int residence, batch, calls;
  DeviceQuantity quantity;
  AppBenchTimer timer;
  AppBenchTimer kernels;      // of a pair; only the wall time
  double gate_share;          // of the kernels' time, of a network: the gate's
  double flops, instructions; // arithmetic of a pair, in the mean
  int handed_on, to_host;
} Contestant;

typedef struct Bench {
  const Options *options;
  Device device;
  DeviceOverlap overlaps[DEVICE_OVERLAP_MODELS];
  double *pairs, *columns; // of one set: (most, 24), (24, most)
  double *volume, *gradient;
  int *tets, *ends;
  Contestant *contestants;
  LabTorchNetwork *torches; // beside the contestants of a set and batch
  int count, torch_count;
  double
      peak[DEVICE_ARITHMETIC_COUNT]; // multiplications and additions [1/s], of a processor those of one core
} Bench;

typedef struct Row {
  const char *model, *set, *quantity, *residence, *device;
  long long batch;
  double handed_on, to_host;      // shares of the pairs
  double gate, of_peak, of_issue; // NaN: not known
  double kernel_rate, rate, rate_min, rate_max, spread, cpu_rate;
} Row;

static const AppTableColumn columns[] = {
    {"model", APP_TABLE_TEXT, offsetof(Row, model), "model", "overlap model"},
    {"set", APP_TABLE_TEXT, offsetof(Row, set), "set", "set of pairs: near, uniform, disjoint"},
    {"quantity", APP_TABLE_TEXT, offsetof(Row, quantity), "quantity", "V, V+grad or V+centroid"},
    {"residence", APP_TABLE_TEXT, offsetof(Row, residence), "residence", "where pairs and answers lie"},
    {"batch", APP_TABLE_INTEGER, offsetof(Row, batch), "batch", "pairs a call"},
    {"handed_on", APP_TABLE_NUMBER, offsetof(Row, handed_on), "handed on",
     "share of the pairs that the first kernel left; of geo, those that clip answers, too"},
    {"handed_to_host", APP_TABLE_NUMBER, offsetof(Row, to_host), "to host",
     "share of the pairs that the processor answered"},
    {"kernel_pairs_s", APP_TABLE_NUMBER, offsetof(Row, kernel_rate), "kernel pairs/s",
     "pairs over the time of all kernels, median of the rounds"},
    {"gate", APP_TABLE_NUMBER, offsetof(Row, gate), "gate",
     "share of the kernels' time that a network's gate takes; clipping has none of its own"},
    {"of_peak", APP_TABLE_NUMBER, offsetof(Row, of_peak), "of peak",
     "arithmetic of clipping, or multiplications and additions of a network's products, over the time of all "
     "kernels, by what the device can do at most: its maker's figure (cuda) or a kernel of fused "
     "multiply-adds (opencl); of a processor over its time, by what one core is measured to do. Where there "
     "is no product in bf16, tpn-bf16 is compared with float"},
    {"of_issue", APP_TABLE_NUMBER, offsetof(Row, of_issue), "of issue",
     "instructions of that arithmetic (a fused one is one) over the time of all kernels, by what all "
     "multiprocessors can issue: at least so much, for what compares, chooses and loads is not counted; of "
     "cuda alone"},
    {"pairs_s", APP_TABLE_NUMBER, offsetof(Row, rate), "pairs/s", "complete answers, of wall time"},
    {"pairs_s_min", APP_TABLE_NUMBER, offsetof(Row, rate_min), NULL, "slowest round"},
    {"pairs_s_max", APP_TABLE_NUMBER, offsetof(Row, rate_max), NULL, "fastest round"},
    {"spread", APP_TABLE_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
    {"pairs_cpu_s", APP_TABLE_NUMBER, offsetof(Row, cpu_rate), "pairs/cpu s",
     "complete answers, of this processor's time: of `host` what counts where others use the machine, too"},
    {"device", APP_TABLE_TEXT, offsetof(Row, device), "device", "as its driver names it"},
};
static const AppBenchReport report = {"device", columns, sizeof columns / sizeof *columns, sizeof(Row),
                                      .has_own_threads = false};

static Status place(Contestant *contestant, const Bench *bench) {
  DeviceOverlap *overlap = contestant->overlap;
  int n = contestant->batch;
  if (contestant->residence == INDICES)
    return device_overlap_put_mesh(overlap, 8 * n, contestant->pairs, 2 * n, bench->tets, n, bench->ends);
  for (size_t i = 0; i < (size_t)n; i++)
    for (size_t c = 0; c < 24; c++) bench->columns[c * (size_t)n + i] = contestant->pairs[24 * i + c];
  return device_overlap_put_columns(overlap, n, bench->columns);
}

static Status call(Contestant *contestant, double *kernel_s) {
  DeviceOverlap *overlap = contestant->overlap;
  if (contestant->residence == HOST) {
    const OverlapBatch batch = {.pair_count = contestant->batch,
                                .pairs = contestant->pairs,
                                .volume = contestant->volume,
                                .gradient = contestant->quantity == DEVICE_GRADIENT ? contestant->more : NULL,
                                .centroid =
                                    contestant->quantity == DEVICE_CENTROID ? contestant->more : NULL};
    TRY(device_overlap_eval(overlap, &batch));
  } else {
    TRY(device_overlap_run(overlap, contestant->quantity));
  }
  *kernel_s += overlap->kernel_s;
  return STATUS_OK;
}

// As many calls as fill a round.
static Status find_calls(Contestant *contestant) {
  double ignored = 0, began;
  TRY(call(contestant, &ignored)); // takes memory, loads code
  began = clock_wall_s();
  TRY(call(contestant, &ignored));
  double calls = ROUND_S / (clock_wall_s() - began + 1e-9);
  contestant->calls = calls < 1 ? 1 : calls < INT_MAX ? (int)calls : INT_MAX;
  return STATUS_OK;
}

static Status take_turn(Contestant *contestant, const Bench *bench, int round) {
  const Device *device = &bench->device;
  double kernel_s = 0;
  if (contestant->residence != HOST) TRY(place(contestant, bench));
  if (contestant->calls == 0) TRY(find_calls(contestant));
  TRY(device->ops->wait(device->self));
  app_bench_timer_start(&contestant->timer);
  for (int k = 0; k < contestant->calls; k++) TRY(call(contestant, &kernel_s));
  TRY(device->ops->wait(device->self));
  double parts = (double)contestant->calls * contestant->batch;
  app_bench_timer_stop(&contestant->timer, round, parts);
  contestant->kernels.wall[round] = kernel_s / parts;
  const DeviceOverlap *overlap = contestant->overlap;
  contestant->handed_on = overlap->handed_on[0];
  contestant->gate_share = overlap->gate_s / overlap->kernel_s;
  contestant->flops =
      device_overlap_flops(overlap, contestant->quantity) * (double)overlap->flop_pairs / contestant->batch;
  contestant->instructions = device_overlap_instructions(overlap, contestant->quantity) *
                             (double)overlap->flop_pairs / contestant->batch;
  contestant->to_host = overlap->handed_on[overlap->stage_count - 1];
  return STATUS_OK;
}

static Status take_rounds(Bench *bench, int first, int first_torch) {
  for (int round = 0; round < bench->options->common.repeats; round++) {
    for (int c = first; c < bench->count; c++) TRY(take_turn(&bench->contestants[c], bench, round));
    for (int t = first_torch; t < bench->torch_count; t++)
      TRY(lab_torch_network_take_turn(&bench->torches[t], round, ROUND_S));
  }
  return STATUS_OK;
}

// --- The rows.

// Of what the device can do at most, over the time of its kernels; of a processor, of what a core can, over
// processor time. NaN: not known.
static double share_of_peak(const Bench *bench, const Contestant *contestant, double kernel_rate,
                            double cpu_rate) {
  const double peak = bench->peak[device_overlap_arithmetic(contestant->overlap)];
  const double rate = bench->device.info.is_gpu ? kernel_rate : cpu_rate;
  return contestant->flops > 0 && peak > 0 ? contestant->flops * rate / peak : NAN;
}

// Of the instructions that a device can issue; NaN: it is not known how many.
static double share_of_issue(const Bench *bench, const Contestant *contestant, double kernel_rate) {
  const double most = bench->device.info.issue;
  return contestant->instructions > 0 && most > 0 ? contestant->instructions * kernel_rate / most : NAN;
}

static Row row_of(const Bench *bench, const Contestant *contestant) {
  int rounds = bench->options->common.repeats;
  AppBenchTime time = app_bench_timer_time(&contestant->timer, rounds);
  const double kernel_rate = 1 / app_bench_timer_time(&contestant->kernels, rounds).wall;
  return (Row){.model = contestant->model,
               .set = contestant->set,
               .quantity = quantities[contestant->quantity],
               .residence = residences[contestant->residence],
               .device = bench->device.info.name,
               .batch = contestant->batch,
               .handed_on = (double)contestant->handed_on / contestant->batch,
               .to_host = (double)contestant->to_host / contestant->batch,
               .kernel_rate = kernel_rate,
               .gate = device_overlap_weights(contestant->overlap) ? contestant->gate_share : NAN,
               .of_peak = share_of_peak(bench, contestant, kernel_rate, 1 / time.cpu),
               .of_issue = share_of_issue(bench, contestant, kernel_rate),
               .rate = 1 / time.wall,
               .rate_min = 1 / time.wall_max,
               .rate_max = 1 / time.wall_min,
               .spread = time.wall / time.wall_min - time.wall / time.wall_max,
               .cpu_rate = 1 / time.cpu};
}

static Row torch_row_of(const Bench *bench, const LabTorchNetwork *torch) {
  AppBenchTime time = app_bench_timer_time(&torch->timer, bench->options->common.repeats);
  return (Row){.model = torch->model,
               .set = "network alone",
               .quantity = quantities[torch->quantity],
               .residence = "device",
               .device = torch->name,
               .batch = torch->batch,
               .handed_on = NAN,
               .to_host = NAN,
               .kernel_rate = NAN,
               .gate = NAN,
               .of_peak = NAN,
               .of_issue = NAN,
               .rate = 1 / time.wall,
               .rate_min = 1 / time.wall_max,
               .rate_max = 1 / time.wall_min,
               .spread = time.wall / time.wall_min - time.wall / time.wall_max,
               .cpu_rate = 1 / time.cpu};
}

static Status print(const Bench *bench) {
  const int count = bench->count + bench->torch_count;
  Row *rows = memory_zeroed((size_t)count, sizeof *rows);
  if (!rows) return status_no_memory("the rows");
  for (int c = 0; c < bench->count; c++) rows[c] = row_of(bench, &bench->contestants[c]);
  for (int t = 0; t < bench->torch_count; t++)
    rows[bench->count + t] = torch_row_of(bench, &bench->torches[t]);
  Status status = app_bench_report_print(&report, &bench->options->common, rows, count);
  memory_free(rows);
  return status;
}

// --- The bench.

static void add_contestants(Bench *bench, int set, int batch) {
  const Options *options = bench->options;
  for (int residence = 0; residence < RESIDENCE_COUNT; residence++)
    for (int quantity = 0; quantity < QUANTITY_COUNT; quantity++)
      for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++) {
        bool is_wanted = options->wants_residence[residence] && options->wants_model[m] &&
                         options->wants_quantity[quantity] &&
                         device_overlap_gives(device_overlap_models[m], (DeviceQuantity)quantity);
        if (!is_wanted) continue;
        bench->contestants[bench->count++] = (Contestant){.overlap = &bench->overlaps[m],
                                                          .pairs = bench->pairs,
                                                          .volume = bench->volume,
                                                          .more = bench->gradient,
                                                          .model = device_overlap_models[m],
                                                          .set = app_bench_sets[set],
                                                          .residence = residence,
                                                          .batch = batch,
                                                          .quantity = (DeviceQuantity)quantity};
      }
}

// PyTorch with the networks of the models that are wanted. False: it is not there, and that is said.
static bool add_torches(Bench *bench, int batch) {
  const Options *options = bench->options;
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++)
    for (int quantity = 0; quantity <= DEVICE_GRADIENT && options->wants_model[m]; quantity++) {
      LabTorchNetwork *torch = &bench->torches[bench->torch_count];
      if (!options->wants_quantity[quantity] || !device_overlap_weights(&bench->overlaps[m])) continue;
      Status status = lab_torch_network_start(torch, &bench->overlaps[m], (DeviceQuantity)quantity, batch,
                                              options->common.threads);
      if (status != STATUS_OK) {
        log_warning("PyTorch is left out: %s", status_message());
        lab_torch_network_stop(torch);
        return false;
      }
      torch->model = device_overlap_models[m];
      bench->torch_count++;
    }
  return true;
}

static Status measure_sets(Bench *bench) {
  const Options *options = bench->options;
  bool wants_torch = options->wants_torch;
  for (int set = 0; set < APP_BENCH_SET_COUNT; set++) {
    for (int b = 0; b < options->batches.count && options->wants_set[set]; b++) {
      int first = bench->count, first_torch = bench->torch_count;
      TRY(app_bench_pairs_fill(app_bench_sets[set], options->batches.numbers[b], SEED, bench->pairs));
      add_contestants(bench, set, options->batches.numbers[b]);
      if (wants_torch) wants_torch = add_torches(bench, options->batches.numbers[b]);
      TRY(take_rounds(bench, first, first_torch));
    }
    wants_torch = wants_torch && !options->wants_set[set]; // once: it is not shown pairs
  }
  if (bench->count == 0)
    return status_fail(
        STATUS_USAGE,
        "a device answers V and V+grad of clip, clip32, tpn, tpn-published, tpn-bf16, geo-small and geo, "
        "V+centroid of all but the tpns: nothing to measure");
  return print(bench);
}

static Status make_inputs(Bench *bench) {
  const Options *options = bench->options;
  size_t most = (size_t)app_bench_list_largest(&options->batches);
  int rows =
      APP_BENCH_SET_COUNT * RESIDENCE_COUNT * QUANTITY_COUNT * DEVICE_OVERLAP_MODELS * options->batches.count;
  bench->contestants = memory_zeroed((size_t)rows, sizeof *bench->contestants);
  bench->torches = memory_zeroed((size_t)rows, sizeof *bench->torches);
  bench->pairs = memory_zeroed(most * 24, sizeof(double));
  bench->columns = memory_zeroed(most * 24, sizeof(double));
  bench->gradient = memory_zeroed(most * 24, sizeof(double));
  bench->volume = memory_zeroed(most, sizeof(double));
  bench->tets = memory_zeroed(most * 8, sizeof(int));
  bench->ends = memory_zeroed(most * 2, sizeof(int));
  if (!bench->contestants || !bench->torches || !bench->pairs || !bench->columns || !bench->gradient ||
      !bench->volume || !bench->tets || !bench->ends)
    return status_no_memory("the batch (--batch)");
  for (size_t k = 0; k < most * 8; k++) bench->tets[k] = (int)k;
  for (size_t k = 0; k < most * 2; k++) bench->ends[k] = (int)k;
  return STATUS_OK;
}

// The maker's figure where the driver names the kind of GPU; else what is measured.
static Status find_peak(Bench *bench) {
  const DeviceInfo *info = &bench->device.info;
  double *peak = bench->peak;
  memcpy(peak, info->peak, sizeof info->peak);
  if (peak[DEVICE_IN_DOUBLE] > 0) return STATUS_OK;
  if (info->is_gpu)
    TRY(device_peak_measure(&bench->device, peak));
  else
    for (int k = 0; k < 2; k++) peak[k == 0 ? DEVICE_IN_FLOAT : DEVICE_IN_DOUBLE] = lab_peak_measure(k == 0);
  peak[DEVICE_IN_BF16] = peak[DEVICE_IN_FLOAT]; // an emulated product is some in float
  return STATUS_OK;
}

static Status measure(Bench *bench) {
  const Options *options = bench->options;
  omp_set_num_threads(options->common.threads);
  TRY(device_open(&bench->device, options->device));
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++)
    if (options->wants_model[m])
      TRY(device_overlap_create(&bench->overlaps[m], &bench->device, device_overlap_models[m]));
  TRY(make_inputs(bench));
  TRY(find_peak(bench));
  return measure_sets(bench);
}

static void destroy(Bench *bench) {
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++) device_overlap_destroy(&bench->overlaps[m]);
  device_close(&bench->device);
  for (int t = 0; t < bench->torch_count; t++) lab_torch_network_stop(&bench->torches[t]);
  memory_free(bench->torches);
  memory_free(bench->contestants), memory_free(bench->pairs), memory_free(bench->columns);
  memory_free(bench->gradient), memory_free(bench->volume), memory_free(bench->tets);
  memory_free(bench->ends), memory_free(bench);
}

static Status run(const Options *options) {
  Bench *bench = memory_zeroed(1, sizeof *bench);
  if (!bench) return status_no_memory("the bench");
  bench->options = options;
  Status status = measure(bench);
  destroy(bench);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.common = app_bench_options_default(), .batches = {{4096}, 1}};
  for (int m = 0; m < DEVICE_OVERLAP_MODELS; m++) options.wants_model[m] = true;
  for (int i = 0; i < APP_BENCH_SET_COUNT; i++) options.wants_set[i] = true;
  for (int i = 0; i < QUANTITY_COUNT; i++) options.wants_quantity[i] = options.wants_residence[i] = true;
  app_cli_parse(&lab_device, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_device = {
    .name = "device",
    .help = "kernels of overlap models on a device: pairs of tetrahedra a second",
    .options = option_table,
    .arguments =
        &(const AppArguments){"DEVICE", offsetof(Options, device), 1,
                              .missing =
                                  "name a device: host, opencl, cuda or auto; `tetlap devices` lists them",
                              .excess = "one device at a time; '%s' is the second"},
    .doc = "Measure how many pairs of tetrahedra a second a device answers: host, "
           "opencl, cuda or auto, with a number where there are several, as in opencl:1.",
    .run = run_command,
    .has_threads = true,
    .rows = &report,
    .describe_rows = app_bench_report_describe};
