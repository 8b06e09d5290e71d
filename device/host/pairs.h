// SPDX-License-Identifier: Apache-2.0
// The first eight arguments of a kernel on pairs (kernels/pairs.inc).
#ifndef TETLAP_DEVICE_HOST_PAIRS_H
#define TETLAP_DEVICE_HOST_PAIRS_H

#define HOST_PAIRS(a)                                                                                        \
  (a)[0].integer, (a)[1].integer, (a)[2].integer, device_host_at((a) + 3), device_host_at((a) + 4),          \
      device_host_at((a) + 5), (a)[6].integer, device_host_at((a) + 7)

#endif
