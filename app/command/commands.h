// SPDX-License-Identifier: GPL-3.0-or-later
// The commands, as `tetlap run`, `tetlap weights` or `tetlap dataset merge`. Each is in the file of its name,
// in the room that stands above it.
#ifndef TETLAP_APP_COMMAND_COMMANDS_H
#define TETLAP_APP_COMMAND_COMMANDS_H

#include "app/cli/command.h"

// app/command/about
extern const AppCommand app_command_completion;
extern const AppCommand app_command_devices;
extern const AppCommand app_command_effects;
extern const AppCommand app_command_help;
extern const AppCommand app_command_schema;
extern const AppCommand app_command_version;

// app/command/learning
extern const AppCommand app_command_datagen;
extern const AppCommand app_command_dataset;
extern const AppCommand app_command_dataset_export;
extern const AppCommand app_command_dataset_import;
extern const AppCommand app_command_dataset_info;
extern const AppCommand app_command_dataset_merge;
extern const AppCommand app_command_dataset_plot;
extern const AppCommand app_command_eval;
extern const AppCommand app_command_train;
extern const AppCommand app_command_weights;

// app/command/output
extern const AppCommand app_command_plot;
extern const AppCommand app_command_render;
extern const AppCommand app_command_report;
extern const AppCommand app_command_view;

// app/command/overlap
extern const AppCommand app_command_overlap;
extern const AppCommand app_command_poses;
extern const AppCommand app_command_verdict;

// app/command/scene
extern const AppCommand app_command_check;
extern const AppCommand app_command_compare;
extern const AppCommand app_command_gradient;
extern const AppCommand app_command_mesh; // exit code 65: the mesh cannot be used
extern const AppCommand app_command_resume;
extern const AppCommand app_command_run;
extern const AppCommand app_command_serve; // for tetlap.Simulation
extern const AppCommand app_command_stress;
extern const AppCommand app_command_sweep;

#endif
