// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab net`: networks alone, without geometry: our kernels beside PyTorch with the same weights and
// inputs, in the same run, and their share of a core's peak.
#include "lab/program.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "app/bench/report.h"
#include "app/bench/timer.h"
#include "app/cli/parse.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "base/memory.h"
#include "base/random.h"
#include "lab/peak.h"
#include "lab/torch/peer.h"
#include "net/net.h"
#include "overlap/tpn/network.h"
#include "overlap/weights.h"

// Of a TetrahedronPairNet each kernel also computes the folded network (net/pass/fold.h): its normalisation
// makes the first tetrahedron the same for all pairs, here as in its overlap model.
enum { MAX_NETS = 16, QUANTITY_COUNT = 2, TORCH = 2 * NET_KERNEL_COUNT, IMPLEMENTATIONS };
static const char *const quantities[QUANTITY_COUNT] = {"V", "V+grad"};
static const double ROUND_S = 0.1; // what a round shall take
static const uint64_t SEED = 5;

typedef struct Options {
  AppBenchOptions common;
  const char *nets[MAX_NETS]; // names or weights files
  int net_count;
  bool wants_quantity[QUANTITY_COUNT], leaves_torch_out;
  AppBenchList batches;
} Options;

static const AppOption option_table[] = {
    {"net", 'm', "NAME,...", "Networks, by shipped name or weights file (default: tpn,geo,geo-small)", 1,
     CLI_LIST, CLI_TO(Options, nets), .most = MAX_NETS, .example = "tpn,geo",
     .count_offset = offsetof(Options, net_count)},
    {"quantity", 'Q', "NAME,...", "V, V+grad: outputs, and their derivative by the inputs (default: both)", 1,
     CLI_CHOICES, CLI_TO(Options, wants_quantity), .most = QUANTITY_COUNT, .choices = quantities},
    {"batch", 'b', "N,...", "Samples a call (default: 2048, the paper's)", 1, CLI_OWN,
     CLI_TO(Options, batches), .read = app_bench_options_read_batches},
    {"no-torch", 0, NULL, "Leave PyTorch out", 1, CLI_FLAG, CLI_TO(Options, leaves_torch_out)},
    {.table = app_bench_options, .offset = offsetof(Options, common)},
    {0},
};

// A network in the precision that the overlap models compute it in: TetrahedronPairNet in float, `geo` in
// double.
typedef struct Net {
  const char *name;
  char path[512];
  bool is_float;
  NetModel_f32 narrow;
  NetModel_f64 wide;
  const NetPlan *plan; // of the one that is there, borrowed
  void *inputs;        // (largest batch, input_count), owned
  size_t input_bytes;
  void *seeds;          // c of the derivative: 1 for the last output (largest batch, output_count), owned
  const double *first;  // the first tetrahedron of all inputs, NULL where they differ
  NetModel_f32 folded;  // where there is one
  float *second_inputs; // (largest batch, 12), the inputs without the first tetrahedron; owned
} Net;

typedef struct Contestant {
  const Net *net;
  int implementation; // a NetKernelKind, of the folded network NET_KERNEL_COUNT more, or TORCH
  int quantity, batch, threads, calls;
  NetWork_f32 narrow;
  NetWork_f64 wide;
  LabTorchPeer *torch;       // borrowed
  void *outputs, *gradients; // shared by all contestants
  double check;              // mean of the absolute results
  AppBenchTimer timer;
} Contestant;

typedef struct Bench {
  const Options *options;
  Net nets[MAX_NETS];
  int net_count;
  LabTorchPeer torches[MAX_NETS][APP_BENCH_MAX_LIST]; // for every number of threads
  Contestant *contestants;
  int count;
  void *outputs, *gradients;
} Bench;

static Status fail_as_net(NetStatus status) {
  return status == NET_OK ? STATUS_OK : status_fail(STATUS_INPUT, "%s", net_status_message());
}

