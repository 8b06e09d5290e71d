// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab net`: networks alone, without geometry: our kernels beside PyTorch with the same weights and
// inputs, in the same run, and their share of a core's peak.
#ifndef TETLAP_LAB_NET_H
#define TETLAP_LAB_NET_H

#include "app/cli/command.h"

extern const AppCommand lab_net;

#endif
