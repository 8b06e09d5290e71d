// SPDX-License-Identifier: GPL-3.0-or-later
// The tip of a body with which it may meet others first: a vertex of its surface where the body is no wider
// than a narrow cone, in no direction. A vertex that is held or driven in a direction, or that lies on a part
// of the boundary that is no surface, is none.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_TIP_H
#define TETLAP_FEM_MODEL_COMPLIANCE_TIP_H

#include "fem/model/model.h"

typedef struct FemTip {
  double slope; // cot β of the round cone of the same solid angle, 2π (1 − cos β); 0: there is no tip
  double reach; // of the elements there: the least of their longest edges at the tip [m]
} FemTip;

// Of several tips the one with the largest slope/reach. STATUS_MEMORY possible.
Status fem_tip_find(const FemModel *model, int body, FemTip *tip);

#endif