static Status make_inputs(Net *net, int count) {
  size_t numbers = (size_t)count * (size_t)net->plan->shape.input_count;
  net->input_bytes = numbers * (net->is_float ? sizeof(float) : sizeof(double));
  net->inputs = memory_zeroed(net->input_bytes, 1);
  if (!net->inputs) return status_no_memory("the inputs (--batch)");
  Random random = random_seeded(SEED, 0);
  for (size_t i = 0; i < numbers; i++) {
    double x = random_between(&random, -1, 1);
    if (net->first && i % 24 < 12) x = net->first[i % 24];
    if (net->is_float)
      ((float *)net->inputs)[i] = (float)x;
    else
      ((double *)net->inputs)[i] = x;
  }
  return STATUS_OK;
}

static Status fold(Net *net, int count) {
  float first[12];
  for (int i = 0; i < 12; i++) first[i] = (float)net->first[i];
  TRY(fail_as_net(net_fold_create_f32(&net->narrow, first, &net->folded)));
  net->second_inputs = memory_zeroed((size_t)count * 12, sizeof *net->second_inputs);
  if (!net->second_inputs) return status_no_memory("the inputs (--batch)");
  for (int s = 0; s < count; s++)
    memcpy(net->second_inputs + (ptrdiff_t)s * 12, (const float *)net->inputs + (ptrdiff_t)s * 24 + 12,
           12 * sizeof(float));
  return STATUS_OK;
}

// What a TetrahedronPairNet's normalisation makes of every first tetrahedron.
static const double *first_of(const Net *net, const NetCard *card) {
  OverlapTpnNormalisation kind;
  double scale;
  const NetShape *shape = &net->narrow.plan->shape;
  if (shape->kind != NET_TPN || shape->has_one_tetrahedron ||
      !overlap_tpn_network_parse(card->normalisation, &kind, &scale))
    return NULL;
  return overlap_tpn_normalise_first(kind);
}

static Status read_net(Net *net, const char *name, int count) {
  NetCard card = {0};
  net->name = name;
  if (overlap_weights_is_path(name)) {
    if (snprintf(net->path, sizeof net->path, "%s", name) >= (int)sizeof net->path)
      return status_fail(STATUS_USAGE, "%s: the path is too long", name);
  } else {
    TRY(overlap_weights_find(name, net->path, sizeof net->path));
  }
  NetStatus status = net_weights_read_f32(net->path, &net->narrow, &card);
  if (status == NET_OK) net->first = first_of(net, &card);
  net_weights_card_destroy(&card);
  TRY(fail_as_net(status));
  net->is_float = net->narrow.plan->shape.kind == NET_TPN;
  if (!net->is_float) {
    card = (NetCard){0};
    status = net_weights_read_f64(net->path, &net->wide, &card);
    net_weights_card_destroy(&card);
    TRY(fail_as_net(status));
  }
  net->plan = net->is_float ? net->narrow.plan : net->wide.plan;
  TRY(make_inputs(net, count));
  return net->first ? fold(net, count) : STATUS_OK;
}

// Networks whose weights are not there are left out, by name.
static Status read_nets_in(Bench *bench) {
  int count = app_bench_list_largest(&bench->options->batches);
  for (int n = 0; n < bench->options->net_count; n++) {
    Status status = read_net(&bench->nets[bench->net_count], bench->options->nets[n], count);
    if (status == STATUS_IO)
      log_warning("left out: %s", status_message());
    else
      bench->net_count++;
    if (status != STATUS_IO) TRY(status);
  }
  return bench->net_count > 0 ? STATUS_OK : status_fail(STATUS_IO, "there is no network to measure");
}

