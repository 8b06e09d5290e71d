// SPDX-License-Identifier: GPL-3.0-or-later
// All programs of device/kernels/source.h. The fake drivers know no other one, so tests of a device fail
// until a new program stands here.
#ifndef TETLAP_TESTS_DEVICE_FAKE_PROGRAMS_H
#define TETLAP_TESTS_DEVICE_FAKE_PROGRAMS_H

#include "device/kernels/source.h"

enum { PROGRAM_COUNT = 10 };
static const DeviceProgram *const programs[PROGRAM_COUNT] = {
    &device_program_clip, &device_program_clip32,   &device_program_gather, &device_program_poses,
    &device_program_tpn,  &device_program_tpn_bf16, &device_program_scalar, &device_program_geo_small,
    &device_program_geo,  &device_program_peak};

#endif
