// SPDX-License-Identifier: Apache-2.0
// TetrahedronPairNets on a device. Private to device/.
//
//   pairs ─ gate: normalised ─► network ─► V, ∇V
//             └► the first is flat: the host's exact
#ifndef TETLAP_DEVICE_OVERLAP_TPN_H
#define TETLAP_DEVICE_OVERLAP_TPN_H

#include "device/overlap/state.h"

// All pairs but `*left`, which are listed in lists[0].
Status device_overlap_tpn_run(DeviceOverlap *overlap, DeviceQuantity quantity, int *left);

#endif