static Status start_torch(Bench *bench) {
  for (int n = 0; n < bench->net_count && !bench->options->leaves_torch_out; n++)
    for (int t = 0; t < bench->options->common.thread_list.count; t++) {
      const Net *net = &bench->nets[n];
      const LabTorchDef def = {.weights = net->path,
                               .precision = net->is_float ? LAB_TORCH_FLOAT : LAB_TORCH_DOUBLE,
                               .device = "cpu",
                               .inputs = net->inputs,
                               .size = net->input_bytes,
                               .threads = bench->options->common.thread_list.numbers[t]};
      Status status = lab_torch_peer_start(&bench->torches[n][t], &def);
      if (status == STATUS_OK) continue;
      lab_torch_peer_stop(&bench->torches[n][t]);
      if (status != STATUS_IO) return status;
      log_warning("left out: PyTorch: %s", status_message());
      return STATUS_OK;
    }
  return STATUS_OK;
}

static bool is_folded(const Contestant *contestant) {
  return contestant->implementation >= NET_KERNEL_COUNT && contestant->implementation != TORCH;
}

static const NetModel_f32 *narrow_of(const Contestant *contestant) {
  return is_folded(contestant) ? &contestant->net->folded : &contestant->net->narrow;
}

static NetKernelKind kernel_of(const Contestant *contestant) {
  return (NetKernelKind)(contestant->implementation % NET_KERNEL_COUNT);
}

// Whether this implementation has this network; its memory is made then.
static Status begin(Contestant *contestant, bool *is_there) {
  const Net *net = contestant->net;
  *is_there = false;
  if (contestant->implementation == TORCH) {
    *is_there = contestant->torch->child != 0;
    return STATUS_OK;
  }
  NetWorkDef def = net_work_default();
  def.kernel = kernel_of(contestant);
  def.thread_count = contestant->threads;
  if (!net_kernel_is_available(def.kernel) || (is_folded(contestant) && !net->first)) return STATUS_OK;
  NetStatus status = net->is_float
                         ? net_work_create_f32(narrow_of(contestant)->plan, &def, &contestant->narrow)
                         : net_work_create_f64(net->plan, &def, &contestant->wide);
  if (status == NET_BAD_ARGUMENT) return STATUS_OK; // a kernel that has not this precision
  TRY(fail_as_net(status));
  *is_there = true;
  return STATUS_OK;
}

static Status add(Bench *bench, Contestant contestant, int n, int t) {
  contestant.net = &bench->nets[n];
  contestant.torch = &bench->torches[n][t];
  contestant.threads = bench->options->common.thread_list.numbers[t];
  contestant.outputs = bench->outputs, contestant.gradients = bench->gradients;
  bench->contestants[bench->count] = contestant;
  bool is_there;
  TRY(begin(&bench->contestants[bench->count], &is_there));
  bench->count += is_there;
  return STATUS_OK;
}

static Status add_all(Bench *bench) {
  const Options *options = bench->options;
  for (int n = 0; n < bench->net_count; n++)
    for (int q = 0; q < QUANTITY_COUNT; q++)
      for (int b = 0; b < options->batches.count && options->wants_quantity[q]; b++)
        for (int t = 0; t < options->common.thread_list.count; t++)
          for (int i = 0; i < IMPLEMENTATIONS; i++) {
            Contestant contestant = {
                .implementation = i, .quantity = q, .batch = options->batches.numbers[b]};
            TRY(add(bench, contestant, n, t));
          }
  return STATUS_OK;
}

// The derivative is that of the last output: of TetrahedronPairNet V.
static Status make_seeds(Net *net, size_t batch) {
  size_t outputs = (size_t)net->plan->shape.output_count;
  net->seeds = memory_zeroed(batch * outputs, sizeof(double));
  if (!net->seeds) return status_no_memory("the batch (--batch)");
  for (size_t i = 0; i < batch; i++)
    if (net->is_float)
      ((float *)net->seeds)[i * outputs + outputs - 1] = 1;
    else
      ((double *)net->seeds)[i * outputs + outputs - 1] = 1;
  return STATUS_OK;
}

