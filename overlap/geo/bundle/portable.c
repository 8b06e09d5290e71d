// SPDX-License-Identifier: Apache-2.0
// Centre to second derivatives of a bundle of pairs for any processor.
#include "overlap/geo/features/pack_portable.h"

#include "overlap/geo/bundle/kernel.inc"
