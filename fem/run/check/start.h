// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene begins with that its author may not have meant: bodies that overlap.
#ifndef TETLAP_FEM_RUN_CHECK_START_H
#define TETLAP_FEM_RUN_CHECK_START_H

#include <stddef.h>

#include "fem/effect/contact/contact.h"

enum { FEM_RUN_START_TOLD_COUNT = 4, FEM_RUN_START_TEXT_SIZE = 512 };

// Those that overlap by that evaluation of contact (NULL: there is none), in words, a text for each two; the
// last one counts those for which there is no room. Returns how many texts there are.
int fem_run_start_overlaps(const FemSystem *system, const ContactEvaluation *contact,
                           char texts[FEM_RUN_START_TOLD_COUNT][FEM_RUN_START_TEXT_SIZE]);

#endif
