// SPDX-License-Identifier: Apache-2.0
#include "net/dense.h"

#include <assert.h>
#include <string.h>

bool net_dense_is_possible(const NetShape *shape) {
  return shape->kind == NET_MLP && shape->activation == NET_SILU;
}

#include "net/real_f32.h"

#include "net/dense.inc"

#include "net/real_f64.h"

#include "net/dense.inc"
