// SPDX-License-Identifier: GPL-3.0-or-later
// The gate of a bundle of pairs for any processor.
#include "contact/geo_pack_portable.h"

#include "contact/geo_bundle_gate.inc"
