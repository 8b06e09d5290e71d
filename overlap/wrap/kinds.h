// SPDX-License-Identifier: Apache-2.0
// The wrappers there are, by the names that words have before their models (overlap/source.h).
#ifndef TETLAP_OVERLAP_WRAP_KINDS_H
#define TETLAP_OVERLAP_WRAP_KINDS_H

#include "overlap/wrap/wrap.h"

// The kind that a word begins with, and its number, NAN: none. STATUS_INPUT: there is none of that name; the
// message lists those there are.
Status overlap_wrap_kinds_find(const char *word, const OverlapWrapKind **kind, double *number);

#endif
