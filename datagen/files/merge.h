// SPDX-License-Identifier: GPL-3.0-or-later
// Putting data set files together.
#ifndef TETLAP_DATAGEN_FILES_MERGE_H
#define TETLAP_DATAGEN_FILES_MERGE_H

#include <stdbool.h>

#include "base/status.h"

// Writes the pairs of `count` files to `output`. Shards of one data set, given in any order, make what one
// run would have made. STATUS_INPUT otherwise: files of different plans (the message says in what they
// differ), pairs that are missing or come twice. With `mixes`, files of any plans are written one after
// another, as a data set of law "mixed"; gradients are kept if all have them.
Status datagen_merge(const char *const *paths, int count, const char *output, bool mixes);

#endif
