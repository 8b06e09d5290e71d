// SPDX-License-Identifier: Apache-2.0
#define HOST_KERNELS device_host_clip
#include "device/host/clip.inc"
