// SPDX-License-Identifier: GPL-3.0-or-later
// What a data set is made of: a mix of kinds and a law for the volumes of the volumetric ones.
#ifndef TETLAP_DATAGEN_LAW_LAW_H
#define TETLAP_DATAGEN_LAW_LAW_H

#include <stddef.h>

#include "datagen/law/kind.h"
#include "datagen/law/volume_law.h"

enum { DATAGEN_MIX_TEXT = 384 };

typedef struct DatagenLaw {
  const char *name; // "paper-train", …
  const char *help; // one line
  long long default_count;
  double mix[DATAGEN_KIND_COUNT]; // shares of the kinds, in any unit
  DatagenVolumeLaw volume;
  double swap_share; // of pairs whose tetrahedra are exchanged, so that the second has the face
} DatagenLaw;

// The laws that have names, and how many.
const DatagenLaw *datagen_law_list(int *count);
// STATUS_USAGE: there is no such law; the message lists the known ones and the nearest.
Status datagen_law_find(const char *name, DatagenLaw *law);

// "KIND=SHARE,…" as in none=50,volumetric=50; kinds that are not named get none. STATUS_USAGE names what is
// wrong: an unknown or repeated kind, a share that is no number ≥ 0, no share at all, `captured`.
Status datagen_law_parse_mix(double mix[DATAGEN_KIND_COUNT], const char *text);
// The inverse.
void datagen_law_print_mix(const double mix[DATAGEN_KIND_COUNT], char *text, size_t size);

// How many of `count` pairs are of each kind: the shares, rounded so that they sum up (largest remainders).
void datagen_law_divide(const double mix[DATAGEN_KIND_COUNT], long long count,
                        long long counts[DATAGEN_KIND_COUNT]);

#endif
