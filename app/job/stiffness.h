// SPDX-License-Identifier: GPL-3.0-or-later
// What contact's stiffness was chosen by, and how often the edges of curved surfaces are halved, in words.
#ifndef TETLAP_APP_JOB_STIFFNESS_H
#define TETLAP_APP_JOB_STIFFNESS_H

#include <stddef.h>

#include "fem/model/compliance/compliance.h"

// "5.2e+07 … 1e+08 Pa/m, by the elements at curved surfaces ('shaft' and 'ring'), …": of all that can meet.
// With a pressure law it says for what c is left.
void app_stiffness_describe(const FemModel *model, const FemCompliance *choice, char *text, size_t size);

// "curved edges in 4 parts ('shaft', 'ring')"; empty: all are whole.
void app_stiffness_describe_levels(const FemModel *model, const FemCompliance *choice, char *text,
                                   size_t size);

#endif
