// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/command/commands.h"

#include "app/cli/pages/manual.h"
#include "app/cli/parse.h"
#include "base/text.h"

enum { MOST_WORDS = 8, MOST_MESSAGE = 1024 };

typedef struct Options {
  const char *directory; // for manual pages; NULL: one page on standard output
  bool wants_page;
  char *words[MOST_WORDS]; // of the command that is asked about
  int word_count;
} Options;

static const AppOption option_table[] = {
    {"man", 0, NULL, "Print the command's page for man(1)", 0, CLI_FLAG, CLI_TO(Options, wants_page)},
    {"output", 'o', "DIR", "With --man: write the page and those of the commands below it into DIR", 0,
     CLI_TEXT, CLI_TO(Options, directory)},
    {0},
};

// The command that the words name, and how it is called.
static const AppCommand *find(const Options *options, char called[APP_CLI_MAX_CALL]) {
  const AppCommand *command = app_cli_command_root();
  size_t used = 0;
  text_append(called, APP_CLI_MAX_CALL, &used, "%s", command->name);
  for (int w = 0; w < options->word_count; w++) {
    const AppCommand *child = app_cli_command_find(command, options->words[w]);
    if (!child && command->children) {
      char message[MOST_MESSAGE];
      app_cli_command_explain(command, called, 1, &options->words[w], message, sizeof message);
      status_fail(STATUS_USAGE, "%s", message);
      return NULL;
    }
    if (!child) {
      status_fail(STATUS_USAGE, "'%s %s': %s is a command, so no other can follow", called, options->words[w],
                  called);
      return NULL;
    }
    command = child;
    text_append(called, APP_CLI_MAX_CALL, &used, " %s", child->name);
  }
  return command;
}

static Status flush(void) {
  return fflush(stdout) == 0 ? STATUS_OK : status_fail(STATUS_IO, "standard output cannot be written");
}

static int ask(const AppCommand *command, char called[APP_CLI_MAX_CALL]) {
  char option[] = "--help";
  char *asking[] = {called, option, NULL};
  return app_cli_command_run(command, 2, asking);
}

static void check(struct argp_state *state, void *given) {
  const Options *options = given;
  if (options->directory && !options->wants_page)
    argp_error(state, "-o is for manual pages: --man -o %s", options->directory);
}

static int run_command(int argument_count, char **arguments) {
  Options options = {0};
  app_cli_parse(&app_command_help, argument_count, arguments, &options);
  char called[APP_CLI_MAX_CALL];
  const AppCommand *command = find(&options, called);
  if (!command) return app_cli_command_end(STATUS_USAGE);
  if (!options.wants_page) return ask(command, called);
  if (options.directory) return app_cli_command_end(app_cli_manual_write(command, called, options.directory));
  Status status = app_cli_manual_print(command, called, stdout);
  return app_cli_command_end(status ? status : flush());
}

const AppCommand app_command_help = {
    .name = "help",
    .help = "print this; `help COMMAND` has the details",
    .options = option_table,
    .arguments = &(const AppArguments){"[COMMAND…]", offsetof(Options, words), MOST_WORDS,
                                       offsetof(Options, word_count), .excess = "'%s' is one word too many"},
    .doc = "List the commands, or describe one of them.",
    .check = check,
    .run = run_command};
