// SPDX-License-Identifier: GPL-3.0-or-later
// A quantity of a gradient as words of a command line: displacement:block:z.
#ifndef TETLAP_APP_GRADIENT_QUANTITY_H
#define TETLAP_APP_GRADIENT_QUANTITY_H

#include "fem/gradient/quantity.h"

// STATUS_INPUT: no such quantity, or a body, obstacle, probe or entry that is not there; the message lists
// those that are.
Status app_gradient_read_quantity(const FemModel *model, const char *text, FemQuantity *quantity);

#endif
