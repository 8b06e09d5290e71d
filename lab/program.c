// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/program.h"

#include "app/command/about/help.h"
#include "app/command/about/version.h"
#include "lab/net/net.h"
#include "lab/net/train.h"
#include "lab/overlap/datagen.h"
#include "lab/overlap/device.h"
#include "lab/pareto/command.h"
#include "lab/precision/precision.h"
#include "lab/scene/beam.h"
#include "lab/scene/drop.h"
#include "lab/scene/elements.h"
#include "lab/scene/ranks.h"
#include "lab/scene/scaling.h"
#include "lab/scene/scene.h"
#include "lab/scene/solver.h"
#include "lab/scene/step.h"

static const AppCommand *const commands[] = {
    &lab_pareto_command, &lab_device,  &lab_net,   &lab_datagen, &lab_train,
    &lab_elements,       &lab_solver,  &lab_beam,  &lab_scene,   &lab_step,
    &lab_precision,      &lab_scaling, &lab_ranks, &lab_drop,    &app_command_version,
    &app_command_help,   NULL,
};

const AppCommand lab_program_root = {
    .name = "tetlap-lab",
    .help = "measurements of tetlap for those who develop it",
    .children = commands,
    .child_word = "command",
    .doc = "Measures parts of tetlap, for those who develop it.",
    .ending = "`tetlap-lab COMMAND --help` lists the options and the columns of a row.",
};
