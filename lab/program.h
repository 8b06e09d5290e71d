// SPDX-License-Identifier: GPL-3.0-or-later
// The program `tetlap-lab`: what only the project itself measures. It is built and tested, and not installed.
#ifndef TETLAP_LAB_PROGRAM_H
#define TETLAP_LAB_PROGRAM_H

#include "app/cli/command.h"

extern const AppCommand lab_program_root;
extern const AppCommand lab_device, lab_net; // its own commands, a file each

#endif