static Status make(Bench *bench) {
  const Options *options = bench->options;
  size_t batch = (size_t)app_bench_list_largest(&options->batches), widest = 1, most = 1;
  TRY(read_nets_in(bench));
  for (int n = 0; n < bench->net_count; n++) {
    size_t inputs = (size_t)bench->nets[n].plan->shape.input_count;
    size_t outputs = (size_t)bench->nets[n].plan->shape.output_count;
    widest = inputs > widest ? inputs : widest, most = outputs > most ? outputs : most;
    TRY(make_seeds(&bench->nets[n], batch));
  }
  bench->contestants = memory_zeroed((size_t)(bench->net_count * QUANTITY_COUNT * options->batches.count *
                                                  options->common.thread_list.count * IMPLEMENTATIONS +
                                              1),
                                     sizeof *bench->contestants);
  bench->outputs = memory_zeroed(batch * most, sizeof(double));
  bench->gradients = memory_zeroed(batch * widest, sizeof(double));
  if (!bench->contestants || !bench->outputs || !bench->gradients)
    return status_no_memory("the batch (--batch)");
  TRY(start_torch(bench));
  return add_all(bench);
}

static void call(Contestant *c) {
  const Net *net = c->net;
  const float *x = is_folded(c) ? net->second_inputs : net->inputs; // read as float only where it is
  if (c->quantity == 0 && net->is_float)
    net_forward_eval_f32(&c->narrow, narrow_of(c), c->batch, x, c->outputs);
  else if (c->quantity == 0)
    net_forward_eval_f64(&c->wide, &net->wide, c->batch, net->inputs, c->outputs);
  else if (net->is_float)
    net_forward_gradient_f32(&c->narrow, narrow_of(c), c->batch, x, net->seeds, c->outputs, c->gradients);
  else
    net_forward_gradient_f64(&c->wide, &net->wide, c->batch, net->inputs, net->seeds, c->outputs,
                             c->gradients);
}

static double mean_of(const Contestant *c) {
  const NetShape *shape = is_folded(c) ? &c->net->folded.plan->shape : &c->net->plan->shape;
  size_t count = (size_t)c->batch * (size_t)(c->quantity == 0 ? shape->output_count : shape->input_count);
  const void *numbers = c->quantity == 0 ? c->outputs : c->gradients;
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += fabs(c->net->is_float ? (double)((const float *)numbers)[i] : ((const double *)numbers)[i]);
  return sum / (double)count;
}

static Status ask_torch(Contestant *c, int calls, LabTorchTime *time) {
  TRY(lab_torch_peer_time(c->torch, quantities[c->quantity], c->batch, calls, time));
  c->check = time->check;
  return STATUS_OK;
}

// How many calls fill a round, from the second call: the first wakes threads and loads caches.
static Status find_calls(Contestant *c) {
  double seconds = 0;
  for (int attempt = 0; attempt < 2; attempt++) {
    LabTorchTime time;
    double began = clock_wall_s();
    if (c->implementation == TORCH)
      TRY(ask_torch(c, 1, &time));
    else
      call(c);
    seconds = c->implementation == TORCH ? time.wall_s : clock_wall_s() - began;
  }
  c->calls = (int)fmin(1e6, fmax(1, ROUND_S / (seconds + 1e-9)));
  return STATUS_OK;
}

static Status take_turn(void *self, int round) {
  Contestant *c = self;
  omp_set_num_threads(c->threads);
  if (c->calls == 0) TRY(find_calls(c));
  double samples = (double)c->calls * c->batch;
  if (c->implementation == TORCH) {
    LabTorchTime time;
    TRY(ask_torch(c, c->calls, &time));
    c->timer.wall[round] = time.wall_s / samples, c->timer.cpu[round] = time.cpu_s / samples;
    return STATUS_OK;
  }
  app_bench_timer_start(&c->timer);
  for (int k = 0; k < c->calls; k++) call(c);
  app_bench_timer_stop(&c->timer, round, samples);
  c->check = mean_of(c);
  return STATUS_OK;
}

typedef struct Row {
  const char *net, *implementation, *precision, *quantity;
  long long batch, threads, parameters;
  double rate, cpu_rate, spread, ratio, ratio_min, ratio_max, cpu_ratio, flops, gflops, share, difference;
} Row;

