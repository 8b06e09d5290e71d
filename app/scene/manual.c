// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/manual.h"

#include <string.h>

#include "app/scene/keys/keys.h"
#include "base/expression.h"

enum { MAX_SECTIONS = 64, PATH_SIZE = 128 };

// Sections that have a chapter already: some stand in several places.
typedef struct Manual {
  FILE *stream;
  const SceneSection *told[MAX_SECTIONS];
  char told_as[MAX_SECTIONS][PATH_SIZE];
  int told_count;
} Manual;

static const char *const introduction =
    "# The scene file\n"
    "\n"
    "<!-- Made by `tetlap schema --markdown` from the tables in app/scene/keys/*.c: change those, not this. "
    "-->\n"
    "\n"
    "A scene is a YAML or JSON file that says the bodies, what acts on them, and what is written. Units are\n"
    "SI: metres, kilograms, seconds. Paths of meshes are relative to the scene file. A first one:\n"
    "\n"
    "```yaml\n"
    "time: {end: 0.5}\n"
    "effects: {gravity: [0, 0, -9.81]}\n"
    "bodies:\n"
    "  - name: block\n"
    "    mesh: {box: {size: [0.2, 0.2, 0.2], cells: 4}}\n"
    "    place: {translate: [0, 0, 0.05]}\n"
    "    material: {young: 1e5, poisson: 0.3, density: 1000}\n"
    "obstacles:\n"
    "  - {name: ground, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}\n"
    "contact: {}\n"
    "```\n"
    "\n"
    "A run computes only what its scene names: without `contact` bodies pass through each other, without "
    "`effects.gravity` nothing\n"
    "falls. `tetlap check SCENE` prints what a run would do. `tetlap schema > scene.schema.json` writes a "
    "JSON "
    "Schema; an editor\n"
    "with support for YAML schemas completes and checks keys if the scene begins with\n"
    "`# yaml-language-server: $schema=scene.schema.json`.\n"
    "\n"
    "Any value can be replaced on the command line: `--set contact.stiffness=1e6`,\n"
    "`--set bodies.block.material.young=2e5`, `--set 'bodies[0].velocity=[0, 0, -1]'`, `--set contact=null` "
    "(as if the key were\n"
    "not there).\n"
    "\n"
    "A key that is unknown, given twice, of the wrong type or out of its range is refused with its line and "
    "column. Numbers are\n"
    "written `3`, `0.5`, `1e6`; where the range says so also `.inf`. Ranges: a square bracket includes the "
    "end, a round one\n"
    "does not. YAML's anchors, aliases, tags and multiple documents are not supported; indent with spaces.\n";

static const char *const about_formulas =
    "\n"
    "## Formulas\n"
    "\n"
    "A formula is a function of the time t [s]: numbers, `t`, `pi`, `+ "
    "- * / ^`, brackets, and the functions below. `^` "
    "binds more strongly than a sign: `-t^2`\n"
    "is `-(t^2)`. Where its value is not a number, as for `log(t)` at 0, the run ends with an error that "
    "gives its place, its text and the "
    "time.\n"
    "\n"
    "| function | |\n"
    "|---|---|\n";

static void print_formulas(FILE *stream) {
  const char *name, *help;
  fputs(about_formulas, stream);
  for (int i = 0; (name = expression_function(i, &help)); i++) fprintf(stream, "| `%s` | %s |\n", name, help);
}

// A table's cell must not hold a bar.
static void print_cell(FILE *stream, const char *text) {
  for (; text && *text; text++) {
    if (*text == '|') fputc('\\', stream);
    fputc(*text, stream);
  }
}

static bool stands_for_number(const SceneSection *section) {
  return app_scene_keys_find(section, section->shorthand)->type == SCENE_NUMBER;
}

static const char *type_of(const SceneKey *key) {
  switch (key->type) {
  case SCENE_NUMBER:
    return "number";
  case SCENE_INTEGER:
    return "whole number";
  case SCENE_SWITCH:
    return "true or false";
  case SCENE_TRUE:
    return "`true`";
  case SCENE_TEXT:
    return "text";
  case SCENE_LABEL:
    return "name: letters, digits, `_`, `-`";
  case SCENE_NAME:
  case SCENE_CHOICE:
    return "one of the names below";
  case SCENE_VECTOR:
    return "[x, y, z]";
  case SCENE_DIRECTION:
    return "[x, y, z], not zero";
  case SCENE_FACTORS:
    return "number or [x, y, z], not zero";
  case SCENE_COUNTS:
    return "whole number or [x, y, z]";
  case SCENE_TWO:
    return "list of two names";
  case SCENE_AXES:
    return "list of x, y, z";
  case SCENE_ROWS:
    return "list of [t, x, y, z]";
  case SCENE_PROFILE:
    return key->argument ? "list of [d, value]" : "list of [t, value]";
  case SCENE_FORMULA:
    return key->argument ? "formula of d" : "formula of t";
  case SCENE_SECTION:
    if (!key->section->shorthand) return "mapping";
    return stands_for_number(key->section) ? "number or mapping" : "text or mapping";
  case SCENE_LIST:
    return "list of mappings";
  }
  return "";
}

