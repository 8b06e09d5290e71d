// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "app/job/job.h"
#include "base/log.h"
#include "base/machine/clock.h"
#include "datagen/run.h"

enum { BAR_WIDTH = 24 };

typedef struct Shard {
  int number, count; // number from 1
} Shard;

typedef struct Options {
  DatagenLaw law;
  const char *mix, *volume, *output; // NULL: the law's; the law's; not given
  double swap_share;                 // NaN: the law's
  long long count;                   // 0: the law's
  uint64_t seed;
  DatagenLabel label;
  bool has_label, wants_gradient, is_quiet, lists;
  Shard shard;
  int threads; // 0: all
} Options;

static DatagenLabel model_of(struct argp_state *state, const char *option, const char *text) {
  if (strcmp(text, "exact") == 0) return DATAGEN_LABEL_EXACT;
  if (strcmp(text, "clip") == 0) return DATAGEN_LABEL_CLIP;
  argp_error(state, "--%s is '%s'; give exact or clip%s", option, text,
             strcmp(option, "gradient") == 0 ? ", or none" : "");
  return DATAGEN_LABEL_EXACT;
}

static void set_label(struct argp_state *state, Options *options, const char *option, const char *text) {
  DatagenLabel label = model_of(state, option, text);
  if (options->has_label && label != options->label)
    argp_error(state, "--label and --gradient name different models; V and its derivatives have one");
  options->label = label;
  options->has_label = true;
}

static void read_gradient(struct argp_state *state, void *options, char *text) {
  ((Options *)options)->wants_gradient = strcmp(text, "none") != 0;
  if (((Options *)options)->wants_gradient) set_label(state, options, "gradient", text);
}

static void read_label(struct argp_state *state, void *options, char *text) {
  set_label(state, options, "label", text);
}

static void read_law(struct argp_state *state, void *law, char *text) {
  if (datagen_law_find(text, law) != STATUS_OK) argp_error(state, "%s", status_message());
}

static void read_shard(struct argp_state *state, void *member, char *text) {
  Shard *shard = member;
  int used = 0;
  if (sscanf(text, "%d/%d%n", &shard->number, &shard->count, &used) != 2 || text[used] || shard->number < 1 ||
      shard->number > shard->count || shard->count > 1000000)
    argp_error(state, "--shard is '%s'; give I/N with I from 1 to N, as in 3/16", text);
}

