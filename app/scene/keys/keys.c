// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/scene/keys/table.h"
#include "fem/scene/scene.h"

static const SceneKey effect_keys[] = {
    {"gravity", SCENE_VECTOR, AT(FemSceneDef, gravity), .unit = "m/s²", .absent_help = "no gravity",
     MARK(FemSceneDef, has_gravity, true), .help = "acceleration of free fall"},
    {"damping", SCENE_NUMBER, AT(FemSceneDef, stiffness_damping), .unit = "s", .range = "[0, inf)",
     .fallback = "0", .help = "stiffness-proportional damping β of the bodies whose material gives none"},
    {0},
};
static const SceneSection effects = {.help = "acts on all bodies", .keys = effect_keys};

static const SceneKey scene_keys[] = {
    {"title", SCENE_TEXT, AT(FemSceneDef, title), .help = "a description"},
    {"time", SCENE_SECTION, .required = "{end: 0.5}", .section = &app_scene_keys_run_time,
     .help = "duration and accuracy"},
    {"start", SCENE_SECTION, .absent_help = "at rest", .section = &app_scene_keys_run_start,
     .help = "the run from whose end state this one starts, with other parameters, loads, contacts, times"},
    {"effects", SCENE_SECTION, .section = &effects, .help = "acts on all bodies"},
    {"bodies", SCENE_LIST, AT(FemSceneDef, bodies),
     .required = "[{name: block, mesh: block.msh, material: {young: 1e6, poisson: 0.4, density: 1000}}]",
     .section = &app_scene_keys_body, .count_offset = offsetof(FemSceneDef, body_count),
     .help = "the elastic bodies, at least one"},
    {"obstacles", SCENE_LIST, AT(FemSceneDef, obstacles), .section = &app_scene_keys_obstacle,
     .count_offset = offsetof(FemSceneDef, obstacle_count), .help = "rigid solids in contact with bodies"},
    {"contact", SCENE_SECTION, AT(FemSceneDef, contact), .absent_help = "no contact",
     .section = &app_scene_keys_contact, MARK(FemSceneDef, contact.is_on, true),
     .help = "bodies push each other apart; `{}` for the defaults"},
    {"solver", SCENE_SECTION, .section = &app_scene_keys_run_solver, .help = "linear algebra"},
    {"output", SCENE_SECTION, .section = &app_scene_keys_run_output, .help = "what is written"},
    {0},
};
const SceneSection app_scene_keys_root = {
    .help = "A scene.", .size = sizeof(FemSceneDef), .keys = scene_keys};

// Looking things up.

const SceneKey *app_scene_keys_at(const SceneSection *section, int index) {
  int count = 0;
  while (section->keys[count].name) {
    if (count == index) return &section->keys[index];
    count++;
  }
  return section->more ? app_scene_keys_at(section->more, index - count) : NULL;
}

const SceneKey *app_scene_keys_find(const SceneSection *section, const char *name) {
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++)
    if (strcmp(key->name, name) == 0) return key;
  return NULL;
}

bool app_scene_keys_locate(const SceneSection *section, const char *name, char *path, size_t size) {
  if (app_scene_keys_find(section, name)) {
    snprintf(path, size, "%s", name);
    return true;
  }
  const SceneKey *key;
  for (int i = 0; (key = app_scene_keys_at(section, i)); i++) {
    char below[128];
    if (!key->section || !app_scene_keys_locate(key->section, name, below, sizeof below)) continue;
    snprintf(path, size, "%s%s.%s", key->name, key->type == SCENE_LIST ? "[]" : "", below);
    return true;
  }
  return false;
}

int app_scene_keys_row_width(const SceneKey *key) {
  return key->type == SCENE_PROFILE ? 2 : 4;
}

SceneRange app_scene_keys_range(const SceneKey *key) {
  if (!key->range) return (SceneRange){-INFINITY, INFINITY, true, true};
  char *end;
  SceneRange range = {.is_min_open = key->range[0] == '('};
  range.min = strtod(key->range + 1, &end);
  range.max = strtod(end + 1, &end);
  range.is_max_open = end[0] == ')';
  return range;
}

bool app_scene_keys_allows(const SceneKey *key, double number) {
  SceneRange range = app_scene_keys_range(key);
  bool is_above = range.is_min_open ? number > range.min : number >= range.min;
  bool is_below = range.is_max_open ? number < range.max : number <= range.max;
  return is_above && is_below;
}

int app_scene_keys_choice(const SceneKey *key, const char *name) {
  const char *known;
  for (int i = 0; (known = app_scene_section_name(key->choices, i)); i++)
    if (strcmp(known, name) == 0) return i;
  return -1;
}

static const char *type_text(SceneType type) {
  switch (type) {
  case SCENE_NUMBER:
    return "a number";
  case SCENE_INTEGER:
    return "a whole number";
  case SCENE_SWITCH:
    return "true or false";
  case SCENE_TRUE:
    return "true";
  case SCENE_TEXT:
    return "text";
  case SCENE_LABEL:
    return "a name of letters, digits, '_' and '-'";
  case SCENE_NAME:
  case SCENE_CHOICE:
    return "one of ";
  case SCENE_VECTOR:
    return "three numbers [x, y, z]";
  case SCENE_DIRECTION:
    return "a direction [x, y, z], not zero";
  case SCENE_FACTORS:
    return "a number or three [x, y, z], none zero";
  case SCENE_COUNTS:
    return "a whole number or three [x, y, z]";
  case SCENE_TWO:
    return "a list of two names, [a, b]";
  case SCENE_AXES:
    return "a list of some of x, y, z";
  case SCENE_ROWS:
    return "rows [t, x, y, z] of four numbers, t increasing";
  case SCENE_PROFILE:
  case SCENE_FORMULA:
    break; // by what they are a function of
  case SCENE_SECTION:
    return "a mapping {key: value}";
  case SCENE_LIST:
    return "a list of mappings";
  }
  return "";
}

static void append_type(const SceneKey *key, char *text, size_t size, size_t *used) {
  const char *argument = app_scene_keys_argument(key);
  if (key->type == SCENE_PROFILE)
    text_append(text, size, used, "rows [%s, value] of two numbers, %s increasing", argument, argument);
  else if (key->type == SCENE_FORMULA)
    text_append(text, size, used, "a number or a formula of %s, like '%s'", argument,
                key->argument ? "1e9*d" : "sin(2*pi*t)");
  else
    text_append(text, size, used, "%s", type_text(key->type));
}

void app_scene_keys_expect(const SceneKey *key, char *text, size_t size) {
  size_t used = 0;
  append_type(key, text, size, &used);
  const char *name;
  for (int i = 0; key->choices && (name = app_scene_section_name(key->choices, i)); i++)
    text_append(text, size, &used, "%s%s", i ? ", " : "", name);
  if (key->choices && key->choices->accepts)
    text_append(text, size, &used, ", or %s", key->choices->accepts_help);
  if (key->section && key->section->shorthand) {
    text_append(text, size, &used, " or ");
    append_type(app_scene_keys_find(key->section, key->section->shorthand), text, size, &used);
    text_append(text, size, &used, " (its '%s')", key->section->shorthand);
  }
  if (key->range) text_append(text, size, &used, " in %s", key->range);
  if (key->unit) text_append(text, size, &used, " [%s]", key->unit);
}
