// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/options.h"

#include "base/text.h"

// What argp adds to every command (Argp, "Options Provided by Default").
static const struct argp_option given[] = {
    {"help", '?', NULL, 0, "Print a help", -1}, {"usage", -3, NULL, 0, "Print a short usage line", -1}, {0}};

static void visit_table(const struct argp_option *table, AppCliOptionVisit visit, void *self) {
  for (const struct argp_option *option = table; option && option->name; option++) visit(self, option);
}

static void visit_own(const struct argp *argp, AppCliOptionVisit visit, void *self) {
  visit_table(argp->options, visit, self);
  for (const struct argp_child *child = argp->children; child && child->argp; child++)
    visit_own(child->argp, visit, self);
}

void app_cli_options_visit(const struct argp *argp, AppCliOptionVisit visit, void *self) {
  visit_own(argp, visit, self);
  visit_table(given, visit, self);
}

bool app_cli_options_has_letter(const struct argp_option *option) {
  return option->key > ' ' && option->key < 127;
}

bool app_cli_options_takes_path(const struct argp_option *option) {
  return option->arg && text_lists("FILE,DIR,CONFIG,SCENE", option->arg);
}

bool app_cli_options_takes_model(const struct argp_option *option) {
  return option->arg && text_lists("overlap,model,audit-only,reference", option->name);
}
