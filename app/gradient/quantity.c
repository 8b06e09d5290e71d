// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/gradient/quantity.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "app/gradient/names.h"
#include "base/text.h"
#include "fem/gradient/contact/pressure.h"

enum { MAX_WORDS = 5, WORD_SIZE = 128 };

// The words that there are, for messages; sums of files (goal.h) among them.
static const char quantities[] = "displacement:BODY:AXIS, "
                                 "probe:NAME:AXIS, "
                                 "position:BODY:VERTEX:AXIS, "
                                 "force:BODY:AXIS, "
                                 "force:BODY:OTHER:AXIS, "
                                 "patch:PROBE:AXIS, "
                                 "pressure:PROBE, peak:PROBE, "
                                 "moment:BODY:AXIS, "
                                 "moment:BODY:OTHER:AXIS, "
                                 "reaction:BODY:fixed[N]:AXIS, "
                                 "reaction:BODY:driven[N]:AXIS, "
                                 "energy, energy:elastic, energy:contact, energy:gravity, "
                                 "sum:FILE, "
                                 "misfit:FILE";

static Status fail_quantity(const char *text) {
  const char *advice = strchr(text, ',') ? "; each has an --of of its own" : "";
  return status_fail(STATUS_INPUT, "'%s' is none of the quantities %s, with AXIS x, y or z%s", text,
                     quantities, advice);
}

// Cuts at colons; more than MAX_WORDS: one more.
static int split(const char *text, char words[MAX_WORDS][WORD_SIZE]) {
  int count = 0;
  for (const char *at = text; at; count++) {
    const char *end = strchr(at, ':');
    size_t length = end ? (size_t)(end - at) : strlen(at);
    if (count == MAX_WORDS || length >= WORD_SIZE) return MAX_WORDS + 1;
    memcpy(words[count], at, length);
    words[count][length] = 0;
    at = end ? end + 1 : NULL;
  }
  return count;
}

static bool read_axis(const char *word, int *component) {
  if (!word[0] || word[1] || !strchr("xyz", word[0])) return false;
  *component = word[0] - 'x';
  return true;
}

static bool read_count(const char *word, int *number) {
  char *end;
  long value = strtol(word, &end, 10);
  *number = (int)value;
  return isdigit((unsigned char)word[0]) && *end == 0 && value < 1000000000;
}

static Status find_body(const FemModel *model, const char *name, int *body) {
  return app_gradient_find_name(model->scene, name, strlen(name), 0, model->scene->body_count, body);
}

static Status find_party(const FemModel *model, const char *name, int *party) {
  const FemSceneDef *scene = model->scene;
  int number;
  TRY(app_gradient_find_name(scene, name, strlen(name), 0, scene->body_count + scene->obstacle_count,
                             &number));
  *party = number < scene->body_count ? number : fem_change_party(model, number - scene->body_count);
  return STATUS_OK;
}

static Status find_probe(const FemModel *model, const char *name, int *number) {
  char list[512] = "";
  size_t used = 0;
  for (*number = 0; *number < model->probe_count; (*number)++) {
    const char *known = model->probes[*number].def->name;
    if (strcmp(known, name) == 0) return STATUS_OK;
    text_append(list, sizeof list, &used, "%s%s", used ? ", " : "", known);
  }
  return status_fail(STATUS_INPUT, "no probe is called '%s'; there are %s", name, used ? list : "none");
}

// "fixed[0]" of a body.
static Status find_held(const FemModel *model, const char *name, const char *word, FemQuantity *quantity) {
  TRY(find_body(model, name, &quantity->body));
  const FemBodyDef *body = &model->scene->bodies[quantity->body];
  bool is_fixed = strncmp(word, "fixed[", strlen("fixed[")) == 0;
  const char *digits = strchr(word, '[');
  char *end = NULL;
  long number = digits && isdigit((unsigned char)digits[1]) ? strtol(digits + 1, &end, 10) : -1;
  bool is_entry = is_fixed || strncmp(word, "driven[", strlen("driven[")) == 0;
  if (!is_entry || number < 0 || strcmp(end, "]") != 0)
    return status_fail(STATUS_INPUT, "'%s' is not fixed[N] or driven[N]", word);
  int count = is_fixed ? body->fixed_count : body->driven_count;
  if (number >= count)
    return status_fail(STATUS_INPUT, "body '%s' has %d such entries, no %s", name, count, word);
  quantity->held = is_fixed ? &body->fixed[number] : &body->driven[number];
  return STATUS_OK;
}

