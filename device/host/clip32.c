// SPDX-License-Identifier: Apache-2.0
#define LANES_SINGLE
#define HOST_KERNELS device_host_clip32
#include "device/host/clip.inc"
