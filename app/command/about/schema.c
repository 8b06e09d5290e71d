// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/about/schema.h"

#include <stdbool.h>
#include <stdio.h>

#include "app/scene/manual.h"
#include "app/scene/schema.h"
#include "base/files/record.h"

static const struct argp_option option_table[] = {
    {"markdown", 'm', NULL, 0, "Print the manual's reference page instead", 0},
    {0},
};

static error_t parse(int key, char *text, struct argp_state *state) {
  bool *is_markdown = state->input;
  switch (key) {
  case 'm':
    *is_markdown = true;
    return 0;
  case ARGP_KEY_ARG:
    argp_error(state, "'%s' is one argument too many: schema takes no arguments", text);
    return 0;
  default:
    return ARGP_ERR_UNKNOWN;
  }
}

static Status print_schema(FILE *stream) {
  Record *schema = record_new();
  if (!schema) return status_no_memory("the schema");
  Status status = app_scene_schema_record(schema);
  if (!status) status = record_print(schema, stream);
  record_destroy(schema);
  return status;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .doc = "Print the JSON Schema of a scene file, from which editors complete and check scenes."};

static int run_command(int argument_count, char **arguments) {
  bool is_markdown = false;
  argp_parse(&argp, argument_count, arguments, 0, NULL, &is_markdown);
  Status status = is_markdown ? app_scene_manual_print(stdout) : print_schema(stdout);
  if (!status && fflush(stdout) != 0) status = status_fail(STATUS_IO, "standard output cannot be written");
  return app_cli_command_end(status);
}

const AppCommand app_command_schema = {.name = "schema",
                                       .help = "print the scene file's JSON Schema, or its manual page",
                                       .argp = &argp,
                                       .run = run_command};
