// SPDX-License-Identifier: GPL-3.0-or-later
// `tetlap-lab device DEVICE`: the models that a device has kernels for, by where the pairs lie.
//
//   device   numbers by column, there already; the answers stay there
//   indices  positions and tetrahedra, there already; a pair is two indices; the answers stay there
//   host     sent from the host as the models take them, and all answers fetched
//
// With --torch PyTorch evaluates networks beside, on the same device: the network alone, whose inputs are
// there, without the gate before it and the frame around it (torch/network.h).
//
// A rate is of complete answers: with the pairs that one kernel hands on to the next, and to the host.
#ifndef TETLAP_LAB_DEVICE_H
#define TETLAP_LAB_DEVICE_H

#include "app/cli/command.h"

extern const AppCommand lab_device;

#endif
