// SPDX-License-Identifier: GPL-3.0-or-later
#define LANES_TEXT "portable"
#define LANES_PACK 2
#define LANES_NAME(name) name##_portable

#include "fem/lanes/kernels.inc"
