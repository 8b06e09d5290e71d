// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/program.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/bench/bench.h"
#include "app/cli/ranks.h"
#include "app/cli/versions.h"
#include "app/command/commands.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/status.h"
#include "base/text.h"

// mpiexec ends all ranks when the first one fails: those that are not heard give the other so long to speak.
enum { PATIENCE_S = 2 };

static const AppCommand *const commands[] = {
    &app_command_run,
    &app_command_resume,
    &app_command_check,
    &app_command_compare,
    &app_command_sweep,
    &app_command_gradient,
    &app_command_report,
    &app_command_view,
    &app_command_render,
    &app_command_plot,
    &app_command_mesh,
    &app_command_schema,
    &app_command_effects,
    &app_command_overlap,
    &app_command_poses,
    &app_command_eval,
    &app_bench_bench,
    &app_command_verdict,
    &app_command_stress,
    &app_command_weights,
    &app_command_datagen,
    &app_command_dataset,
    &app_command_train,
    &app_command_devices,
    &app_command_serve,
    &app_command_completion,
    &app_command_version,
    &app_command_help,
    NULL,
};

static const AppHeading headings[] = {
    {&app_command_run, "Compute"},
    {&app_command_report, "Look at results"},
    {&app_command_mesh, "Write a scene"},
    {&app_command_overlap, "Use and judge overlap models"},
    {&app_command_datagen, "Train overlap models"},
    {&app_command_devices, "The program and its machine"},
    {NULL, NULL},
};

const AppCommand app_program_root = {
    .name = "tetlap",
    .help = "deformable bodies in contact: finite elements, overlap volumes",
    .children = commands,
    .headings = headings,
    .child_word = "command",
    .child_of_files = "run",
    .doc = "Deformable bodies in contact: finite elements, overlap volumes.",
    .ending = "First: tetlap run examples/01_drop.yaml",
};

// The words for which options are usual.
static char *command_of(char *word) {
  static char help[] = "help", version[] = "version";
  return text_lists("-h -? --help", word) ? help : text_lists("-V --version", word) ? version : word;
}

// The command that the words call for; NULL: none, or its help.
static const AppCommand *find_command(const AppCommand *root, int argument_count, char *const *arguments) {
  const AppCommand *command = root;
  for (int i = 1; i < argument_count && command; i++) {
    if (text_lists("-? --help --usage", arguments[i])) return NULL;
    if (command->children) command = app_cli_command_find(command, arguments[i]);
  }
  return command && !command->children ? command : NULL;
}

bool app_program_has_threads(const AppCommand *root, int argument_count, char *const *arguments) {
  const AppCommand *command = find_command(root, argument_count, arguments);
  return command && command->has_threads;
}

// What was printed must have arrived.
static int flush_output(int exit_code) {
  bool is_whole = fflush(stdout) == 0 && !ferror(stdout);
  if (is_whole || exit_code != 0) return exit_code;
  fprintf(stderr, "error: standard output cannot be written: %s\n", strerror(errno));
  return status_exit_code(STATUS_IO);
}

int app_program_run(const AppCommand *root, int argument_count, char **arguments) {
  static char name[32];
  snprintf(name, sizeof name, "%s", root->name);
  log_set_level(LOG_INFO);
  signal(SIGXFSZ, SIG_IGN); // a limit of file sizes is then an error of writing, with a message
  app_versions_set_command(argument_count, arguments);
  arguments[0] = name;
  app_cli_command_set_root(root);
  if (argument_count > 1) arguments[1] = command_of(arguments[1]);
  const AppCommand *command = find_command(root, argument_count, arguments);
  if (command) app_ranks_keep_line();
  Status status = command ? app_ranks_check(command) : STATUS_OK;
  if (status) {
    if (app_ranks_is_heard())
      log_error("%s", status_message());
    else
      sleep(PATIENCE_S);
    return status_exit_code(status);
  }
  return flush_output(app_cli_command_run(root, argument_count, arguments));
}

// Threads that wait shall sleep soon: on a machine that others use too, spinning ones held a matrix product
// of 20 k vertices for 17 ms instead of 2.4 ms. Sleeping at once makes a run on two cores slower than on one,
// so they spin some microseconds; five times as long gains nothing there and doubles the time on a busy
// machine. libgomp reads this before main, so the program starts itself once more; only for commands that
// have threads, since a start takes a hundredth of a second.
static void let_threads_sleep(char **arguments) {
  bool is_set = getenv("OMP_WAIT_POLICY") || setenv("OMP_WAIT_POLICY", "passive", 1) != 0;
  if (is_set || setenv("GOMP_SPINCOUNT", "1000", 0) != 0) return;
  execv("/proc/self/exe", arguments); // where that fails, the run is only slower
}

int app_program_main(const AppCommand *root, int argument_count, char **arguments) {
  memory_separate();
  if (app_program_has_threads(root, argument_count, arguments)) let_threads_sleep(arguments);
  return app_program_run(root, argument_count, arguments);
}