static void print_default(FILE *stream, const SceneKey *key) {
  if (key->required)
    fputs("required", stream);
  else if (key->fallback)
    fprintf(stream, "`%s`", key->fallback);
  else if (key->absent_help)
    print_cell(stream, key->absent_help);
  else
    fputs("–", stream);
}

// "See …", needs and excludes after the help.
static void print_help(FILE *stream, const SceneKey *key, const char *chapter) {
  print_cell(stream, key->help);
  if (key->needs) fprintf(stream, "; with `%s` only", key->needs);
  if (key->excludes && !key->needs) fprintf(stream, "; not with `%s`", key->excludes);
  if (chapter) fprintf(stream, "; see [%s](#%s)", chapter, chapter);
}

static int find_told(const Manual *manual, const SceneSection *section) {
  for (int i = 0; i < manual->told_count; i++)
    if (manual->told[i] == section) return i;
  return -1;
}

// Chapters are headed by paths whose points and brackets are dashes, so that links are the same everywhere.
static void name_chapter(const char *above, const char *key, char chapter[PATH_SIZE]) {
  snprintf(chapter, PATH_SIZE, "%s%s%s", above, above[0] ? "-" : "", key);
}

static const char *note_section(Manual *manual, const SceneSection *section, const char *chapter) {
  int index = find_told(manual, section);
  if (index < 0 && manual->told_count < MAX_SECTIONS) {
    index = manual->told_count++;
    manual->told[index] = section;
    snprintf(manual->told_as[index], PATH_SIZE, "%s", chapter);
  }
  return index < 0 ? chapter : manual->told_as[index];
}

static void print_choices(FILE *stream, const SceneKey *key) {
  fprintf(stream, "\n`%s` is one of\n\n| name | what |\n|---|---|\n", key->name);
  const char *name;
  for (int i = 0; (name = app_scene_section_name(key->choices, i)); i++) {
    fprintf(stream, "| `%s` | ", name);
    print_cell(stream, app_scene_section_help(key->choices, i));
    fputs(" |\n", stream);
  }
  if (key->choices->accepts) fprintf(stream, "\nor %s.\n", key->choices->accepts_help);
}

static void print_rules(FILE *stream, const SceneSection *section) {
  char word[TEXT_MAX_WORD];
  const char *const lists[] = {section->one_of, section->some_of};
  const char *const says[] = {"Exactly one of", "At least one of"};
  for (int l = 0; l < 2; l++) {
    if (!lists[l]) continue;
    fprintf(stream, "\n%s", says[l]);
    int count = 0;
    for (const char *rest = text_next(lists[l], word); rest; rest = text_next(rest, word))
      fprintf(stream, "%s `%s`", count++ ? "," : "", word);
    fputs(" must be given.\n", stream);
  }
  if (section->shorthand)
    fprintf(stream, "\nA %s in the place of the mapping stands for its `%s`.\n",
            stands_for_number(section) ? "number" : "text", section->shorthand);
}

// The table of one section, its choices and rules, then the sections below it.
static void print_section(Manual *manual, const SceneSection *section, const char *chapter) {
  FILE *stream = manual->stream;
  const SceneKey *key;
  char below[PATH_SIZE];
  fputs("\n| key | type | unit | range | default | what |\n|---|---|---|---|---|---|\n", stream);
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    name_chapter(chapter, key->name, below);
    int told = key->section ? find_told(manual, key->section) : -1;
    fprintf(stream, "| `%s` | %s | %s | %s | ", key->name, type_of(key), key->unit ? key->unit : "",
            key->range ? key->range : "");
    print_default(stream, key);
    fputs(" | ", stream);
    print_help(stream, key, !key->section ? NULL : told < 0 ? below : manual->told_as[told]);
    fputs(" |\n", stream);
  }
  print_rules(stream, section);
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++)
    if (key->choices) print_choices(stream, key);
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    if (!key->section || find_told(manual, key->section) >= 0) continue;
    name_chapter(chapter, key->name, below);
    fprintf(stream, "\n## %s\n\n%c%s%s.\n", note_section(manual, key->section, below),
            key->section->help[0] & ~32, key->section->help + 1,
            key->type == SCENE_LIST ? "; a list of them" : "");
    print_section(manual, key->section, below);
  }
}

Status app_scene_manual_print(FILE *stream) {
  Manual manual = {.stream = stream};
  fputs(introduction, stream);
  fputs("\n## The keys\n", stream);
  print_section(&manual, &app_scene_keys_root, "");
  print_formulas(stream);
  return ferror(stream) ? status_fail(STATUS_IO, "writing the manual failed") : STATUS_OK;
}
