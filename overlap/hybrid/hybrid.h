// SPDX-License-Identifier: Apache-2.0
// `hybrid`: a network's volumes where it is sure, those of clipping or exact arithmetic where it is not. Its
// weights say which network, and with it how sureness is told:
//
//   of `geo`                 a second network bounds the error of V, pair by pair     (hybrid/sure.h)
//   of TetrahedronPairNet    status head, overlap share and range of the training     (tpn/model.h)
#ifndef TETLAP_OVERLAP_HYBRID_HYBRID_H
#define TETLAP_OVERLAP_HYBRID_HYBRID_H

#include "overlap/ops.h"

// The network that it has unless another is named.
#define OVERLAP_HYBRID_NETWORK "geo-small"

extern const OverlapOps overlap_hybrid_ops;

#endif