static const AppTableColumn columns[] = {
    {"net", APP_TABLE_TEXT, offsetof(Row, net), "net", "name or weights file"},
    {"implementation", APP_TABLE_TEXT, offsetof(Row, implementation), "by",
     "a kernel of ours, or PyTorch and its version; folded: the first tetrahedron, the same in all inputs, "
     "once for all"},
    {"precision", APP_TABLE_TEXT, offsetof(Row, precision), NULL, "float, double or bf16"},
    {"parameters", APP_TABLE_INTEGER, offsetof(Row, parameters), NULL, "of the network"},
    {"quantity", APP_TABLE_TEXT, offsetof(Row, quantity), "quantity",
     "V: outputs; V+grad: and the last one's derivative by the inputs"},
    {"batch", APP_TABLE_INTEGER, offsetof(Row, batch), "batch", "samples a call"},
    {"threads", APP_TABLE_INTEGER, offsetof(Row, threads), "threads", "threads"},
    {"samples_per_second", APP_TABLE_NUMBER, offsetof(Row, rate), "samples/s", "of wall time"},
    {"samples_per_cpu_second", APP_TABLE_NUMBER, offsetof(Row, cpu_rate), "samples/cpu s",
     "of processor time"},
    {"spread", APP_TABLE_NUMBER, offsetof(Row, spread), "spread", "(max − min) / median"},
    {"ratio_to_torch", APP_TABLE_NUMBER, offsetof(Row, ratio), "× PyTorch",
     "speed over PyTorch's in the same round, median of the rounds"},
    {"ratio_to_torch_min", APP_TABLE_NUMBER, offsetof(Row, ratio_min), NULL, "smallest of the rounds"},
    {"ratio_to_torch_max", APP_TABLE_NUMBER, offsetof(Row, ratio_max), NULL, "largest of the rounds"},
    {"cpu_ratio_to_torch", APP_TABLE_NUMBER, offsetof(Row, cpu_ratio), NULL,
     "the same of processor times, median of the rounds"},
    {"flops", APP_TABLE_NUMBER, offsetof(Row, flops), NULL,
     "of a sample's matrix products: multiplications and additions"},
    {"gflops", APP_TABLE_NUMBER, offsetof(Row, gflops), "Gflop/s", "those a second"},
    {"peak_share", APP_TABLE_NUMBER, offsetof(Row, share), "of peak",
     "those a processor second over what one core can do in this precision (measured in this run)"},
    {"difference", APP_TABLE_NUMBER, offsetof(Row, difference), NULL,
     "of the mean absolute result from PyTorch's, relative: the same weights were computed"},
};
static const AppBenchReport report = {"net", columns, sizeof columns / sizeof *columns, sizeof(Row), true};

static const Contestant *find_torch(const Bench *bench, const Contestant *like) {
  for (int c = 0; c < bench->count; c++) {
    const Contestant *other = &bench->contestants[c];
    if (other->implementation == TORCH && other->net == like->net && other->quantity == like->quantity &&
        other->batch == like->batch && other->threads == like->threads)
      return other;
  }
  return NULL;
}

static const char *name_of(const Contestant *c) {
  static const char *const folded[NET_KERNEL_COUNT] = {"blas, folded", "avx2, folded", "avx512, folded",
                                                       "bf16, folded"};
  if (c->implementation == TORCH) return c->torch->name;
  return is_folded(c) ? folded[kernel_of(c)] : net_kernel_name(kernel_of(c));
}

