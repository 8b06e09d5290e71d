// SPDX-License-Identifier: GPL-3.0-or-later
// A parameter of a gradient by its key in the scene, as --set has it.
#ifndef TETLAP_APP_GRADIENT_PARAMETER_H
#define TETLAP_APP_GRADIENT_PARAMETER_H

#include "fem/gradient/parameter.h"

// STATUS_INPUT: no such key, it names what is not there, or no derivative by it is known; the message begins
// with the key and says what there is.
Status app_gradient_read_parameter(const FemModel *model, const char *key, FemParameter *parameter);

#endif
