// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "app/cli/parse.h"
#include "app/command/commands.h"
#include "app/job/job.h"
#include "app/sweep/child.h"
#include "app/verdict/crew.h"
#include "app/verdict/report.h"
#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/machine/cpu.h"
#include "base/memory.h"
#include "overlap/foreign/foreign.h"
#include "overlap/models.h"
#include "overlap/source.h"

enum { MOST_MODELS = 16 };

static const uint64_t MOST_SEED = UINT64_C(1) << 53; // verdict.json keeps it as a number: a double when read

typedef struct Options {
  const char *models[MOST_MODELS];
  int model_count;
  const char *directory;
  uint64_t seed;
  int jobs; // 0: one a core
  bool has_seed, is_quick, is_json, is_markdown, is_quiet;
} Options;

static const AppOption option_table[] = {
    {"output", 'o', "DIR", "Keep everything in DIR, a folder a model (default: out/verdict)", 1, CLI_TEXT,
     CLI_TO(Options, directory)},
    {"quick", 0, NULL, "Fewer pairs and five of the twelve scenes", 1, CLI_FLAG, CLI_TO(Options, is_quick)},
    {"seed", 's', "S", "Draw the pairs by this seed (default: DIR's, else a new one)", 1, CLI_SEED,
     CLI_TO(Options, seed), .mark_offset = offsetof(Options, has_seed)},
    {"jobs", 'J', "N", "Processes at once (default: one a core)", 1, CLI_INTEGER, CLI_TO(Options, jobs), 1,
     APP_SWEEP_MAX_JOBS},
    {"json", 'j', NULL, "Print verdict.json", 2, CLI_FLAG, CLI_TO(Options, is_json)},
    {"markdown", 'M', NULL, "Print Markdown", 2, CLI_FLAG, CLI_TO(Options, is_markdown)},
    {"quiet", 'q', NULL, "Say errors only", 2, CLI_FLAG, CLI_TO(Options, is_quiet)},
    {0},
};

// What an earlier call has left in DIR; NULL: nothing.
static Status read_before(const char *directory, Record **before) {
  char path[PATH_MAX];
  *before = NULL;
  snprintf(path, sizeof path, "%s/verdict.json", directory);
  return file_exists(path) ? record_read(before, path) : STATUS_OK;
}

static Status choose_seed(const Options *options, const Record *before, uint64_t *seed) {
  uint32_t drawn;
  const double kept = record_find_number(before, "seed");
  *seed = options->seed;
  if (options->has_seed && options->seed > MOST_SEED)
    return status_fail(STATUS_USAGE,
                       "--seed %llu: verdict.json keeps seeds up to %llu exactly; give a smaller one",
                       (unsigned long long)options->seed, (unsigned long long)MOST_SEED);
  if (before && options->has_seed && kept != (double)*seed)
    return status_fail(STATUS_USAGE, "--seed %llu: the folder has the seed %.0f; give another folder by -o",
                       (unsigned long long)*seed, kept);
  if (before && (record_find_number(before, "quick") != 0) != options->is_quick)
    return status_fail(STATUS_USAGE, "%s: its verdicts are %s ones; give another folder by -o",
                       options->directory, options->is_quick ? "whole" : "--quick");
  if (before) *seed = (uint64_t)kept;
  if (!before && !options->has_seed) {
    if (getrandom(&drawn, sizeof drawn, 0) != sizeof drawn) return status_fail(STATUS_IO, "no random seed");
    *seed = drawn;
  }
  return STATUS_OK;
}

// Of the model's file, "" where it has none: another file of that name is another model.
static Status find_digest(const char *source, char text[DIGEST_TEXT]) {
  char path[PATH_MAX], *content;
  size_t size;
  text[0] = 0;
  if (!app_model_names_locate(source, path)) return STATUS_OK;
  char *colon = strrchr(path, ':');
  if (!file_exists(path) && colon) *colon = 0;
  if (!file_exists(path)) return STATUS_OK;
  TRY(file_read(path, &content, &size));
  digest_print(digest_bytes(DIGEST_START, content, size), text);
  memory_free(content);
  return STATUS_OK;
}

static Status check_digest(const Record *before, const AppVerdictPlan *plan, const char *digest) {
  const Record *models = record_find(before, "models");
  for (int m = 0; m < record_count(models); m++) {
    const char *name = record_find_text(record_at(models, m), "model");
    const char *kept = record_find_text(record_at(models, m), "digest");
    if (name && strcmp(name, plan->name) == 0 && kept && strcmp(kept, digest) != 0)
      return status_fail(
          STATUS_USAGE,
          "%s: %s has a verdict of another file of that name; remove %s/%s, or give another folder by -o",
          plan->source, plan->directory, plan->directory, plan->name);
  }
  return STATUS_OK;
}

// A model that cannot be opened is reported before anything is asked of others.
static Status try_model(const char *source) {
  OverlapModel model;
  if (strchr(source, ',') && !strchr(source, ':') && access(source, F_OK)) // neither a command nor a file
    return status_fail(STATUS_USAGE,
                       "there is no overlap model '%s': name several models as words of their own", source);
  TRY(overlap_models_create(&model, source));
  overlap_model_destroy(&model);
  return STATUS_OK;
}

