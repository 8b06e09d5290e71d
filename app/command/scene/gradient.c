// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/path/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/command/commands.h"
#include "app/gradient/goal.h"
#include "app/gradient/parameter.h"
#include "app/gradient/run.h"
#include "app/job/job.h"
#include "app/table/table.h"
#include "base/log.h"

enum { MAX_GOALS = 64, MAX_PARAMETERS = 64 };

typedef struct Options {
  AppJobOptions job;
  const char *of[MAX_GOALS], *by[MAX_PARAMETERS];
  int of_count, by_count;
  double at; // 0: the run's end
  bool is_total;
} Options;

static const AppOption option_table[] = {
    {"of", 0, "QUANTITY",
     "Differentiate it: displacement:BODY:AXIS, probe:NAME:AXIS, position:BODY:VERTEX:AXIS, "
     "force:BODY[:OTHER]:AXIS, moment:BODY[:OTHER]:AXIS, reaction:BODY:fixed[N]:AXIS, energy[:KIND], "
     "sum:FILE, misfit:FILE; may be repeated. QUANTITY@TIME: at that time [s]",
     1, CLI_REPEATED, CLI_TO(Options, of), .most = MAX_GOALS, .example = "--of",
     .count_offset = offsetof(Options, of_count)},
    {"by", 0, "KEY,...",
     "By these keys of the scene: materials, damping, loads, motions, places, contact.stiffness, "
     "contact.friction, "
     "effects.gravity[K]; "
     "docs/gradients.md lists them",
     1, CLI_LIST, CLI_TO(Options, by), .most = MAX_PARAMETERS, .example = "contact.stiffness",
     .count_offset = offsetof(Options, by_count)},
    {"at", 0, "TIME", "Take quantities at this time [s] that name none (default: the run's end)", 1,
     CLI_POSITIVE, CLI_TO(Options, at)},
    {"total", 0, NULL,
     "Let a contact stiffness that the scene does not give change with E and ν as it is chosen from them "
     "(default: it is kept)",
     1, CLI_FLAG, CLI_TO(Options, is_total)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene; may be repeated", 1, CLI_REPEATED,
     CLI_TO(Options, job.overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(Options, job.override_count)},
    {"json", 'j', NULL, "Print JSON on standard output", 2, CLI_FLAG, CLI_TO(Options, job.is_json)},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(Options, job.is_quiet)},
    {0},
};

typedef struct Row {
  const char *key, *unit, *idle;
  double value, derivative, share;
} Row;

static const AppTableColumn columns[] = {
    {"parameter", APP_TABLE_TEXT, offsetof(Row, key), "parameter p", NULL},
    {"value", APP_TABLE_NUMBER, offsetof(Row, value), "value", NULL},
    {"unit", APP_TABLE_TEXT, offsetof(Row, unit), "unit", NULL},
    {"derivative", APP_TABLE_NUMBER, offsetof(Row, derivative), "dg/dp", NULL},
    {"share", APP_TABLE_NUMBER, offsetof(Row, share), "p dg/dp / g", NULL},
    {"does_not_act", APP_TABLE_TEXT, offsetof(Row, idle), "does not act", NULL},
};

typedef struct Asked {
  FemGoal goals[MAX_GOALS];
  FemParameter parameters[MAX_PARAMETERS];
  FemGradientDef def;
  FemReplaySteps steps; // of a path
  FemGradient gradient;
} Asked;

// Whether a goal is, at a state that was not seen before.
static bool is_taken(const Asked *asked, const FemRunProgress *progress) {
  bool is_due = false;
  for (int g = 0; g < asked->def.goal_count; g++)
    is_due = is_due || fem_goal_is_due(&asked->goals[g], progress->system->model, progress->time);
  return is_due && progress->time > asked->gradient.time;
}

static Status at_step(void *observer, const FemRunProgress *progress) {
  Asked *asked = observer;
  if (fem_gradient_is_path(progress->system->model))
    return fem_replay_steps_add(&asked->steps, progress->system);
  if (!is_taken(asked, progress)) return STATUS_OK;
  return fem_gradient_find(&asked->gradient, progress->system, &asked->def);
}

// Of contact, what its stiffness does.
static const char *stiffness_of(const FemModel *model, bool is_total) {
  const FemContactDef *contact = &model->scene->contact;
  if (!contact->is_on) return "none";
  if (contact->stiffness > 0 || contact->law.law.kind != CONTACT_LAW_LINEAR) return "given";
  return is_total ? "follows" : "kept";
}

static void fill_rows(const Options *options, const FemModel *model, const Asked *asked, int g, Row *rows) {
  const FemGradient *gradient = &asked->gradient;
  double whole = gradient->values[g];
  for (int p = 0; p < options->by_count; p++) {
    const FemParameter *parameter = &asked->parameters[p];
    double value = fem_parameter_value(model, parameter);
    double derivative = gradient->derivatives[g * options->by_count + p];
    rows[p] = (Row){options->by[p],
                    fem_parameter_unit(model, parameter),
                    fem_parameter_idle(model, parameter),
                    value,
                    derivative,
                    whole != 0 ? value * derivative / whole : NAN};
  }
}

