// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/command/commands.h"
#include "app/gradient/goal.h"
#include "app/table/table.h"
#include "base/log.h"
#include "fem/effect/contact/contact.h"
#include "fem/sparse/vector.h"

typedef struct Options {
  AppJobOptions job;
  AppGradientWords words;
  const char *weights; // a file to be written; NULL: none
  bool is_checked;
} Options;

static const AppOption option_table[] = {
    {"of", 0, "QUANTITY",
     "Differentiate it: displacement:BODY:AXIS, probe:NAME:AXIS, position:BODY:VERTEX:AXIS, "
     "force:BODY[:OTHER]:AXIS, patch:PROBE:AXIS, pressure:PROBE, peak:PROBE, moment:BODY[:OTHER]:AXIS, "
     "reaction:BODY:fixed[N]:AXIS, energy[:KIND], "
     "sum:FILE, misfit:FILE; may be repeated. QUANTITY@TIME: at that time [s]",
     1, CLI_REPEATED, CLI_TO(Options, words.of), .most = APP_GRADIENT_MOST, .example = "--of",
     .count_offset = offsetof(Options, words.of_count)},
    {"by", 0, "KEY,...",
     "By these keys of the scene: materials, damping, loads, motions, places, contact.stiffness, "
     "contact.friction, "
     "effects.gravity[K]; "
     "docs/gradients.md lists them",
     1, CLI_LIST, CLI_TO(Options, words.by), .most = APP_GRADIENT_MOST, .example = "contact.stiffness",
     .count_offset = offsetof(Options, words.by_count)},
    {"at", 0, "TIME", "Take quantities at this time [s] that name none (default: the run's end)", 1,
     CLI_POSITIVE, CLI_TO(Options, words.at)},
    {"memory", 0, "MB",
     "What the replay of a motion, or of a scene with friction or plasticity, may keep; where it were more, "
     "segments are done twice (default: what there is)",
     1, CLI_POSITIVE, CLI_TO(Options, words.most_megabytes)},
    {"weights", 'w', "FILE",
     "Write dg/dw by the weights of contact.overlap's network, a geo or a hybrid's, as a weights file of the "
     "same shape; "
     "of several quantities FILE's stem is followed by -0, -1, …",
     1, CLI_TEXT, CLI_TO(Options, weights), .example = "slope.safetensors"},
    {"total", 0, NULL,
     "Let a contact stiffness that the scene does not give change with E and ν as it is chosen from them "
     "(default: it is kept)",
     1, CLI_FLAG, CLI_TO(Options, words.is_total)},
    {"check", 0, NULL,
     "Run three times more: how much derivatives move where steps are halved, and what whole runs differ by "
     "along a random direction",
     1, CLI_FLAG, CLI_TO(Options, is_checked)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene; may be repeated", 1, CLI_REPEATED,
     CLI_TO(Options, job.overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(Options, job.override_count)},
    {"json", 'j', NULL, "Print JSON on standard output", 2, CLI_FLAG, CLI_TO(Options, job.is_json)},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(Options, job.is_quiet)},
    {0},
};

typedef struct Row {
  const char *key, *unit, *idle;
  double value, derivative, share, halved;
} Row;

static const AppTableColumn columns[] = {
    {"parameter", APP_TABLE_TEXT, offsetof(Row, key), "parameter p", NULL},
    {"value", APP_TABLE_NUMBER, offsetof(Row, value), "value", NULL},
    {"unit", APP_TABLE_TEXT, offsetof(Row, unit), "unit", NULL},
    {"derivative", APP_TABLE_NUMBER, offsetof(Row, derivative), "dg/dp", NULL},
    {"share", APP_TABLE_NUMBER, offsetof(Row, share), "p dg/dp / g", NULL},
    {"does_not_act", APP_TABLE_TEXT, offsetof(Row, idle), "does not act", NULL},
    {"halved", APP_TABLE_NUMBER, offsetof(Row, halved), "moves, steps halved", NULL},
};

// What is printed.
typedef struct Answer {
  const Options *options;
  const FemModel *model;
  AppGradientAnswer found;
  AppGradientCheck check; // where it was asked for
} Answer;

static void fill_rows(const Answer *answer, int g, Row *rows) {
  const AppGradientWords *words = &answer->options->words;
  const FemGradient *gradient = &answer->found.gradient;
  double whole = gradient->values[g];
  for (int p = 0; p < words->by_count; p++) {
    const FemParameter *parameter = &answer->found.parameters[p];
    double value = fem_parameter_value(answer->model, parameter);
    double derivative = gradient->derivatives[g * words->by_count + p];
    rows[p] = (Row){.key = words->by[p],
                    .unit = fem_parameter_unit(answer->model, parameter),
                    .idle = fem_parameter_idle(answer->model, parameter),
                    .value = value,
                    .derivative = derivative,
                    .share = whole != 0 ? value * derivative / whole : NAN,
                    .halved = answer->check.halved[g][p]};
  }
}