static Row row_of(const Bench *bench, const Contestant *c, const double peaks[2]) {
  int rounds = bench->options->common.repeats;
  AppBenchTime time = app_bench_timer_time(&c->timer, rounds);
  const Contestant *torch = find_torch(bench, c);
  AppBenchRatio ratio = {NAN, NAN, NAN};
  double cpu_ratio = NAN;
  if (torch) ratio = app_bench_timer_ratio(&c->timer, &torch->timer, rounds);
  if (torch) cpu_ratio = app_bench_timer_cpu_ratio(&c->timer, &torch->timer, rounds).median;
  bool is_bf16 = c->implementation != TORCH && kernel_of(c) == NET_KERNEL_BF16;
  bool is_comparable = torch && !(is_folded(c) && c->quantity == 1); // it has fewer derivatives
  const NetPlan *plan = is_folded(c) ? c->net->folded.plan : c->net->plan;
  double flops = plan->flops * (c->quantity == 0 ? 1 : 2), gflops = 1e-9 * flops / time.wall,
         peak = is_bf16 ? NAN : peaks[c->net->is_float];
  return (Row){.net = c->net->name,
               .implementation = name_of(c),
               .precision = is_bf16            ? "bf16"
                            : c->net->is_float ? "float"
                                               : "double",
               .parameters = (long long)c->net->plan->parameter_count,
               .quantity = quantities[c->quantity],
               .batch = c->batch,
               .threads = c->threads,
               .rate = 1 / time.wall,
               .cpu_rate = 1 / time.cpu,
               .spread = (time.wall_max - time.wall_min) / time.wall,
               .ratio = ratio.median,
               .ratio_min = ratio.min,
               .ratio_max = ratio.max,
               .cpu_ratio = cpu_ratio,
               .flops = flops,
               .gflops = gflops,
               .share = flops / time.cpu / peak,
               .difference = is_comparable ? fabs(c->check / torch->check - 1) : NAN};
}

static Status print(const Bench *bench) {
  const double peaks[2] = {lab_peak_measure(false), lab_peak_measure(true)};
  Row *rows = memory_zeroed((size_t)bench->count, sizeof *rows);
  if (!rows) return status_no_memory("the rows");
  for (int c = 0; c < bench->count; c++) rows[c] = row_of(bench, &bench->contestants[c], peaks);
  Status status = app_bench_report_print(&report, &bench->options->common, rows, bench->count);
  memory_free(rows);
  return status;
}

static void destroy(Bench *bench) {
  for (int c = 0; c < bench->count; c++) {
    net_work_destroy_f32(&bench->contestants[c].narrow);
    net_work_destroy_f64(&bench->contestants[c].wide);
  }
  for (int n = 0; n < MAX_NETS; n++) {
    for (int t = 0; t < APP_BENCH_MAX_LIST; t++) lab_torch_peer_stop(&bench->torches[n][t]);
    net_model_destroy_f32(&bench->nets[n].narrow), net_model_destroy_f64(&bench->nets[n].wide);
    net_model_destroy_f32(&bench->nets[n].folded);
    memory_free(bench->nets[n].seeds);
    memory_free(bench->nets[n].inputs), memory_free(bench->nets[n].second_inputs);
  }
  memory_free(bench->contestants), memory_free(bench->outputs), memory_free(bench->gradients);
  memory_free(bench);
}

static Status measure(Bench *bench) {
  TRY(make(bench));
  TRY(app_bench_timer_take_turns(bench->contestants, sizeof *bench->contestants, bench->count,
                                 bench->options->common.repeats, take_turn));
  return print(bench);
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
  Options options = {.common = app_bench_options_default(),
                     .nets = {"tpn", "geo", "geo-small"},
                     .net_count = 3,
                     .wants_quantity = {true, true},
                     .batches = {{2048}, 1}};
  options.common.takes_thread_list = true;
  app_cli_parse(&lab_net, argument_count, arguments, &options);
  return app_cli_command_end(run(&options));
}

const AppCommand lab_net = {
    .name = "net",
    .help = "networks alone, beside PyTorch: samples a second",
    .options = option_table,
    .doc = "Measure networks without their geometry, by our kernels and by PyTorch where it is installed.",
    .run = run_command,
    .has_threads = true,
    .rows = &report,
    .describe_rows = app_bench_report_describe};
