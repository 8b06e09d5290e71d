// SPDX-License-Identifier: Apache-2.0
#define TPN_BF16
#define HOST_KERNELS device_host_tpn_bf16
#include "device/host/tpn.inc"
