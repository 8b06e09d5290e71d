// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdbool.h>
#include <stdio.h>

#include "app/cli/parse.h"
#include "app/scene/manual.h"
#include "app/scene/schema.h"
#include "base/files/record.h"

static const AppOption option_table[] = {
    {"markdown", 'm', NULL, "Print the manual's reference page instead", 0, CLI_FLAG, .size = sizeof(bool)},
    {0},
};

static Status print_schema(FILE *stream) {
  Record *schema = record_new();
  if (!schema) return status_no_memory("the schema");
  Status status = app_scene_schema_record(schema);
  if (!status) status = record_print(schema, stream);
  record_destroy(schema);
  return status;
}

static int run_command(int argument_count, char **arguments) {
  bool is_markdown = false;
  app_cli_parse(&app_command_schema, argument_count, arguments, &is_markdown);
  Status status = is_markdown ? app_scene_manual_print(stdout) : print_schema(stdout);
  if (!status && fflush(stdout) != 0) status = status_fail(STATUS_IO, "standard output cannot be written");
  return app_cli_command_end(status);
}

const AppCommand app_command_schema = {
    .name = "schema",
    .help = "print the scene file's JSON Schema, or its manual page",
    .options = option_table,
    .doc = "Print the JSON Schema of a scene file, from which editors complete and check scenes.",
    .run = run_command};
