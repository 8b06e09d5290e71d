// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"

#include <stdio.h>
#include <string.h>

#include "app/bench/bench.h"
#include "app/cli/versions.h"
#include "app/command/check.h"
#include "app/command/compare.h"
#include "app/command/datagen.h"
#include "app/command/dataset.h"
#include "app/command/effects.h"
#include "app/command/eval.h"
#include "app/command/mesh.h"
#include "app/command/pareto.h"
#include "app/command/plot.h"
#include "app/command/report.h"
#include "app/command/resume.h"
#include "app/command/run.h"
#include "app/command/schema.h"
#include "app/command/stress.h"
#include "app/command/train.h"
#include "app/command/weights.h"
#include "base/log.h"
#include "base/record.h"
#include "base/status.h"
#include "base/text.h"

typedef struct Command {
  const char *name;
  const char *help;
  int (*run)(int argument_count, char **arguments); // arguments[0] is "tetlap NAME"
} Command;

static int run_help(int argument_count, char **arguments);
static int run_version(int argument_count, char **arguments);

static const Command commands[] = {
    {"run", "run a scene and write frames, history and summary", app_run_run},
    {"resume", "go on with a run that was stopped or killed", app_resume_run},
    {"compare", "run a scene with several overlap models and compare", app_compare_run},
    {"report", "write a web page about one run or two, side by side", app_report_command_run},
    {"plot", "draw a run or two, or a frontier, for a paper", app_plot_command_run},
    {"check", "say what a run would do, without running", app_check_run},
    {"mesh", "say what a mesh holds: counts, volume, quality, what is wrong", app_mesh_run},
    {"schema", "print the scene file's JSON Schema, or its manual page", app_schema_run},
    {"effects", "list effects, materials, potentials, models and solvers", app_effects_run},
    {"bench", "measure overlap models and solvers", app_bench_run},
    {"datagen", "make labelled pairs of tetrahedra for learned overlap models", app_datagen_run},
    {"dataset", "tell, join or draw data sets of such pairs", app_dataset_run},
    {"train", "train a learned overlap model", app_train_run},
    {"eval", "measure an overlap model against labelled pairs", app_eval_run},
    {"weights", "say what a weights file holds", app_weights_run},
    {"pareto", "measure error against time of all overlap models", app_pareto_run},
    {"stress", "hold every hard case against physics, with every overlap model", app_stress_command_run},
    {"version", "print the versions of the program and its libraries", run_version},
    {"help", "print this; `tetlap COMMAND --help` tells more", run_help},
};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

static const Command *find(const char *name) {
  for (int i = 0; i < COMMAND_COUNT; i++)
    if (strcmp(commands[i].name, name) == 0) return &commands[i];
  return NULL;
}

static int fail_unknown(const char *name) {
  TextGuess guess = text_guess_of(name);
  for (int i = 0; i < COMMAND_COUNT; i++) text_guess_offer(&guess, commands[i].name);
  if (guess.best)
    log_error("unknown command '%s'; did you mean '%s'?", name, guess.best);
  else
    log_error("unknown command '%s'; `tetlap help` lists the commands", name);
  return status_exit_code(STATUS_USAGE);
}

static void print_commands(FILE *stream) {
  fputs("usage: tetlap COMMAND [OPTION…]\n\nDeformable bodies in contact: finite elements, overlap "
        "volumes.\n\n",
        stream);
  for (int i = 0; i < COMMAND_COUNT; i++) fprintf(stream, "  %-9s %s\n", commands[i].name, commands[i].help);
  fputs("\nFirst: tetlap run examples/01_drop.yaml\n", stream);
}

// Runs a command as `tetlap NAME`: that is how its usage lines call it.
static int run(const Command *command, int argument_count, char **arguments) {
  char name[64];
  snprintf(name, sizeof name, "tetlap %s", command->name);
  arguments[0] = name;
  return command->run(argument_count, arguments);
}

static int run_help(int argument_count, char **arguments) {
  if (argument_count < 2 || arguments[1][0] == '-') {
    print_commands(stdout);
    return 0;
  }
  const Command *command = find(arguments[1]);
  if (!command) return fail_unknown(arguments[1]);
  if (command->run == run_help || command->run == run_version) {
    print_commands(stdout);
    return 0;
  }
  char option[] = "--help";
  char *asking[] = {NULL, option, NULL};
  return run(command, 2, asking);
}

static int run_version(int argument_count, char **arguments) {
  (void)argument_count, (void)arguments;
  Record *versions = record_new();
  Status status = versions ? STATUS_OK : status_no_memory("the versions");
  if (!status) {
    app_versions_record(versions);
    status = record_print(versions, stdout);
  }
  record_destroy(versions);
  if (status) log_error("%s", status_message());
  return status_exit_code(status);
}

int app_program_run(int argument_count, char **arguments) {
  log_set_level(LOG_INFO);
  app_versions_set_command(argument_count, arguments);
  if (argument_count < 2) {
    print_commands(stderr);
    return status_exit_code(STATUS_USAGE);
  }
  const char *name = arguments[1];
  if (text_lists("-h -? --help", name)) name = "help";
  if (text_lists("-V --version", name)) name = "version";
  const Command *command = find(name);
  return command ? run(command, argument_count - 1, arguments + 1) : fail_unknown(name);
}
