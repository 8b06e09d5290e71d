// SPDX-License-Identifier: GPL-3.0-or-later
// The gate of a bundle of pairs for any processor.
#include "overlap/geo/features/pack_portable.h"

#include "overlap/geo/bundle/gate.inc"
