// SPDX-License-Identifier: GPL-3.0-or-later

#include "app/command/commands.h"

static const AppCommand *const verbs[] = {&app_command_dataset_export, &app_command_dataset_import,
                                          &app_command_dataset_info,   &app_command_dataset_merge,
                                          &app_command_dataset_plot,   NULL};

const AppCommand app_command_dataset = {
    .name = "dataset",
    .help = "import, export, describe, join or draw data sets of such pairs",
    .children = verbs,
    .child_word = "verb",
    .child_of_files = "info",
    .doc = "Works on data sets of labelled pairs of tetrahedra.",
    .ending = "`tetlap dataset VERB --help` has the details; docs/data.md describes the files.",
};
