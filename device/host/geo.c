// SPDX-License-Identifier: Apache-2.0
#define GEO_FEATURES 120
#define HOST_KERNELS device_host_geo
#include "device/host/geo.inc"
