// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/gradient/gradient.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/cli/parse.h"
#include "app/command/commands.h"
#include "app/job/job.h"
#include "app/table/table.h"
#include "base/log.h"
#include "base/text.h"

enum { MAX_PARAMETERS = 64 };

typedef struct Options {
  AppJobOptions job;
  const char *of, *by[MAX_PARAMETERS];
  int by_count;
} Options;

static const AppOption option_table[] = {
    {"of", 0, "displacement:BODY:AXIS", "Differentiate the mean displacement of a body along x, y or z", 1,
     CLI_TEXT, CLI_TO(Options, of)},
    {"by", 0, "KEY,...",
     "By these keys of the scene: bodies.NAME.material.young, bodies.NAME.material.density, "
     "contact.stiffness, effects.gravity[0] to [2]",
     1, CLI_LIST, CLI_TO(Options, by), .most = MAX_PARAMETERS, .example = "contact.stiffness",
     .count_offset = offsetof(Options, by_count)},
    {"set", 's', "KEY=VALUE", "Replace a value of the scene; may be repeated", 1, CLI_REPEATED,
     CLI_TO(Options, job.overrides), .most = APP_MAX_OVERRIDES, .example = "--set",
     .count_offset = offsetof(Options, job.override_count)},
    {"json", 'j', NULL, "Print JSON on standard output", 2, CLI_FLAG, CLI_TO(Options, job.is_json)},
    {"quiet", 'q', NULL, "Say nothing but errors", 2, CLI_FLAG, CLI_TO(Options, job.is_quiet)},
    {0},
};

typedef struct Row {
  const char *key, *unit;
  double value, derivative, share;
} Row;

static const AppTableColumn columns[] = {
    {"parameter", APP_TABLE_TEXT, offsetof(Row, key), "parameter p", NULL},
    {"value", APP_TABLE_NUMBER, offsetof(Row, value), "value", NULL},
    {"unit", APP_TABLE_TEXT, offsetof(Row, unit), "unit", NULL},
    {"derivative", APP_TABLE_NUMBER, offsetof(Row, derivative), "dg/dp", NULL},
    {"share", APP_TABLE_NUMBER, offsetof(Row, share), "p dg/dp / g", NULL},
};

typedef struct Asked {
  FemQuantity quantity;
  FemParameter parameters[MAX_PARAMETERS];
  int count;
  FemGradient gradient;
} Asked;

static Status find_body(const FemSceneDef *scene, const char *name, size_t length, int *body) {
  char list[512] = "";
  size_t used = 0;
  for (int b = 0; b < scene->body_count; b++) {
    const char *known = scene->bodies[b].name;
    *body = b;
    if (strlen(known) == length && memcmp(known, name, length) == 0) return STATUS_OK;
    text_append(list, sizeof list, &used, "%s%s", b ? ", " : "", known);
  }
  return status_fail(STATUS_INPUT, "no body is called '%.*s'; there are %s", (int)length, name, list);
}

static Status parse_quantity(const FemSceneDef *scene, const char *text, FemQuantity *quantity) {
  static const char prefix[] = "displacement:";
  const char *last = strrchr(text, ':');
  bool has_axis = last && last[1] && !last[2] && strchr("xyz", last[1]);
  const char *name = text + sizeof prefix - 1;
  if (strncmp(text, prefix, sizeof prefix - 1) != 0 || !has_axis || last < name)
    return status_fail(STATUS_INPUT, "--of: '%s' is not displacement:BODY:AXIS, as displacement:block:z",
                       text);
  quantity->component = last[1] - 'x';
  return status_prefix(find_body(scene, name, (size_t)(last - name), &quantity->body), "--of");
}

// bodies.NAME and `ending`.
static bool is_of_body(const char *key, const char *ending) {
  size_t length = strlen(key), tail = strlen(ending), head = strlen("bodies.");
  return length > head + tail && strncmp(key, "bodies.", head) == 0 && !strcmp(key + length - tail, ending);
}

static Status parse_parameter(const FemSceneDef *scene, const char *key, FemParameter *parameter) {
  static const char *const endings[] = {".material.young", ".material.density"};
  static const FemParameterKind kinds[] = {FEM_PARAMETER_YOUNG, FEM_PARAMETER_DENSITY};
  static const char *const gravity[] = {"effects.gravity[0]", "effects.gravity[1]", "effects.gravity[2]"};
  *parameter = (FemParameter){.kind = FEM_PARAMETER_CONTACT_STIFFNESS};
  if (strcmp(key, "contact.stiffness") == 0) return STATUS_OK;
  for (int c = 0; c < 3; c++)
    if (strcmp(key, gravity[c]) == 0) {
      *parameter = (FemParameter){.kind = FEM_PARAMETER_GRAVITY, .component = c};
      return STATUS_OK;
    }
  const char *name = key + strlen("bodies.");
  for (int k = 0; k < 2; k++)
    if (is_of_body(key, endings[k])) {
      parameter->kind = kinds[k];
      return status_prefix(find_body(scene, name, strlen(name) - strlen(endings[k]), &parameter->body),
                           "--by %s", key);
    }
  return status_fail(STATUS_INPUT,
                     "--by: no gradient by '%s'; there are bodies.NAME.material.young, "
                     "bodies.NAME.material.density, contact.stiffness, effects.gravity[0] to [2]",
                     key);
}

