// SPDX-License-Identifier: GPL-3.0-or-later
// A section of the scene file: what its keys are and where their values go.
#ifndef TETLAP_APP_SCENE_KEYS_SECTION_H
#define TETLAP_APP_SCENE_KEYS_SECTION_H

#include <stdbool.h>
#include <stddef.h>

// What a value is in the file, and in memory.
typedef enum SceneType {
  SCENE_NUMBER,    // double
  SCENE_INTEGER,   // int
  SCENE_SWITCH,    // bool: true or false
  SCENE_TRUE,      // nothing is stored: only `true` may stand there
  SCENE_TEXT,      // char *, owned
  SCENE_LABEL,     // char *, owned: a name that others refer to
  SCENE_NAME,      // char *, owned: one of `choices`
  SCENE_CHOICE,    // an enum or bool: the number of one of `choices`
  SCENE_TWO,       // char *[2], owned: two names that differ, or twice the same
  SCENE_VECTOR,    // double[3]
  SCENE_DIRECTION, // double[3], not zero; need not have unit length
  SCENE_FACTORS,   // double[3], none of them zero; one number stands for three
  SCENE_COUNTS,    // int[3]; one number stands for three
  SCENE_AXES,      // bool[3]: some of x, y, z
  SCENE_ROWS,      // double *, owned, (count, 4): rows [t, x, y, z], t increasing
  SCENE_PROFILE,   // double *, owned, (count, 2): rows [t, value], t increasing, or of another `argument`
  SCENE_FORMULA,   // Expression *, owned: a function of t, or of another `argument`; a number is one, too
  SCENE_SECTION,   // keys of its own; their offsets count from the key's
  SCENE_LIST,      // an array of structs, owned, (count); each a section
} SceneType;

typedef struct SceneChoice {
  const char *name, *help;
} SceneChoice;

// A closed set of names: a list, ended by a zeroed one, or functions where another layer owns them, with NULL
// beyond the last.
typedef struct SceneChoices {
  const SceneChoice *listed; // NULL: by `name` and `help`
  const char *(*name)(int index);
  const char *(*help)(int index);
  bool takes_switch; // true stands for the second name, false for the first
  // Words of NAME that are none of the names, and may stand there; NULL: there are none.
  bool (*accepts)(const char *word);
  const char *accepts_help; // what they are, after "or"
} SceneChoices;

static inline const char *app_scene_section_name(const SceneChoices *choices, int index) {
  return choices->listed ? choices->listed[index].name : choices->name(index);
}
static inline const char *app_scene_section_help(const SceneChoices *choices, int index) {
  return choices->listed ? choices->listed[index].help : choices->help(index);
}

// What giving a key sets besides its own value: a flag, or which way was chosen.
typedef struct SceneMark {
  size_t offset, size; // size 0: nothing
  int value;
} SceneMark;

typedef struct SceneSection SceneSection;

typedef struct SceneKey {
  const char *name;
  SceneType type;
  size_t offset, size;         // of the value, in the struct that the section describes
  const char *help;            // one line
  const char *unit;            // NULL: none
  const char *range;           // of a number or each component: "(0, inf)"; NULL: any finite one
  const char *fallback;        // the default, as one would write it; NULL: none
  const char *required;        // the key must be given, for example so; NULL: it may be left out
  double absent;               // what a number without default holds until it is given
  const char *absent_help;     // what holds without the key, where no default says it
  const SceneChoices *choices; // of NAME and CHOICE
  const SceneSection *section; // of SECTION and LIST
  const char *argument;        // of PROFILE and FORMULA: what it is a function of; NULL: t
  size_t count_offset;         // of ROWS, PROFILE and LIST: an int in the same struct
  SceneMark mark;
  const char *needs;    // keys of the section that must stand beside this one, separated by spaces
  const char *excludes; // keys that must not
} SceneKey;

struct SceneSection {
  const char *help;
  size_t size;              // of an item of a LIST, of which `keys` describes the fields
  const SceneKey *keys;     // ended by one without a name
  const SceneSection *more; // whose keys belong here as well; NULL: none
  const char *shorthand;    // a scalar in the section's place stands for this key; NULL: none
  const char *one_of;       // exactly one of these keys must be there; NULL: no such rule
  const char *some_of;      // at least one of them
  bool has_place;           // a FemScenePlace is kept …
  size_t place_offset;      // … here
  // Sees to what no single key says; returns what is wrong and the key to blame, else NULL. May be NULL.
  const char *(*finish)(void *self, const char **key);
};

#endif
