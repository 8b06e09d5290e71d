// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/pages/manual.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "app/cli/options.h"
#include "app/cli/versions.h"
#include "base/files/file.h"
#include "base/memory.h"

// Text that roff shall not read as its own: a backslash, a control character at the start of a line.
// `is_literal`: each hyphen is the ASCII character, as in options.
static void put_text(FILE *stream, const char *text, size_t size, bool is_literal) {
  bool begins_line = true;
  for (size_t i = 0; i < size; i++) {
    char letter = text[i];
    if (begins_line && (letter == '.' || letter == '\'')) fputs("\\&", stream);
    if (letter == '\\')
      fputs("\\e", stream);
    else if (letter == '-' && is_literal)
      fputs("\\-", stream);
    else
      fputc(letter, stream);
    begins_line = letter == '\n';
  }
}

static void put(FILE *stream, const char *text) {
  put_text(stream, text, strlen(text), false);
}

static void put_literal(FILE *stream, const char *text) {
  put_text(stream, text, strlen(text), true);
}

// "tetlap dataset" as the name of a page, tetlap-dataset.
static void page_name(const char *called, char name[APP_CLI_MAX_CALL]) {
  snprintf(name, APP_CLI_MAX_CALL, "%s", called);
  for (char *at = name; *at; at++)
    if (*at == ' ') *at = '-';
}

static void put_head(FILE *stream, const AppCommand *command, const char *called) {
  char name[APP_CLI_MAX_CALL];
  page_name(called, name);
  fputs(".\\\" Made by `tetlap help --man`.\n.TH ", stream);
  for (const char *at = name; *at; at++) fputc(toupper((unsigned char)*at), stream);
  fprintf(stream, " 1 \"\" \"tetlap %s\" \"tetlap\"\n.SH NAME\n", app_versions_program());
  put_literal(stream, name);
  fputs(" \\- ", stream);
  put(stream, command->help);
  fputs("\n", stream);
}

// A usage line for each line of what argp calls the arguments.
static void put_synopsis(FILE *stream, const AppCommand *command, const char *called) {
  const char *rest = command->arguments && command->arguments->name ? command->arguments->name : "";
  fputs(".SH SYNOPSIS\n", stream);
  do {
    size_t length = strcspn(rest, "\n");
    fputs(".B ", stream);
    put_literal(stream, called);
    fputs("\n", stream);
    if (command->children) {
      fputs(".I ", stream);
      for (const char *at = command->child_word; *at; at++) fputc(toupper((unsigned char)*at), stream);
      fputs("\n", stream);
    }
    fputs("[\\fIOPTION\\fR…]\n", stream);
    put_text(stream, rest, length, false);
    fputs("\n.br\n", stream);
    rest += length + (rest[length] == '\n');
  } while (*rest);
}

// argp's description: what stands in front of the options, a vertical tab, what stands behind.
static void put_description(FILE *stream, const char *doc) {
  const char *tab = strchr(doc, '\v');
  fputs(".SH DESCRIPTION\n", stream);
  put_text(stream, doc, tab ? (size_t)(tab - doc) : strlen(doc), false);
  fputs("\n", stream);
  if (!tab) return;
  fputs(".PP\n", stream);
  put(stream, tab + 1);
  fputs("\n", stream);
}

static void put_option(void *stream_pointer, const AppOption *option) {
  FILE *stream = stream_pointer;
  fputs(".TP\n", stream);
  if (option->letter) fprintf(stream, "\\fB\\-%c\\fR, ", option->letter);
  fputs("\\fB\\-\\-", stream);
  put_literal(stream, option->name);
  fputs("\\fR", stream);
  if (option->argument) {
    fputs("=\\fI", stream);
    put(stream, option->argument);
    fputs("\\fR", stream);
  }
  fputs("\n", stream);
  put(stream, option->help);
  fputs("\n", stream);
}

static void put_children(FILE *stream, const AppCommand *group, const char *called) {
  fputs(".SH COMMANDS\n", stream);
  for (const AppCommand *const *child = group->children; *child; child++) {
    char name[APP_CLI_MAX_CALL], words[APP_CLI_MAX_CALL];
    app_cli_command_call(words, called, *child);
    page_name(words, name);
    fputs(".TP\n\\fB", stream);
    put_literal(stream, name);
    fputs("\\fR(1)\n", stream);
    put(stream, (*child)->help);
    fputs("\n", stream);
  }
}

static Status put_rows(FILE *stream, const AppCommand *command) {
  if (!command->rows) return STATUS_OK;
  char *rows = command->describe_rows(command->rows);
  if (!rows) return status_no_memory("the keys of a row");
  fputs(".SH ROWS\n.nf\n", stream);
  put(stream, rows);
  fputs(".fi\n", stream);
  free(rows);
  return STATUS_OK;
}

static void put_end(FILE *stream, const char *called) {
  static const struct {
    Status status;
    const char *meaning;
  } codes[] = {
      {STATUS_OK, "done"},
      {STATUS_USAGE, "the command line is wrong"},
      {STATUS_INPUT, "a file that was read is wrong"},
      {STATUS_DEVICE, "an accelerator or a model's process is not there, or failed"},
      {STATUS_SOLVER, "the solver gave up, or what was asked does not hold"},
      {STATUS_MEMORY, "no memory"},
      {STATUS_IO, "a file could not be read or written"},
      {STATUS_INTERRUPTED, "interrupted by Ctrl-C or SIGTERM"},
  };
  fputs(".SH EXIT STATUS\n", stream);
  for (size_t k = 0; k < sizeof codes / sizeof *codes; k++)
    fprintf(stream, ".TP\n%d\n%s\n", status_exit_code(codes[k].status), codes[k].meaning);
  fputs(
      ".SH ENVIRONMENT\n.TP\nOMP_NUM_THREADS\nthreads, where neither an option nor the scene says how many\n"
      ".TP\nNO_COLOR\nno colours in messages\n",
      stream);
  if (strchr(called, ' ')) fputs(".SH SEE ALSO\n.BR tetlap (1)\n", stream);
}

Status app_cli_manual_print(const AppCommand *command, const char *called, FILE *stream) {
  put_head(stream, command, called);
  put_synopsis(stream, command, called);
  put_description(stream, command->doc);
  if (command->children) put_children(stream, command, called);
  if (!command->children) {
    fputs(".SH OPTIONS\n", stream);
    app_cli_options_visit(command, put_option, stream);
  }
  TRY(put_rows(stream, command));
  put_end(stream, called);
  return STATUS_OK;
}

static Status write_page(const AppCommand *command, const char *called, const char *directory) {
  char name[APP_CLI_MAX_CALL], file[APP_CLI_MAX_CALL + 2];
  page_name(called, name);
  snprintf(file, sizeof file, "%s.1", name);
  char *path = file_join(directory, file);
  if (!path) return status_no_memory("a file name");
  FileWriter writer = {0};
  Status status = file_begin(&writer, path);
  if (!status) status = app_cli_manual_print(command, called, writer.stream);
  if (!status) status = file_commit(&writer);
  file_abandon(&writer);
  memory_free(path);
  return status;
}

Status app_cli_manual_write(const AppCommand *command, const char *called, const char *directory) {
  TRY(file_make_directories(directory));
  TRY(write_page(command, called, directory));
  for (const AppCommand *const *child = command->children; child && *child; child++) {
    char words[APP_CLI_MAX_CALL];
    app_cli_command_call(words, called, *child);
    TRY(app_cli_manual_write(*child, words, directory));
  }
  return STATUS_OK;
}