static Status at_end(void *observer, const FemRunProgress *progress) {
  Asked *asked = observer;
  if (progress->time < progress->end) return STATUS_OK;
  fem_gradient_destroy(&asked->gradient);
  return fem_gradient_find(&asked->gradient, progress->system, &asked->quantity, asked->parameters,
                           asked->count);
}

static const char *unit_of(FemParameterKind kind) {
  switch (kind) {
  case FEM_PARAMETER_YOUNG:
    return "Pa";
  case FEM_PARAMETER_DENSITY:
    return "kg/m³";
  case FEM_PARAMETER_GRAVITY:
    return "m/s²";
  case FEM_PARAMETER_CONTACT_STIFFNESS:
    return "Pa/m";
  }
  return "";
}

static Status print(const Options *options, const FemModel *model, const Asked *asked) {
  const FemGradient *gradient = &asked->gradient;
  Row rows[MAX_PARAMETERS];
  for (int p = 0; p < asked->count; p++) {
    double value = fem_parameter_value(model, &asked->parameters[p]), derivative = gradient->derivatives[p];
    rows[p] = (Row){options->by[p], unit_of(asked->parameters[p].kind), value, derivative,
                    gradient->value != 0 ? value * derivative / gradient->value : NAN};
  }
  AppTablePart part = {columns, sizeof columns / sizeof *columns, rows, sizeof *rows};
  if (!options->job.is_json) {
    printf("g = %s = %.10g m; residual of the adjoint %.1e, of the forces %.1e\n", options->of,
           gradient->value, gradient->residual, gradient->unbalanced);
    return app_table_print(&(AppTable){&part, 1, asked->count}, APP_TABLE_PLAIN, stdout);
  }
  Record *record = record_new();
  if (!record) return status_no_memory("a gradient");
  record_text(record, "quantity", options->of);
  record_text(record, "unit", "m");
  record_number(record, "value", gradient->value);
  record_number(record, "adjoint_residual", gradient->residual);
  record_number(record, "force_residual", gradient->unbalanced);
  Record *by = record_child(record, "by");
  for (int p = 0; p < asked->count; p++) app_table_record(&part, p, record_child(by, options->by[p]));
  Status status = record_print(record, stdout);
  record_destroy(record);
  return status;
}

// All that can be refused is refused before the run.
static Status prepare(const Options *options, const FemModel *model, Asked *asked) {
  TRY(parse_quantity(model->scene, options->of, &asked->quantity));
  TRY(fem_gradient_check(model));
  for (asked->count = 0; asked->count < options->by_count; asked->count++) {
    FemParameter *parameter = &asked->parameters[asked->count];
    TRY(parse_parameter(model->scene, options->by[asked->count], parameter));
    TRY(fem_parameter_check(model, parameter));
  }
  return STATUS_OK;
}

static Status differentiate(const Options *options, const FemModel *model) {
  Asked asked = {0};
  FemRunResult result = {0};
  FemRunOptions run = {.observe = at_end, .observer = &asked, .stop = app_job_stop_flag()};
  Status status = prepare(options, model, &asked);
  if (!status) status = fem_run(model, &run, &result);
  if (!status && !asked.gradient.derivatives)
    status = status_fail(STATUS_SOLVER, "the run ended before time.end: no gradient");
  if (!status) status = print(options, model, &asked);
  fem_run_result_destroy(&result);
  fem_gradient_destroy(&asked.gradient);
  return status;
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (!options->of) argp_error(state, "say of what, as in --of displacement:block:z");
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
    .help = "derivatives of what a static scene ends with by its parameters",
    .options = option_table,
    .arguments = &(const AppArguments){"SCENE", offsetof(Options, job.scene_path), 1,
                                       .missing = "name a scene file, as in examples/26_hertz.yaml",
                                       .excess = "one scene at a time; '%s' is the second"},
    .doc =
        "Run a static scene without friction to its end, and print the exact derivatives of a quantity g "
        "there by "
        "parameters p, all of them from one solve.\vThe share p dg/dp / g says by how many per cent g "
        "changes with one per cent of p. Everything else is kept, contact.stiffness, too. docs/gradients.md "
        "says what has a gradient.",
    .check = check,
    .run = run_command,
    .has_threads = true};
