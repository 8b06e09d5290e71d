// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/scene/keys/removed.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

static const char POTENTIAL[] =
    "remove 'potential' and 'stiffness': the default potential is 'field', whose stiffness "
    "is chosen from the bodies; if you set it, it is in Pa/m";

static const char NET[] =
    "write into contact.overlap, before the model, what it asks for: keep=, cut= or fade:TOUCH= for ghosts, "
    "both= for orders, coplanar= for coplanar, hybrid:DOUBT= for doubt, tpn-scene=FILE.safetensors for gate, "
    "hybrid=FILE.safetensors for out_of_range; deep, confidence and touch are no longer set; the weights are "
    "the model itself, "
    "contact.overlap: FILE.safetensors";

// `value` NULL: the key itself; "*": any text.
static const struct {
  const char *path, *value, *advice;
} removed[] = {
    {"obstacles[].cylinder.faces", NULL, "remove it: a cylinder is exactly round"},
    {"contact.potential", "element", POTENTIAL},
    {"contact.potential", "pair", POTENTIAL},
    {"contact.potential", "linear", POTENTIAL},
    {"contact.potential", "body", POTENTIAL},
    {"contact.hessian", NULL, "remove it: the matrix has all second derivatives, as with `full`"},
    {"contact.net", NULL, NET},
    {"contact.friction.law", NULL,
     "remove it and write the coefficient alone, as friction: 0.3; contacts stick until the slip force "
     "reaches "
     "μ times the normal force"},
    {"contact.friction.slip_speed", NULL,
     "remove it: contacts that stick no longer creep, so there is no speed of creep to choose"},
};

// Whether a path is that of the table, where [] stands for any place in a list.
static bool is_path(const char *pattern, const char *path) {
  for (; *pattern && *pattern == *path; pattern++, path++)
    if (*pattern == '[') path += strspn(path + 1, "0123456789");
  return *pattern == *path;
}

static const char *find(const char *path, const char *value) {
  for (size_t i = 0; i < sizeof removed / sizeof *removed; i++) {
    bool is_value = removed[i].value && value &&
                    (strcmp(removed[i].value, "*") == 0 || strcmp(removed[i].value, value) == 0);
    if (is_path(removed[i].path, path) && (is_value || (!removed[i].value && !value)))
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
