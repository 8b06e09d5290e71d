// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/removed.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

static const char POTENTIAL[] =
    "remove 'potential' and 'stiffness': the default potential is 'field', whose stiffness "
    "is chosen from the bodies; if you set it, it is in Pa/m";

static const char WEIGHTS[] =
    "write the weights as the model itself, contact.overlap: FILE.safetensors; as the network of hybrid, "
    "contact.overlap: hybrid=FILE.safetensors";

// `value` NULL: the key itself; "*": any text.
static const struct {
  const char *path, *value, *advice;
} removed[] = {
    {"contact.potential", "element", POTENTIAL},
    {"contact.potential", "pair", POTENTIAL},
    {"contact.potential", "linear", POTENTIAL},
    {"contact.potential", "body", POTENTIAL},
    {"contact.net.weights", NULL, WEIGHTS},
    {"contact.net", "*", WEIGHTS},
    {"contact.friction.law", NULL,
     "remove it and write the coefficient alone, as friction: 0.3; contacts stick until the slip force "
     "reaches "
     "μ times the normal force"},
    {"contact.friction.slip_speed", NULL,
     "remove it: contacts that stick no longer creep, so there is no speed of creep to choose"},
};

static const char *find(const char *path, const char *value) {
  for (size_t i = 0; i < sizeof removed / sizeof *removed; i++) {
    bool is_value = removed[i].value && value &&
                    (strcmp(removed[i].value, "*") == 0 || strcmp(removed[i].value, value) == 0);
    if (strcmp(removed[i].path, path) == 0 && (is_value || (!removed[i].value && !value)))
      return removed[i].advice;
  }
  return NULL;
}

const char *app_scene_keys_removed(const char *path) {
  return find(path, NULL);
}

const char *app_scene_keys_removed_value(const char *path, const char *value) {
  return find(path, value);
}
