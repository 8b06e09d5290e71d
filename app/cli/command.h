// SPDX-License-Identifier: GPL-3.0-or-later
// A command of the program, or a group of them, as data: what `--help`, the manual pages and the completion
// of shells are made from.
#ifndef TETLAP_APP_CLI_COMMAND_H
#define TETLAP_APP_CLI_COMMAND_H

#include <stdbool.h>
#include <stdio.h>

#include "app/cli/option.h"
#include "base/status.h"

// Where a heading stands in a list of commands.
typedef struct AppHeading {
  const struct AppCommand *first; // the command that it stands above
  const char *text;
} AppHeading;

// A command has `run`, a group has `children`. All is constant and borrowed.
typedef struct AppCommand {
  const char *name;              // the word on the command line
  const char *help;              // one line, for lists of commands
  const AppOption *options;      // ended by a zeroed line; NULL: only those that every command has
  const AppArguments *arguments; // NULL: takes none
  void (*check)(struct argp_state *state,
                void *options); // of its options together, once they are read; NULL: none
  int (*run)(int argument_count,
             char **arguments);             // arguments[0]: the words that called it; gives the exit code
  bool has_threads;                         // computes for long, on many threads
  bool has_ranks;                           // several processes may share it (base/ranks.h)
  const void *rows;                         // what it prints rows of, for `describe_rows`; NULL: no rows
  char *(*describe_rows)(const void *rows); // a line for each key of a row; owned by the caller (free)
  const struct AppCommand *const *children; // of a group, such as `tetlap dataset VERB`; ended by NULL
  const AppHeading *headings;               // of a long group's list, ended by a zeroed line; NULL: none
  const char *child_word;                   // of a group: what a child is called, "verb"
  const char *child_of_files;               // the child that a file's name calls for; NULL: none
  const char *doc;    // what it does, above the options or children; behind a vertical tab what stands below
  const char *ending; // of a group: below the list of children
} AppCommand;

// The group of all commands, borrowed: set once, as the program begins, for the commands that describe
// all others.
void app_cli_command_set_root(const AppCommand *root);
const AppCommand *app_cli_command_root(void);

// How a command is called, as "tetlap dataset info"; longer ones are cut.
enum { APP_CLI_MAX_CALL = 256 };
void app_cli_command_call(char call[APP_CLI_MAX_CALL], const char *called, const AppCommand *child);

// NULL: there is none of that name.
const AppCommand *app_cli_command_find(const AppCommand *group, const char *name);

// Runs a command, or the child of a group that arguments[1] names. arguments[0] is how it was called, as
// "tetlap dataset"; it and those behind it are changed. Prints what is wrong; returns the exit code.
int app_cli_command_run(const AppCommand *command, int argument_count, char **arguments);

// How a command ends: says what went wrong, if anything did, and gives the program's exit code.
int app_cli_command_end(Status status);

// A message for `word` where a child of the group is expected: its place, and the nearest call that would be
// right. The arguments behind it are repeated there.
void app_cli_command_explain(const AppCommand *group, const char *called, int argument_count,
                             char *const *arguments, char *message, size_t size);

#endif
