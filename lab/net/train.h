// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab train CONFIG…`: samples a second of a training's steps, beside PyTorch's for the networks
// whose loss it shares.
#ifndef TETLAP_LAB_NET_TRAIN_H
#define TETLAP_LAB_NET_TRAIN_H

#include "app/cli/command.h"

extern const AppCommand lab_train;

#endif