// Without a check its column is left out.
static AppTablePart part_of(const Answer *answer, const Row *rows) {
  int count = (int)(sizeof columns / sizeof *columns) - (answer->options->is_checked ? 0 : 1);
  return (AppTablePart){columns, count, rows, sizeof *rows};
}

// How many vertices began or ended to slip, and points to yield.
static const char *switches_of(const FemGradient *gradient, char *text, size_t size) {
  int length = 0;
  *text = 0;
  if (gradient->switches > 0)
    length = snprintf(text, size, ", %lld switches between stick and slip", gradient->switches);
  if (gradient->yields > 0)
    snprintf(text + length, size - (size_t)length, ", %lld switches between elastic and yielding",
             gradient->yields);
  return text;
}

static void print_head(const Answer *answer, int g) {
  const FemGradient *gradient = &answer->found.gradient;
  const char *word = answer->options->words.of[g];
  char text[128];
  int count = answer->found.steps.count - 1;
  printf("g = %s = %.10g %s; residual of the adjoint %.1e, of the forces %.1e", word, gradient->values[g],
         app_gradient_unit(&answer->found.goals[g], word), gradient->residuals[g], gradient->unbalanced);
  if (answer->found.steps.count > 0)
    printf("; a replay of %d step%s%s\n", count, count == 1 ? "" : "s",
           switches_of(gradient, text, sizeof text));
  else
    printf(", of the matrix %.1e\n", gradient->mismatches[g]);
  if (answer->options->is_checked && isnan(answer->check.along[g]))
    printf("along a random direction: not found, since these parameters are 0 or rest positions, or change a "
           "contact stiffness that is chosen and kept (of E and ν --total lets it follow)\n");
  else if (answer->options->is_checked)
    printf("along a random direction: %.10g by the derivatives, %.10g by a difference of runs\n",
           answer->check.along[g], answer->check.between[g]);
}

// FILE, or of several quantities with a number before its ending.
static void name_weights(const Options *options, int g, char *path, size_t size) {
  const char *slash = strrchr(options->weights, '/'), *dot = strrchr(slash ? slash : options->weights, '.');
  int stem = dot ? (int)(dot - options->weights) : (int)strlen(options->weights);
  if (options->words.of_count == 1)
    snprintf(path, size, "%s", options->weights);
  else
    snprintf(path, size, "%.*s-%d%s", stem, options->weights, g, dot ? dot : "");
}

static double length_of(const FemGradient *gradient, int g) {
  const double *slope = gradient->weights + gradient->weight_count * (size_t)g;
  return sqrt(fem_vector_dot((int)gradient->weight_count, slope, slope));
}

static void print_weights(const Answer *answer, int g) {
  const FemGradient *gradient = &answer->found.gradient;
  char path[4096];
  name_weights(answer->options, g, path, sizeof path);
  printf("|dg/dw| = %.4g by %zu weights: %s\n", length_of(gradient, g), gradient->weight_count, path);
}

static Status write_weights(const Answer *answer) {
  const FemGradient *gradient = &answer->found.gradient;
  OverlapModel overlap;
  char path[4096];
  if (!gradient->weights) return STATUS_OK;
  TRY(fem_effect_contact_create_overlap(answer->model->scene, NULL, &overlap));
  Status status = STATUS_OK;
  for (int g = 0; g < answer->options->words.of_count && !status; g++) {
    name_weights(answer->options, g, path, sizeof path);
    status = overlap.ops->training->write(overlap.self,
                                          gradient->weights + gradient->weight_count * (size_t)g, path);
  }
  overlap_model_destroy(&overlap);
  return status;
}

static Status print_plain(const Answer *answer) {
  const AppGradientWords *words = &answer->options->words;
  if (strcmp(app_gradient_stiffness(answer->model, words), "kept") == 0)
    printf("contact.stiffness, which is chosen, is kept as it is; --total lets it follow E and ν\n");
  for (int g = 0; g < words->of_count; g++) {
    Row rows[APP_GRADIENT_MOST];
    fill_rows(answer, g, rows);
    print_head(answer, g);
    AppTablePart part = part_of(answer, rows);
    if (words->by_count > 0)
      TRY(app_table_print(&(AppTable){&part, 1, words->by_count}, APP_TABLE_PLAIN, stdout));
    if (answer->found.gradient.weights) print_weights(answer, g);
  }
  for (int p = 0; p < words->by_count; p++)
    if (answer->found.gradient.kinks[p]) printf("%s: %s\n", words->by[p], answer->found.gradient.kinks[p]);
  return STATUS_OK;
}