static const AppOption option_table[] = {
    {"law", 'l', "NAME", "What the pairs are: paper-train (default), paper-test, scene, uniform", 0, CLI_OWN,
     CLI_TO(Options, law), .read = read_law},
    {"count", 'n', "N", "Pairs in all (default: the law's)", 0, CLI_INTEGER, CLI_TO(Options, count), 1,
     INFINITY},
    {"seed", 's', "S", "A number; the same gives the same pairs (default: 1)", 0, CLI_SEED,
     CLI_TO(Options, seed)},
    {"output", 'o', "FILE", "The HDF5 file to write", 0, CLI_TEXT, CLI_TO(Options, output)},
    {"threads", 't', "N", "Threads (default: all); the pairs do not depend on it", 0, CLI_INTEGER,
     CLI_TO(Options, threads), 1, APP_CLI_MOST_THREADS},
    {"shard", 0, "I/N", "Make part I of N only, I from 1; `tetlap dataset merge` joins them", 0, CLI_OWN,
     CLI_TO(Options, shard), .read = read_shard},
    {"gradient", 0, "MODEL", "Also the 24 derivatives of V: none (default), clip, exact", 0, CLI_OWN,
     .size = sizeof(Options), .read = read_gradient},
    {"label", 0, "MODEL", "What V is computed with: exact (default), clip", 0, CLI_OWN,
     .size = sizeof(Options), .read = read_label},
    {"mix", 0, "KIND=SHARE,...", "Shares of the kinds, instead of the law's", 0, CLI_WORDS,
     CLI_TO(Options, mix), .example = "none=50,volumetric=50"},
    {"volume", 0, "LAW", "Law of the volumetric pairs' V: log-uniform:LOW:HIGH, uniform:LOW:HIGH, natural", 0,
     CLI_TEXT, CLI_TO(Options, volume)},
    {"swap", 0, "SHARE", "Exchange the two tetrahedra in this share of the pairs (default: 0)", 0, CLI_NUMBER,
     CLI_TO(Options, swap_share), 0, 1},
    {"list", 0, NULL, "List laws and kinds", 0, CLI_FLAG, CLI_TO(Options, lists)},
    {"quiet", 'q', NULL, "Say errors only", 0, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

static void list_names(void) {
  int count;
  const DatagenLaw *laws = datagen_law_list(&count);
  printf("laws\n");
  for (int k = 0; k < count; k++) {
    char mix[DATAGEN_MIX_TEXT], volume[DATAGEN_VOLUME_TEXT];
    datagen_law_print_mix(laws[k].mix, mix, sizeof mix);
    datagen_volume_law_print(&laws[k].volume, volume, sizeof volume);
    printf("  %-14s %s\n  %14s %lld pairs, --mix %s\n  %14s --volume %s\n", laws[k].name, laws[k].help, "",
           laws[k].default_count, mix, "", volume);
  }
  printf("kinds\n");
  for (int k = 0; k < DATAGEN_CAPTURED; k++)
    printf("  %-14s %s\n", datagen_kind_info(k)->name, datagen_kind_info(k)->help);
}

typedef struct Progress {
  double began_s;
} Progress;

static void show_progress(void *observer, const DatagenProgress *progress) {
  const Progress *state = observer;
  double seconds = clock_wall_s() - state->began_s,
         share = (double)progress->done / (double)progress->planned;
  double rate = seconds > 0 ? (double)progress->done / seconds : 0;
  char bar[BAR_WIDTH + 1];
  for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < share * BAR_WIDTH ? '#' : '.';
  bar[BAR_WIDTH] = 0;
  log_progress("[%s] %3.0f %%  %lld of %lld pairs  %.0f pairs/s  %.0f s left", bar, 100 * share,
               progress->done, progress->planned, rate,
               rate > 0 ? (double)(progress->planned - progress->done) / rate : 0);
}

static Status plan_of(const Options *options, DatagenPlan *plan) {
  DatagenLaw law = options->law;
  if (options->mix) TRY(datagen_law_parse_mix(law.mix, options->mix));
  if (options->volume) TRY(datagen_volume_law_parse(&law.volume, options->volume));
  if (!isnan(options->swap_share)) law.swap_share = options->swap_share;
  TRY(datagen_plan_make(plan, &law, options->seed, options->count ? options->count : law.default_count));
  plan->label = options->label;
  plan->wants_gradient = options->wants_gradient;
  return STATUS_OK;
}

static Status make(const Options *options) {
  char program[64];
  DatagenPlan plan;
  TRY(plan_of(options, &plan));
  snprintf(program, sizeof program, "tetlap %s", app_versions_program());
  Progress progress = {clock_wall_s()};
  DatagenRunOptions run = {.path = options->output,
                           .program = program,
                           .stop = app_job_stop_flag(),
                           .observe = show_progress,
                           .observer = &progress};
  datagen_plan_shard(&plan, options->shard.number, options->shard.count, &run.first, &run.count);
  if (run.count == 0)
    return status_fail(STATUS_USAGE, "%lld pairs in %d parts leave none for part %d", plan.count,
                       options->shard.count, options->shard.number);
  Status status = datagen_run(&plan, &run);
  log_progress_end();
  double seconds = clock_wall_s() - progress.began_s;
  if (!status)
    log_info("%s: %lld pairs of law %s, seed %llu, in %.1f s (%.0f pairs/s)", options->output, run.count,
             plan.law.name, (unsigned long long)plan.seed, seconds, (double)run.count / seconds);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (!options->output && !options->lists) argp_error(state, "name the file to write, as in -o pairs.h5");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.seed = 1, .swap_share = NAN, .shard = {1, 1}};
  datagen_law_find("paper-train", &options.law);
  app_cli_parse(&app_command_datagen, argument_count, arguments, &options);
  if (options.lists) {
    list_names();
    return 0;
  }
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  if (options.threads) omp_set_num_threads(options.threads);
  return app_cli_command_end(make(&options));
}

const AppCommand app_command_datagen = {
    .name = "datagen",
    .help = "make labelled pairs of tetrahedra for learned overlap models",
    .options = option_table,
    .arguments =
        &(const AppArguments){.excess = "'%s' is one argument too many: the file to write is given with -o"},
    .doc = "Make a data set of labelled pairs of tetrahedra: coordinates, whether they meet, their kind, the "
           "volume they share and, if wanted, its derivatives.",
    .check = check,
    .run = run_command,
    .has_threads = true};
