// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/pages/completion.h"

#include <string.h>

#include "app/cli/options.h"
#include "overlap/models.h"

AppCliShell app_cli_completion_find(const char *name) {
  static const char *const names[APP_CLI_SHELL_COUNT] = {"bash", "zsh", "fish"};
  int shell = 0;
  while (shell < APP_CLI_SHELL_COUNT && strcmp(names[shell], name) != 0) shell++;
  return (AppCliShell)shell;
}

// A command and what is printed of it.
typedef struct Script {
  FILE *stream;
  const char *called; // the words that call the command, as "tetlap run"
} Script;

typedef void (*PrintCommand)(FILE *stream, const AppCommand *command, const char *called);

static void print_each(FILE *stream, const AppCommand *command, const char *called, PrintCommand print) {
  print(stream, command, called);
  for (const AppCommand *const *child = command->children; child && *child; child++) {
    char words[APP_CLI_MAX_CALL];
    app_cli_command_call(words, called, *child);
    print_each(stream, *child, words, print);
  }
}

static void print_models(FILE *stream) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  for (int m = 0; m < count; m++) fprintf(stream, "%s%s", m ? " " : "", models[m]->name);
}

// Text within single quotes of a shell; a backslash goes before each of `special`.
static void print_quoted(FILE *stream, const char *text, const char *special) {
  for (; *text; text++) {
    if (*text == '\'')
      fputs("'\\''", stream);
    else
      fprintf(stream, "%s%c", strchr(special, *text) ? "\\" : "", *text);
  }
}

// A pattern of a shell's `case` for each command below a group: the words with which it is gone into.
static void print_pattern(FILE *stream, const AppCommand *command, const char *called) {
  for (const AppCommand *const *child = command->children; child && *child; child++)
    fprintf(stream, "      '%s %s') ;;\n", called, (*child)->name);
}

// bash

static void print_bash_option(void *self, const AppOption *option) {
  const Script *script = self;
  fprintf(script->stream, " --%s", option->name);
  if (option->letter) fprintf(script->stream, " -%c", option->letter);
}

static void print_bash_command(FILE *stream, const AppCommand *command, const char *called) {
  Script script = {stream, called};
  fprintf(stream, "    '%s')\n", called);
  if (command->children) {
    fputs("      words='", stream);
    for (const AppCommand *const *child = command->children; *child; child++)
      fprintf(stream, "%s%s", child == command->children ? "" : " ", (*child)->name);
    fputs("'\n", stream);
  }
  if (!command->children) {
    fputs("      options='", stream);
    app_cli_options_visit(command, print_bash_option, &script);
    fputs("'\n", stream);
  }
  fputs("      ;;\n", stream);
}

// What may stand behind an option: models; anything that is no file; files, which are what bash completes by
// itself.
static void print_bash_value(void *self, const AppOption *option) {
  const Script *script = self;
  if (!option->argument || app_cli_options_takes_path(option)) return;
  fprintf(script->stream, "    '%s --%s'", script->called, option->name);
  if (option->letter) fprintf(script->stream, " | '%s -%c'", script->called, option->letter);
  fputs(app_cli_options_takes_model(option) ? ") words=$models options= ;;\n" : ") return ;;\n",
        script->stream);
}

static void print_bash_values(FILE *stream, const AppCommand *command, const char *called) {
  if (!command->children) app_cli_options_visit(command, print_bash_value, &(Script){stream, called});
}

static void print_bash(const AppCommand *program, FILE *stream) {
  fputs("# Completion for bash, made by `tetlap completion bash`.\n"
        "_tetlap() {\n"
        "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} called=tetlap words= "
        "options= i\n"
        "  local models='",
        stream);
  print_models(stream);
  fputs("'\n"
        "  [[ $word == = ]] && word=\n"
        "  [[ $before == = ]] && before=${COMP_WORDS[COMP_CWORD-2]}\n"
        "  COMPREPLY=()\n"
        "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
        "    case \"$called ${COMP_WORDS[i]}\" in\n",
        stream);
  print_each(stream, program, program->name, print_pattern);
  fputs("      *) continue ;;\n"
        "    esac\n"
        "    called=\"$called ${COMP_WORDS[i]}\"\n"
        "  done\n"
        "  case $called in\n",
        stream);
  print_each(stream, program, program->name, print_bash_command);
  fputs("  esac\n"
        "  case \"$called $before\" in\n",
        stream);
  print_each(stream, program, program->name, print_bash_values);
  fputs("  esac\n"
        "  [[ $word == -* ]] && words=$options\n"
        "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
        "}\n"
        "complete -o default -F _tetlap tetlap\n",
        stream);
}

// zsh

static void print_zsh_action(FILE *stream, const AppOption *option) {
  if (!option->argument) return;
  fputs(":", stream);
  print_quoted(stream, option->argument, ":[]\\");
  if (app_cli_options_takes_path(option))
    fputs(":_files", stream);
  else if (app_cli_options_takes_model(option))
    fputs(":_sequence compadd - $models", stream);
  else
    fputs(": ", stream);
}

