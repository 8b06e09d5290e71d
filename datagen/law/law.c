// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/law/law.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

// Table 1 and section 4 of the paper, contact as meshes make it, and the cube without any selection (the
// share of pairs that intersect is that of volume_law.c).
static const DatagenLaw laws[] = {
    {"paper-train",
     "the paper's Table 1: half disjoint, ln V uniform",
     12000000,
     {[DATAGEN_NONE] = 50,
      [DATAGEN_VERTEX_FACE] = 5,
      [DATAGEN_EDGE_FACE] = 7,
      [DATAGEN_FACE_FACE] = 20,
      [DATAGEN_VOLUMETRIC] = 18},
     {DATAGEN_VOLUME_LOG_UNIFORM, 1e-7, 0.02},
     0},
    {"paper-test",
     "the paper's test: equal classes, V uniform",
     500000,
     {[DATAGEN_NONE] = 20,
      [DATAGEN_VERTEX_FACE] = 20,
      [DATAGEN_EDGE_FACE] = 20,
      [DATAGEN_FACE_FACE] = 20,
      [DATAGEN_VOLUMETRIC] = 20},
     {DATAGEN_VOLUME_UNIFORM, 0, 0.02},
     0},
    {"scene",
     "elements of two jittered meshes pressed together",
     500000,
     {[DATAGEN_SCENE] = 80, [DATAGEN_SCENE_NONE] = 20},
     {DATAGEN_VOLUME_NATURAL, 0, 0},
     0},
    {"uniform",
     "vertices uniform in the unit cube, nothing selected",
     500000,
     {[DATAGEN_NONE] = 38.91377, [DATAGEN_VOLUMETRIC] = 61.08623},
     {DATAGEN_VOLUME_NATURAL, 0, 0},
     0},
};
enum { LAW_COUNT = sizeof laws / sizeof *laws };

const DatagenLaw *datagen_law_list(int *count) {
  *count = LAW_COUNT;
  return laws;
}

Status datagen_law_find(const char *name, DatagenLaw *law) {
  char known[256] = "";
  size_t used = 0;
  TextGuess guess = text_guess_of(name);
  for (int k = 0; k < LAW_COUNT; k++) {
    if (strcmp(laws[k].name, name) == 0) {
      *law = laws[k];
      return STATUS_OK;
    }
    text_append(known, sizeof known, &used, "%s%s", k ? ", " : "", laws[k].name);
    text_guess_offer(&guess, laws[k].name);
  }
  if (guess.best)
    return status_fail(STATUS_USAGE, "there is no law '%s': did you mean '%s'? Known are %s", name,
                       guess.best, known);
  return status_fail(STATUS_USAGE, "there is no law '%s': known are %s", name, known);
}

// Reads one KIND=SHARE and moves `*text` behind it.
static Status parse_share(double mix[DATAGEN_KIND_COUNT], bool seen[DATAGEN_KIND_COUNT], const char **text) {
  char name[TEXT_MAX_WORD];
  size_t length = strcspn(*text, "=,");
  if ((*text)[length] != '=' || length == 0 || length >= sizeof name)
    return status_fail(STATUS_USAGE, "the mix has '%s'; give KIND=SHARE,…, as in none=50,volumetric=50",
                       *text);
  memcpy(name, *text, length);
  name[length] = 0;
  DatagenKind kind;
  TRY(datagen_kind_find(name, &kind));
  if (kind == DATAGEN_CAPTURED)
    return status_fail(STATUS_USAGE, "the mix has '%s': such pairs come from a run, not from a generator",
                       name);
  if (seen[kind]) return status_fail(STATUS_USAGE, "the mix has '%s' twice; give it once", name);
  char *end;
  double share = strtod(*text + length + 1, &end);
  if (end == *text + length + 1 || (*end && *end != ',') || !(share >= 0 && isfinite(share)))
    return status_fail(STATUS_USAGE, "the mix has '%s'; a share is a number from 0 up, as in %s=50", *text,
                       name);
  seen[kind] = true;
  mix[kind] = share;
  *text = end;
  return STATUS_OK;
}

Status datagen_law_parse_mix(double mix[DATAGEN_KIND_COUNT], const char *text) {
  bool seen[DATAGEN_KIND_COUNT] = {false};
  double parsed[DATAGEN_KIND_COUNT] = {0}, sum = 0;
  for (;;) {
    TRY(parse_share(parsed, seen, &text));
    if (!*text) break;
    text++;
  }
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) sum += parsed[k];
  if (!(sum > 0 && isfinite(sum)))
    return status_fail(STATUS_USAGE, "the shares of the mix sum to %g; give one kind at least a share", sum);
  memcpy(mix, parsed, sizeof parsed);
  return STATUS_OK;
}

void datagen_law_print_mix(const double mix[DATAGEN_KIND_COUNT], char *text, size_t size) {
  size_t used = 0;
  text[0] = 0;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++)
    if (mix[k] > 0)
      text_append(text, size, &used, "%s%s=%.15g", used ? "," : "", datagen_kind_info(k)->name, mix[k]);
}

void datagen_law_divide(const double mix[DATAGEN_KIND_COUNT], long long count,
                        long long counts[DATAGEN_KIND_COUNT]) {
  double sum = 0, remainder[DATAGEN_KIND_COUNT];
  long long left = count;
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) sum += mix[k];
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    double wanted = (double)count * (mix[k] / sum);
    counts[k] = (long long)floor(wanted);
    remainder[k] = mix[k] > 0 ? wanted - (double)counts[k] : -1;
    left -= counts[k];
  }
  for (; left > 0; left--) {
    int best = 0;
    for (int k = 1; k < DATAGEN_KIND_COUNT; k++)
      if (remainder[k] > remainder[best]) best = k;
    counts[best]++;
    remainder[best] -= 1;
  }
}