// How many vertices began or ended to slip.
static const char *switches_of(const FemGradient *gradient, char *text, size_t size) {
  if (gradient->switches == 0) return "";
  snprintf(text, size, ", %lld switches between stick and slip", gradient->switches);
  return text;
}

static Status print_plain(const Options *options, const FemModel *model, const Asked *asked) {
  const FemGradient *gradient = &asked->gradient;
  char text[64];
  if (strcmp(stiffness_of(model, options->is_total), "kept") == 0)
    printf("contact.stiffness, which is chosen, is kept as it is; --total lets it follow E and ν\n");
  for (int g = 0; g < options->of_count; g++) {
    Row rows[MAX_PARAMETERS];
    AppTablePart part = {columns, sizeof columns / sizeof *columns, rows, sizeof *rows};
    fill_rows(options, model, asked, g, rows);
    printf("g = %s = %.10g %s; residual of the adjoint %.1e, of the forces %.1e", options->of[g],
           gradient->values[g], app_gradient_unit(&asked->goals[g], options->of[g]), gradient->residuals[g],
           gradient->unbalanced);
    if (asked->steps.count > 0)
      printf("; a replay of %d steps%s\n", asked->steps.count - 1, switches_of(gradient, text, sizeof text));
    else
      printf(", of the matrix %.1e\n", gradient->mismatches[g]);
    TRY(app_table_print(&(AppTable){&part, 1, options->by_count}, APP_TABLE_PLAIN, stdout));
  }
  return STATUS_OK;
}

static void record_goal(const Options *options, const FemModel *model, const Asked *asked, int g,
                        Record *record) {
  Row rows[MAX_PARAMETERS];
  AppTablePart part = {columns, sizeof columns / sizeof *columns, rows, sizeof *rows};
  fill_rows(options, model, asked, g, rows);
  record_text(record, "unit", app_gradient_unit(&asked->goals[g], options->of[g]));
  record_number(record, "value", asked->gradient.values[g]);
  record_number(record, "adjoint_residual", asked->gradient.residuals[g]);
  record_number(record, "matrix_residual", asked->gradient.mismatches[g]);
  Record *by = record_child(record, "by");
  for (int p = 0; p < options->by_count; p++) app_table_record(&part, p, record_child(by, options->by[p]));
}

static Status print_json(const Options *options, const FemModel *model, const Asked *asked) {
  Record *record = record_new();
  if (!record) return status_no_memory("a gradient");
  record_text(record, "contact_stiffness", stiffness_of(model, options->is_total));
  if (asked->steps.count > 0) record_integer(record, "steps", asked->steps.count - 1);
  if (asked->steps.count > 0) record_integer(record, "stick_slip_switches", asked->gradient.switches);
  record_number(record, "force_residual", asked->gradient.unbalanced);
  Record *of = record_child(record, "of");
  for (int g = 0; g < options->of_count; g++)
    record_goal(options, model, asked, g, record_child(of, options->of[g]));
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

// All that can be refused is refused before the run.
static Status prepare(const Options *options, const FemModel *model, Asked *asked) {
  double at = options->at > 0 ? options->at : INFINITY;
  asked->def = (FemGradientDef){.goals = asked->goals,
                                .parameters = asked->parameters,
                                .goal_count = options->of_count,
                                .parameter_count = options->by_count,
                                .follows_choice = options->is_total};
  for (int g = 0; g < options->of_count; g++)
    TRY(status_prefix(app_gradient_read_goal(model, options->of[g], at, &asked->goals[g]), "--of"));
  for (int p = 0; p < options->by_count; p++)
    TRY(status_prefix(app_gradient_read_parameter(model, options->by[p], &asked->parameters[p]), "--by"));
  TRY(fem_gradient_check(model, &asked->def));
  return fem_gradient_is_path(model) ? fem_path_check(model, &asked->def) : STATUS_OK;
}

static Status differentiate(const Options *options, const FemModel *model) {
  Asked asked = {0};
  FemRunResult result = {0};
  FemRunOptions run = {.observe = at_step, .observer = &asked, .stop = app_job_stop_flag()};
  Status status = prepare(options, model, &asked);
  if (!status) status = app_gradient_run(model, &asked.def, &run, &result);
  if (!status && fem_gradient_is_path(model))
    status = fem_path_differentiate(&asked.gradient, model, &asked.def, &asked.steps);
  if (!status && !asked.gradient.derivatives)
    status = status_fail(STATUS_SOLVER, "the run ended before time.end: no gradient");
  if (!status)
    status = options->job.is_json ? print_json(options, model, &asked) : print_plain(options, model, &asked);
  fem_run_result_destroy(&result);
  fem_gradient_destroy(&asked.gradient);
  fem_replay_steps_destroy(&asked.steps);
  for (int g = 0; g < options->of_count; g++) app_gradient_destroy_goal(&asked.goals[g]);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (!options->of_count) argp_error(state, "say of what, as in --of displacement:block:z");
  if (!options->by_count) argp_error(state, "say by what, as in --by contact.stiffness");
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_gradient, argument_count, arguments, &options);
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
