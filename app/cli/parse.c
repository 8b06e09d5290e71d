// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/parse.h"

#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>

#include "app/cli/argument.h"

enum { MOST_OPTIONS = 48, FIRST_KEY = 256 }; // argp's keys for options without a letter

typedef struct Reading {
  const AppCommand *command;
  char *options;                              // the command's struct
  const AppOption *lines[MOST_OPTIONS];       // of its tables
  char *structs[MOST_OPTIONS];                // that each line is about
  struct argp_option table[MOST_OPTIONS + 1]; // the same for argp, ended by a zeroed one
  int count, argument_count;
} Reading;

static void add_table(Reading *reading, const AppOption *option, char *options) {
  for (; option && (option->name || option->table); option++) {
    if (option->table) {
      add_table(reading, option->table, options + option->offset);
      continue;
    }
    int i = reading->count++;
    assert(i < MOST_OPTIONS);
    reading->lines[i] = option, reading->structs[i] = options;
    reading->table[i] = (struct argp_option){.name = option->name,
                                             .key = option->letter ? option->letter : FIRST_KEY + i,
                                             .arg = option->argument,
                                             .doc = option->help,
                                             .group = option->group};
  }
}

static void read_integer(struct argp_state *state, const AppOption *option, void *member, const char *text) {
  long long most = isinf(option->most) ? LLONG_MAX : (long long)option->most;
  long long value = app_argument_integer(state, option->name, text, (long long)option->least, most);
  if (option->size == sizeof(int))
    *(int *)member = (int)value;
  else
    *(long long *)member = value;
}

static void read_option(struct argp_state *state, const AppOption *option, char *options, char *text) {
  void *member = options + option->offset, *count = options + option->count_offset;
  const char *name = option->name;
  if (option->mark_offset) *(bool *)(options + option->mark_offset) = true;
  switch (option->type) {
  case CLI_FLAG:
    *(bool *)member = true;
    break;
  case CLI_VALUE:
    *(int *)member = (int)option->least;
    break;
  case CLI_TEXT:
    *(const char **)member = text;
    break;
  case CLI_INTEGER:
    read_integer(state, option, member, text);
    break;
  case CLI_NUMBER:
    *(double *)member = app_argument_number(state, name, text, option->least, option->most);
    break;
  case CLI_POSITIVE:
    *(double *)member = app_argument_positive(state, name, text);
    break;
  case CLI_SEED:
    *(uint64_t *)member = app_argument_seed(state, text);
    break;
  case CLI_WORDS:
    *(const char **)member = app_argument_words(state, name, text, option->example);
    break;
  case CLI_LIST:
    *(int *)count = app_argument_list(state, name, text, option->example, (int)option->most, member);
    break;
  case CLI_REPEATED:
    app_argument_add(state, option->example, text, (int)option->most, member, count);
    break;
  case CLI_CHOICES:
    app_argument_choose(state, name, text, option->choices, (int)option->most, member);
    break;
  case CLI_OWN:
    option->read(state, member, text);
    break;
  }
}

static void read_argument(struct argp_state *state, Reading *reading, const char *text) {
  const AppArguments *known = reading->command->arguments;
  int most = known ? known->most : 0;
  if (known && reading->argument_count == most)
    argp_error(state, known->excess, text, most);
  else if (!known)
    argp_error(state, "'%s' is one argument too many: %s takes no arguments", text, reading->command->name);
  else
    ((const char **)(void *)(reading->options + known->offset))[reading->argument_count++] = text;
  if (most > 1) *(int *)(void *)(reading->options + known->count_offset) = reading->argument_count;
}

static void check(struct argp_state *state, const Reading *reading) {
  const AppCommand *command = reading->command;
  if (command->arguments && command->arguments->missing && reading->argument_count == 0)
    argp_error(state, "%s", command->arguments->missing);
  if (command->check) command->check(state, reading->options);
}

static error_t parse(int key, char *text, struct argp_state *state) {
  Reading *reading = state->input;
  for (int i = 0; i < reading->count; i++)
    if (reading->table[i].key == key) {
      read_option(state, reading->lines[i], reading->structs[i], text);
      return 0;
    }
  if (key == ARGP_KEY_ARG)
    read_argument(state, reading, text);
  else if (key == ARGP_KEY_END)
    check(state, reading);
  else
    return ARGP_ERR_UNKNOWN;
  return 0;
}

// Below the options, the keys of a row.
static char *end_help(int key, const char *text, void *reading) {
  const AppCommand *command = ((const Reading *)reading)->command;
  if (key != ARGP_KEY_HELP_POST_DOC || !command->rows)
    return (char *)(uintptr_t)text; // argp's own way: it is not changed
  return command->describe_rows(command->rows);
}

void app_cli_parse(const AppCommand *command, int argument_count, char **arguments, void *options) {
  Reading reading = {.command = command, .options = options};
  add_table(&reading, command->options, options);
  const struct argp argp = {.options = reading.table,
                            .parser = parse,
                            .args_doc = command->arguments ? command->arguments->name : NULL,
                            .doc = command->doc,
                            .help_filter = end_help};
  argp_parse(&argp, argument_count, arguments, 0, NULL, &reading);
}
