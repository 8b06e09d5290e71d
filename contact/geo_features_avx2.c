// SPDX-License-Identifier: GPL-3.0-or-later
// Features with four numbers a register.
#if defined(__x86_64__)
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif

#include "contact/geo_features_forward.inc"

#include "contact/geo_features_backward.inc"

const ContactGeoKernel contact_geo_kernel_avx2 = {
    .name = "avx2", .features = features, .push = push, .pull = pull, .bend = bend};

#ifdef __clang__
#pragma clang attribute pop
#endif
#endif
