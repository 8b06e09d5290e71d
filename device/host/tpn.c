// SPDX-License-Identifier: Apache-2.0
#define HOST_KERNELS device_host_tpn
#include "device/host/tpn.inc"
