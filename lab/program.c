// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/program.h"

#include "app/command/commands.h"

static const AppCommand *const commands[] = {
    &lab_device, &lab_net, &app_command_version, &app_command_help, NULL,
};

const AppCommand lab_program_root = {
    .name = "tetlap-lab",
    .help = "measurements of tetlap for those who develop it",
    .children = commands,
    .child_word = "command",
    .doc = "Measures parts of tetlap, for those who develop it.",
    .ending = "`tetlap-lab COMMAND --help` lists the options and the columns of a row.",
};
