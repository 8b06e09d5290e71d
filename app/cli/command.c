// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/command.h"

#include <string.h>

#include "base/files/file.h"
#include "base/log.h"
#include "base/status.h"
#include "base/text.h"

enum { MOST_MESSAGE = 1024 };

static const AppCommand *root_group;

void app_cli_command_set_root(const AppCommand *root) {
  root_group = root;
}

const AppCommand *app_cli_command_root(void) {
  return root_group;
}

void app_cli_command_call(char call[APP_CLI_MAX_CALL], const char *called, const AppCommand *child) {
  size_t used = 0;
  text_append(call, APP_CLI_MAX_CALL, &used, "%s %s", called, child->name);
}

const AppCommand *app_cli_command_find(const AppCommand *group, const char *name) {
  for (const AppCommand *const *child = group->children; child && *child; child++)
    if (strcmp((*child)->name, name) == 0) return *child;
  return NULL;
}

static int widest_of(const AppCommand *group) {
  int widest = 0;
  for (const AppCommand *const *child = group->children; *child; child++) {
    int length = (int)strlen((*child)->name);
    if (length > widest) widest = length;
  }
  return widest;
}

static void print_heading(const AppHeading *heading, const AppCommand *child, FILE *stream) {
  for (; heading && heading->first; heading++)
    if (heading->first == child) fprintf(stream, "%s\n", heading->text);
}

// The usage line of a group and the list of its children.
static void print_group(const AppCommand *group, const char *called, FILE *stream) {
  fprintf(stream, "Usage: %s ", called);
  for (const char *letter = group->child_word; *letter; letter++) fputc(*letter - 'a' + 'A', stream);
  fprintf(stream, " [OPTION...]\n%s\n\n", group->doc);
  for (const AppCommand *const *child = group->children; *child; child++) {
    print_heading(group->headings, *child, stream);
    fprintf(stream, "  %-*s  %s\n", widest_of(group), (*child)->name, (*child)->help);
  }
  fprintf(stream, "\n%s\n", group->ending);
}

// The nearest child's name; NULL: none is near.
static const char *guess(const AppCommand *group, const char *word) {
  TextGuess nearest = text_guess_of(word);
  for (const AppCommand *const *child = group->children; *child; child++)
    text_guess_offer(&nearest, (*child)->name);
  return nearest.best;
}

// The group below this one that has a child of that name; NULL: none.
static const AppCommand *find_owner(const AppCommand *group, const char *word) {
  for (const AppCommand *const *child = group->children; *child; child++)
    if ((*child)->children && app_cli_command_find(*child, word)) return *child;
  return NULL;
}

static bool looks_like_file(const char *word) {
  return strchr(word, '.') || strchr(word, '/') || file_exists(word);
}

static void append_rest(char *message, size_t size, size_t *used, int argument_count,
                        char *const *arguments) {
  for (int i = 0; i < argument_count; i++) text_append(message, size, used, " %s", arguments[i]);
}

static void append_children(const AppCommand *group, char *message, size_t size, size_t *used) {
  for (const AppCommand *const *child = group->children; *child; child++)
    text_append(message, size, used, "%s%s", child == group->children ? "" : ", ", (*child)->name);
}

void app_cli_command_explain(const AppCommand *group, const char *called, int argument_count,
                             char *const *arguments, char *message, size_t size) {
  size_t used = 0;
  const char *word = arguments[0], *near = guess(group, word);
  const AppCommand *owner = find_owner(group, word);
  bool is_file = !near && !owner && group->child_of_files && looks_like_file(word);
  if (word[0] == '-')
    text_append(message, size, &used, "%s: found the option '%s' where a %s is expected", called, word,
                group->child_word);
  else if (is_file)
    text_append(message, size, &used, "%s: '%s' is a file, where a %s is expected", called, word,
                group->child_word);
  else
    text_append(message, size, &used, "%s: there is no %s '%s'", called, group->child_word, word);
  if (word[0] == '-' || !(near || owner || is_file)) {
    text_append(message, size, &used, "; there are: ");
    append_children(group, message, size, &used);
    return;
  }
  text_append(message, size, &used, "; did you mean: %s", called);
  if (owner)
    text_append(message, size, &used, " %s %s", owner->name, word);
  else if (near)
    text_append(message, size, &used, " %s", near);
  else
    text_append(message, size, &used, " %s %s", group->child_of_files, word);
  append_rest(message, size, &used, argument_count - 1, arguments + 1);
}

static int fail_unknown(const AppCommand *group, int argument_count, char **arguments) {
  char message[MOST_MESSAGE];
  app_cli_command_explain(group, arguments[0], argument_count - 1, arguments + 1, message, sizeof message);
  log_error("%s", message);
  return status_exit_code(STATUS_USAGE);
}

static int run_group(const AppCommand *group, int argument_count, char **arguments) {
  if (argument_count < 2) {
    print_group(group, arguments[0], stderr);
    return status_exit_code(STATUS_USAGE);
  }
  if (text_lists("-h -? --help", arguments[1])) {
    print_group(group, arguments[0], stdout);
    return 0;
  }
  const AppCommand *child = app_cli_command_find(group, arguments[1]);
  if (!child) return fail_unknown(group, argument_count, arguments);
  char called[APP_CLI_MAX_CALL];
  app_cli_command_call(called, arguments[0], child);
  arguments[1] = called;
  return app_cli_command_run(child, argument_count - 1, arguments + 1);
}

int app_cli_command_end(Status status) {
  if (status) log_error("%s", status_message());
  return status_exit_code(status);
}

int app_cli_command_run(const AppCommand *command, int argument_count, char **arguments) {
  return command->children ? run_group(command, argument_count, arguments)
                           : command->run(argument_count, arguments);
}
