// SPDX-License-Identifier: Apache-2.0
#define GEO_FEATURES 56
#define HOST_KERNELS device_host_geo_small
#include "device/host/geo.inc"
