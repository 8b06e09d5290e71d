// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that a driver of tests is given as text, run by the same kernels in plain C. What a kernel takes
// is read from its declaration in that text, so that a driver can hold its callers to it.
#ifndef TETLAP_TESTS_DEVICE_FAKE_KERNELS_H
#define TETLAP_TESTS_DEVICE_FAKE_KERNELS_H

#include <stdbool.h>

#include "device/device.h"

typedef struct FakeKernel {
  DeviceKernel host; // of the device `host`
  int argument_count;
  DeviceArgumentKind kinds[DEVICE_MAX_ARGUMENTS]; // (argument_count)
} FakeKernel;

// The program that the text is, to the last letter; NULL: it is none of ours.
const DeviceProgram *fake_kernels_program(const char *text, DeviceLanguage language);

// A kernel of the program. False: there is none of that name.
bool fake_kernels_find(const DeviceProgram *program, const char *text, const char *name, FakeKernel *kernel);

// Memory is the host's, by DeviceMemory.at.
void fake_kernels_run(const FakeKernel *kernel, int groups, const DeviceArgument *arguments);

#endif
