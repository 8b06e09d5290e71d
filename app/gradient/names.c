// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/names.h"

#include <string.h>

#include "base/text.h"

static bool is_word(const char *text, size_t length, const char *word) {
  return strlen(word) == length && memcmp(text, word, length) == 0;
}

// Bodies, then obstacles, by their numbers in the scene.
static const char *name_of(const FemSceneDef *scene, int number) {
  int bodies = scene->body_count;
  return number < bodies ? scene->bodies[number].name : scene->obstacles[number - bodies].name;
}

Status app_gradient_find_name(const FemSceneDef *scene, const char *name, size_t length, int begin, int end,
                              int *number) {
  char list[512] = "";
  size_t used = 0;
  for (*number = begin; *number < end; (*number)++) {
    const char *known = name_of(scene, *number);
    if (known && is_word(name, length, known)) return STATUS_OK;
    text_append(list, sizeof list, &used, "%s%s", used ? ", " : "", known ? known : "?");
  }
  return status_fail(STATUS_INPUT, "nothing is called '%.*s'; there are %s", (int)length, name,
                     used ? list : "none");
}
