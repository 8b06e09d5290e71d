// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include <stdio.h>

#include "app/cli/parse.h"
#include "app/scene/keys/keys.h"
#include "base/log.h"
#include "base/status.h"
#include "fem/effect/effect.h"

// Every key of the table that takes a name, with what there is to choose from.
static void print_choices(const SceneSection *section, const char *above) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    char path[128];
    snprintf(path, sizeof path, "%s%s%s", above, above[0] ? "." : "", key->name);
    if (key->section) print_choices(key->section, path);
    if (!key->choices) continue;
    printf("\n%s:\n", path);
    const char *name;
    for (int c = 0; (name = app_scene_section_name(key->choices, c)); c++)
      printf("  %-14s %s\n", name, app_scene_section_help(key->choices, c));
  }
}

static int run_command(int argument_count, char **arguments) {
  app_cli_parse(&app_command_effects, argument_count, arguments, NULL);
  int count;
  const FemEffectOps *const *effects = fem_effect_list(&count);
  puts("effects:");
  for (int i = 0; i < count; i++) printf("  %-14s %s\n", effects[i]->name, effects[i]->help);
  print_choices(&app_scene_keys_root, "");
  if (fflush(stdout) == 0) return 0;
  log_error("standard output cannot be written");
  return status_exit_code(STATUS_IO);
}

const AppCommand app_command_effects = {
    .name = "effects",
    .help = "list effects, materials, potentials, models and solvers",
    .doc = "List the effects, and the names that a scene's keys choose from.",
    .run = run_command};
