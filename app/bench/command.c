// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/bench/command.h"

#include "base/log.h"

const struct argp_child app_bench_command_children[] = {{.argp = &app_bench_options_argp}, {0}};

char *app_bench_command_help(int key, const char *text, void *options) {
  return app_bench_report_help(((const AppBenchOptions *)options)->report, key, text);
}

char *app_bench_command_rows(const void *rows) {
  return app_bench_report_help(rows, ARGP_KEY_HELP_POST_DOC, NULL);
}

void app_bench_command_read(const AppCommand *command, int argument_count, char **arguments, void *options) {
  ((AppBenchOptions *)options)->report = command->rows;
  argp_parse(command->argp, argument_count, arguments, 0, NULL, options);
}
