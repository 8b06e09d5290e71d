// SPDX-License-Identifier: Apache-2.0
// The peak of a device whose driver does not tell it, by a kernel of fused multiply-adds: the roof of the
// roofline model (Williams, Waterman, Patterson 2009).
#ifndef TETLAP_DEVICE_PEAK_PEAK_H
#define TETLAP_DEVICE_PEAK_PEAK_H

#include "device/device.h"

// Multiplications and additions a second [1/s] in float, in double, and 0 for bf16, which no language but
// CUDA's gives to kernels; the best of several rounds of at least a millisecond. STATUS_DEVICE,
// STATUS_MEMORY.
Status device_peak_measure(const Device *device, double peak[DEVICE_ARITHMETIC_COUNT]);

#endif