static Status plan_models(const Options *options, const Record *before, uint64_t seed, AppVerdictPlan *plans,
                          char digests[][DIGEST_TEXT]) {
  AppModelName names[MOST_MODELS];
  TRY(app_model_names_find(options->model_count, options->models, names));
  for (int m = 0; m < options->model_count; m++) {
    plans[m] = (AppVerdictPlan){.directory = options->directory,
                                .source = options->models[m],
                                .seed = seed,
                                .is_quick = options->is_quick,
                                .threads = 1};
    memcpy(plans[m].name, names[m], sizeof names[m]);
    TRY(try_model(plans[m].source));
    TRY(find_digest(plans[m].source, digests[m]));
    TRY(check_digest(before, &plans[m], digests[m]));
  }
  return STATUS_OK;
}

// A function of the program that started this one answers one process at a time.
static Status count_jobs(const Options *options, int *jobs) {
  const int most = options->jobs ? options->jobs : cpu_thread_count();
  *jobs = most < APP_SWEEP_MAX_JOBS ? most : APP_SWEEP_MAX_JOBS;
  for (int m = 0; m < options->model_count; m++)
    if (overlap_source_of(options->models[m]) == OVERLAP_SOURCE_CHANNEL) {
      TRY(overlap_foreign_hand_on(options->models[m]));
      *jobs = 1;
    }
  return STATUS_OK;
}

// Verdicts of an earlier call that this one was not asked about stay.
static void keep_others(const Record *before, const Options *options, const AppVerdictPlan *plans,
                        RecordList *models) {
  const Record *list = record_find(before, "models");
  for (int k = 0; k < record_count(list); k++) {
    const char *name = record_find_text(record_at(list, k), "model");
    bool is_asked = !name;
    for (int m = 0; m < options->model_count; m++) is_asked = is_asked || strcmp(name, plans[m].name) == 0;
    if (!is_asked) record_merge(record_append(models), record_at(list, k));
  }
}

static Status write_record(const Options *options, const AppVerdictPlan *plans,
                           const AppVerdictFindings *findings, char digests[][DIGEST_TEXT],
                           const Record *before) {
  char path[PATH_MAX];
  Record *root = record_new();
  record_integer(root, "format", 1);
  record_integer(root, "seed", (long long)plans[0].seed);
  record_integer(root, "quick", options->is_quick);
  RecordList *models = record_list(root, "models");
  keep_others(before, options, plans, models);
  for (int m = 0; findings && m < options->model_count; m++) {
    Record *one = app_verdict_record(&plans[m], &findings[m]), *row = record_append(models);
    record_merge(row, one);
    record_text(row, "digest", digests[m]);
    record_destroy(one);
  }
  snprintf(path, sizeof path, "%s/verdict.json", options->directory);
  Status status = root ? record_write(root, path) : status_no_memory("a verdict");
  if (!status && findings && options->is_json) status = record_print(root, stdout);
  record_destroy(root);
  return status;
}

static Status print(const Options *options, const AppVerdictPlan *plans, const AppVerdictFindings *findings) {
  const AppTableFormat format = options->is_markdown ? APP_TABLE_MARKDOWN : APP_TABLE_PLAIN;
  for (int m = 0; !options->is_json && m < options->model_count; m++)
    TRY(app_verdict_print(&plans[m], &findings[m], format, stdout));
  return STATUS_OK;
}

static Status judge(const Options *options, const Record *before) {
  static AppVerdictPlan plans[MOST_MODELS];
  static AppVerdictFindings findings[MOST_MODELS];
  char digests[MOST_MODELS][DIGEST_TEXT];
  uint64_t seed;
  int jobs;
  TRY(choose_seed(options, before, &seed));
  TRY(plan_models(options, before, seed, plans, digests));
  TRY(count_jobs(options, &jobs));
  TRY(file_make_directories(options->directory));
  if (!before) TRY(write_record(options, plans, NULL, digests, before)); // so that the seed is kept
  TRY(app_verdict_crew_run(plans, options->model_count, jobs, app_job_stop_flag()));
  for (int m = 0; m < options->model_count; m++) TRY(app_verdict_findings_read(&plans[m], &findings[m]));
  TRY(write_record(options, plans, findings, digests, before));
  TRY(print(options, plans, findings));
  log_info("wrote %s/verdict.json; the runs are in the folders beside it", options->directory);
  return STATUS_OK;
}

static int run_command(int argument_count, char **arguments) {
  Options options = {.directory = "out/verdict"};
  Record *before;
  app_cli_parse(&app_command_verdict, argument_count, arguments, &options);
  app_job_prepare(&(AppJobOptions){.is_quiet = options.is_quiet});
  Status status = read_before(options.directory, &before);
  if (!status) status = judge(&options, before);
  record_destroy(before);
  return app_cli_command_end(status);
}

const AppCommand app_command_verdict = {
    .name = "verdict",
    .help = "say what an overlap model is fit for: detection, forces, motion",
    .options = option_table,
    .arguments =
        &(const AppArguments){
            "MODEL…", offsetof(Options, models), MOST_MODELS, offsetof(Options, model_count),
            .missing = "name a model: a name, weights, mine.so, mine.py:NAME, mine.onnx, exec:COMMAND",
            .excess = "'%s' is one model too many: at most %d"},
    .doc = "Judge overlap models: symmetries and bounds on hard pairs, errors on pairs that no training saw, "
           "and "
           "runs of twelve scenes beside those of `clip`. docs/verdict.md has the conditions.\vThe same "
           "command, "
           "given again, completes what is not there yet.",
    .run = run_command};
