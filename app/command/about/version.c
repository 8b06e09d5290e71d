// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include "app/cli/parse.h"
#include "app/cli/versions.h"
#include "base/files/record.h"
#include "base/status.h"

static int run_command(int argument_count, char **arguments) {
  app_cli_parse(&app_command_version, argument_count, arguments, NULL);
  Record *versions = record_new();
  Status status = versions ? STATUS_OK : status_no_memory("the versions");
  if (!status) {
    app_versions_record(versions);
    status = record_print(versions, stdout);
  }
  record_destroy(versions);
  return app_cli_command_end(status);
}

const AppCommand app_command_version = {.name = "version",
                                        .help = "print the versions of the program and its libraries",
                                        .doc =
                                            "Print the versions of the program and its libraries, as JSON.",
                                        .run = run_command};
