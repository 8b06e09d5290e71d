// SPDX-License-Identifier: GPL-3.0-or-later
// Features for any processor.

#include "contact/geo_features_forward.inc"

#include "contact/geo_features_backward.inc"

const ContactGeoKernel contact_geo_kernel_portable = {
    .name = "portable", .features = features, .push = push, .pull = pull, .bend = bend};
