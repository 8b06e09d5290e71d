// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/command.h"

#include "base/log.h"

static char *help(int key, const char *text, void *input) {
  return app_bench_report_help(((const AppBenchOptions *)input)->report, key, text);
}

void app_bench_command_read(const AppBenchCommand *command, int argument_count, char **arguments,
                            void *options) {
  static const struct argp_child children[] = {{.argp = &app_bench_options_argp}, {0}};
  const struct argp argp = {.options = command->options,
                            .parser = command->parse,
                            .args_doc = command->arguments,
                            .doc = command->doc,
                            .children = children,
                            .help_filter = help};
  ((AppBenchOptions *)options)->report = command->report;
  argp_parse(&argp, argument_count, arguments, 0, NULL, options);
}

int app_bench_command_end(Status status) {
  if (status != STATUS_OK) log_error("%s", status_message());
  return status_exit_code(status);
}