static Status read_energy(const char *text, int count, char words[MAX_WORDS][WORD_SIZE],
                          FemQuantity *quantity) {
  static const char *const names[] = {"elastic", "contact", "gravity"};
  quantity->kind = FEM_QUANTITY_ENERGY;
  quantity->energies = count == 1 ? FEM_QUANTITY_ELASTIC | FEM_QUANTITY_CONTACT | FEM_QUANTITY_GRAVITY : 0;
  for (int k = 0; k < 3 && count == 2; k++)
    if (strcmp(words[1], names[k]) == 0) quantity->energies = 1 << k;
  return quantity->energies ? STATUS_OK : fail_quantity(text);
}

static Status read_pressed(const FemModel *model, int count, char words[MAX_WORDS][WORD_SIZE],
                           FemQuantity *quantity) {
  quantity->kind = strcmp(words[0], "force") == 0 ? FEM_QUANTITY_FORCE : FEM_QUANTITY_MOMENT;
  TRY(find_party(model, words[1], &quantity->body));
  return count == 4 ? find_party(model, words[2], &quantity->other) : STATUS_OK;
}

static Status read_words(const FemModel *model, const char *text, int count, char words[MAX_WORDS][WORD_SIZE],
                         FemQuantity *quantity) {
  if (strcmp(words[0], "displacement") == 0 && count == 3) {
    quantity->kind = FEM_QUANTITY_DISPLACEMENT;
    return find_body(model, words[1], &quantity->body);
  }
  if (strcmp(words[0], "probe") == 0 && count == 3) {
    quantity->kind = FEM_QUANTITY_PROBE;
    return find_probe(model, words[1], &quantity->body);
  }
  if (strcmp(words[0], "patch") == 0 && count == 3) {
    quantity->kind = FEM_QUANTITY_PATCH;
    return find_probe(model, words[1], &quantity->body);
  }
  if (strcmp(words[0], "position") == 0 && count == 4 && read_count(words[2], &quantity->vertex)) {
    quantity->kind = FEM_QUANTITY_POSITION;
    return find_body(model, words[1], &quantity->body);
  }
  if (strcmp(words[0], "reaction") == 0 && count == 4) {
    quantity->kind = FEM_QUANTITY_REACTION;
    return find_held(model, words[1], words[2], quantity);
  }
  bool presses = strcmp(words[0], "force") == 0 || strcmp(words[0], "moment") == 0;
  if (presses && (count == 3 || count == 4)) return read_pressed(model, count, words, quantity);
  return fail_quantity(text);
}

Status app_gradient_read_quantity(const FemModel *model, const char *text, FemQuantity *quantity) {
  char words[MAX_WORDS][WORD_SIZE] = {""};
  int count = split(text, words);
  *quantity = (FemQuantity){.other = -1};
  if (count > MAX_WORDS) return fail_quantity(text);
  if (strcmp(words[0], "energy") == 0) return read_energy(text, count, words, quantity);
  bool is_peak = strcmp(words[0], "peak") == 0;
  if ((is_peak || strcmp(words[0], "pressure") == 0) && count == 2) {
    quantity->kind = FEM_QUANTITY_PRESSURE;
    quantity->power = is_peak ? FEM_PRESSURE_PEAK : FEM_PRESSURE_MEAN;
    return status_prefix(find_probe(model, words[1], &quantity->body), "%s", text);
  }
  if (!read_axis(words[count - 1], &quantity->component)) return fail_quantity(text);
  return status_prefix(read_words(model, text, count, words, quantity), "%s", text);
}
