// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/options.h"

#include "base/text.h"

// What argp adds to every command (Argp, "Options Provided by Default").
static const AppOption given[] = {
    {"help", '?', .help = "Print a help"}, {"usage", .help = "Print a short usage line"}, {0}};

static void visit_table(const AppOption *option, AppCliOptionVisit visit, void *self) {
  for (; option && (option->name || option->table); option++)
    if (option->table)
      visit_table(option->table, visit, self);
    else
      visit(self, option);
}

void app_cli_options_visit(const AppCommand *command, AppCliOptionVisit visit, void *self) {
  visit_table(command->options, visit, self);
  visit_table(given, visit, self);
}

bool app_cli_options_takes_path(const AppOption *option) {
  return option->argument && text_lists("FILE,DIR,CONFIG,SCENE", option->argument);
}

bool app_cli_options_takes_model(const AppOption *option) {
  return option->argument && text_lists("overlap,model,audit-only,reference", option->name);
}