static void print_zsh_option(void *self, const AppOption *option) {
  const Script *script = self;
  const char *equals = option->argument ? "=" : "";
  if (option->letter)
    fprintf(script->stream, " \\\n        '(-%c --%s)'{-%c%s,--%s%s}'[", option->letter, option->name,
            option->letter, option->argument ? "+" : "", option->name, equals);
  else
    fprintf(script->stream, " \\\n        '--%s%s[", option->name, equals);
  print_quoted(script->stream, option->help, "[]:\\");
  fputs("]", script->stream);
  print_zsh_action(script->stream, option);
  fputs("'", script->stream);
}

static void print_zsh_command(FILE *stream, const AppCommand *command, const char *called) {
  fprintf(stream, "    '%s')\n", called);
  if (command->children) {
    fputs("      local -a children=(", stream);
    for (const AppCommand *const *child = command->children; *child; child++) {
      fprintf(stream, "\n        '%s:", (*child)->name);
      print_quoted(stream, (*child)->help, ":\\");
      fputs("'", stream);
    }
    fprintf(stream, ")\n      _describe '%s' children\n", command->child_word);
  } else {
    fputs("      _arguments -s", stream);
    app_cli_options_visit(command, print_zsh_option, &(Script){stream, called});
    fputs(" \\\n        '*:file:_files'\n", stream);
  }
  fputs("      ;;\n", stream);
}

static void print_zsh(const AppCommand *program, FILE *stream) {
  fputs("#compdef tetlap\n"
        "# Completion for zsh, made by `tetlap completion zsh`.\n"
        "_tetlap() {\n"
        "  local called=tetlap\n"
        "  local -a models=(",
        stream);
  print_models(stream);
  fputs(")\n"
        "  while ((CURRENT > 2)); do\n"
        "    case \"$called ${words[2]}\" in\n",
        stream);
  print_each(stream, program, program->name, print_pattern);
  fputs("      *) break ;;\n"
        "    esac\n"
        "    called=\"$called ${words[2]}\"\n"
        "    shift words\n"
        "    ((CURRENT--))\n"
        "  done\n"
        "  case $called in\n",
        stream);
  print_each(stream, program, program->name, print_zsh_command);
  fputs("  esac\n"
        "}\n"
        "_tetlap \"$@\"\n",
        stream);
}

// fish

// The words of every command but the program itself, as patterns of a switch.
static void print_fish_case(FILE *stream, const AppCommand *command, const char *called) {
  (void)command;
  if (strchr(called, ' ')) fprintf(stream, " '%s'", called);
}

// Text within single quotes of fish, where a backslash is needed before a quote and a backslash.
static void print_fish_text(FILE *stream, const char *text) {
  for (; *text; text++) fprintf(stream, "%s%c", *text == '\'' || *text == '\\' ? "\\" : "", *text);
}

static void print_fish_option(void *self, const AppOption *option) {
  const Script *script = self;
  fprintf(script->stream, "complete -c tetlap -n '__tetlap_is \"%s\"' -l %s", script->called, option->name);
  if (option->letter) fprintf(script->stream, " -s '%c'", option->letter);
  if (app_cli_options_takes_model(option)) {
    fputs(" -x -a '", script->stream);
    print_models(script->stream);
    fputs("'", script->stream);
  } else if (option->argument)
    fputs(app_cli_options_takes_path(option) ? " -r -F" : " -x", script->stream);
  fputs(" -d '", script->stream);
  print_fish_text(script->stream, option->help);
  fputs("'\n", script->stream);
}

static void print_fish_command(FILE *stream, const AppCommand *command, const char *called) {
  for (const AppCommand *const *child = command->children; child && *child; child++) {
    fprintf(stream, "complete -c tetlap -n '__tetlap_is \"%s\"' -f -a %s -d '", called, (*child)->name);
    print_fish_text(stream, (*child)->help);
    fputs("'\n", stream);
  }
  if (!command->children) app_cli_options_visit(command, print_fish_option, &(Script){stream, called});
}

static void print_fish(const AppCommand *program, FILE *stream) {
  fputs("# Completion for fish, made by `tetlap completion fish`.\n"
        "function __tetlap_is\n"
        "  set -l called tetlap\n"
        "  for word in (commandline -opc)[2..-1]\n"
        "    switch \"$called $word\"\n"
        "      case",
        stream);
  print_each(stream, program, program->name, print_fish_case);
  fputs("\n"
        "        set called \"$called $word\"\n"
        "    end\n"
        "  end\n"
        "  test \"$called\" = $argv[1]\n"
        "end\n",
        stream);
  print_each(stream, program, program->name, print_fish_command);
}

void app_cli_completion_print(const AppCommand *program, AppCliShell shell, FILE *stream) {
  switch (shell) {
  case APP_CLI_SHELL_BASH:
    print_bash(program, stream);
    break;
  case APP_CLI_SHELL_ZSH:
    print_zsh(program, stream);
    break;
  case APP_CLI_SHELL_FISH:
    print_fish(program, stream);
    break;
  case APP_CLI_SHELL_COUNT:
    break;
  }
}
