// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene begins with that its author may not have meant: bodies that overlap.
#ifndef TETLAP_FEM_RUN_CHECK_START_H
#define TETLAP_FEM_RUN_CHECK_START_H

#include <stddef.h>

#include "fem/effect/contact/contact.h"

// The next two that overlap by that evaluation of contact (NULL: there is none), from interface `from` on, in
// words; returns its number, −1: no more.
int fem_run_start_overlap(const FemSystem *system, const ContactEvaluation *contact, int from, char *text,
                          size_t size);

#endif