static void record_goal(const Answer *answer, int g, Record *record) {
  const AppGradientWords *words = &answer->options->words;
  const FemGradient *gradient = &answer->found.gradient;
  Row rows[APP_GRADIENT_MOST];
  fill_rows(answer, g, rows);
  AppTablePart part = part_of(answer, rows);
  record_text(record, "unit", app_gradient_unit(&answer->found.goals[g], words->of[g]));
  record_number(record, "value", gradient->values[g]);
  record_number(record, "adjoint_residual", gradient->residuals[g]);
  record_number(record, "matrix_residual", gradient->mismatches[g]);
  if (answer->options->is_checked) {
    record_number(record, "along_by_derivatives", answer->check.along[g]);
    record_number(record, "along_by_runs", answer->check.between[g]);
  }
  if (gradient->weights) record_number(record, "weights_length", length_of(gradient, g));
  Record *by = record_child(record, "by");
  for (int p = 0; p < words->by_count; p++) {
    Record *cell = record_child(by, words->by[p]);
    app_table_record(&part, p, cell);
    record_text(cell, "no_derivative", gradient->kinks[p]);
  }
}

static Status print_json(const Answer *answer) {
  const AppGradientAnswer *found = &answer->found;
  const AppGradientWords *words = &answer->options->words;
  Record *record = record_new();
  if (!record) return status_no_memory("a gradient");
  record_text(record, "contact_stiffness", app_gradient_stiffness(answer->model, words));
  if (found->steps.count > 0) record_integer(record, "steps", found->steps.count - 1);
  if (found->steps.count > 0) record_integer(record, "stick_slip_switches", found->gradient.switches);
  if (found->steps.count > 0) record_integer(record, "yield_switches", found->gradient.yields);
  FemReplayPlan plan = fem_replay_steps_plan(&found->steps);
  if (found->steps.count > 0) record_integer(record, "replay_bytes", (long long)plan.bytes);
  if (found->steps.count > 0) record_integer(record, "replay_segments", plan.segment_count);
  if (found->steps.count > 0) record_number(record, "replay_s", found->gradient.replay_s);
  record_number(record, "force_residual", found->gradient.unbalanced);
  Record *of = record_child(record, "of");
  for (int g = 0; g < words->of_count; g++) record_goal(answer, g, record_child(of, words->of[g]));
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

static Status differentiate(const Options *options, const FemModel *model) {
  Answer answer = {.options = options, .model = model};
  Status status = app_gradient_answer(&answer.found, model, &options->words, app_job_stop_flag());
  if (!status && options->is_checked)
    status = app_gradient_check(&answer.check, &options->job, model, &options->words, &answer.found);
  if (!status) status = write_weights(&answer);
  if (!status) status = options->job.is_json ? print_json(&answer) : print_plain(&answer);
  app_gradient_answer_destroy(&answer.found);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (!options->words.of_count) argp_error(state, "say of what, as in --of displacement:block:z");
  if (!options->words.by_count && !options->weights)
    argp_error(state, "say by what, as in --by contact.stiffness");
  if (!options->words.by_count && options->is_checked)
    argp_error(state, "--check follows parameters: say which, as in --by contact.stiffness");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_gradient, argument_count, arguments, &options);
  options.words.by_weights = options.weights != NULL;
  app_job_prepare(&options.job);
  AppJob job;
  Status status = app_job_open(&job, &options.job, NULL, NULL);
  if (!status) {
    status = differentiate(&options, &job.model);
    app_job_close(&job);
  }
  return app_cli_command_end(status);
}

const AppCommand app_command_gradient = {
    .name = "gradient",
    .help = "derivatives of what a scene gives by its parameters",
    .options = option_table,
    .arguments = &(const AppArguments){"SCENE", offsetof(Options, job.scene_path), 1,
                                       .missing = "name a scene file, as in examples/26_hertz.yaml",
                                       .excess = "one scene at a time; '%s' is the second"},
    .doc = "Run a static scene or a motion, and print the exact derivatives of quantities g, at its end or "
           "at other times, by parameters p, from one solve for each g.\vThe share p dg/dp / g says by how "
           "many per "
           "cent g "
           "changes with one per cent of p. Everything else is kept. docs/gradients.md says what has a "
           "gradient.",
    .check = check,
    .run = run_command,
    .has_threads = true};
