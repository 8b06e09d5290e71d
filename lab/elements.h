// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab elements`: forces and matrices of elements in vector lanes beside one element at a time, for
// every law and both kinds of elements, on one thread.
#ifndef TETLAP_LAB_ELEMENTS_H
#define TETLAP_LAB_ELEMENTS_H

#include "app/cli/command.h"

extern const AppCommand lab_elements;

#endif
