// SPDX-License-Identifier: Apache-2.0
#include "base/machine/interrupt.h"

static volatile sig_atomic_t flag;

volatile sig_atomic_t *interrupt_flag(void) {
  return &flag;
}
