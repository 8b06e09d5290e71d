// SPDX-License-Identifier: GPL-3.0-or-later
// Centre to second derivatives of a bundle of pairs for any processor.
#include "contact/geo_pack_portable.h"

#pragma GCC diagnostic ignored "-Wunused-function" // of single pairs

#include "contact/geo_features_forward.inc"

#include "contact/geo_features_backward.inc"

#include "contact/geo_features_curve.inc"

#include "contact/geo_bundle_frame.inc"

#include "contact/geo_bundle_hessian.inc"
