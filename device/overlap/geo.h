// SPDX-License-Identifier: Apache-2.0
// geo and geo-small on a device. Private to device/.
//
//   pairs ─ gate ─► those that intersect ─► frame ─► features ─► network ─► V, ∇V, x̄ ─► close ─► clip's share
//             └► flat: the host's geo         └► no frame: the host's geo
//
// DEVICE_GEO_ROOM pairs at a time. Pairs with faces that nearly lie in one plane are close: clip answers
// them, too, and clip-scalar what clip leaves; what that leaves is the host's.
#ifndef TETLAP_DEVICE_OVERLAP_GEO_H
#define TETLAP_DEVICE_OVERLAP_GEO_H

#include "device/overlap/state.h"

// All pairs but `*left`, which are listed in lists[0]. handed_on: what clip and clip-scalar answered, too,
// and what is left.
Status device_overlap_geo_run(DeviceOverlap *overlap, DeviceQuantity quantity, int *left);

#endif
