// SPDX-License-Identifier: Apache-2.0
#include "net/pass/pass.h"

#include <string.h>

#include "net/real_f32.h"

#include "net/pass/pass.inc"

#include "net/real_f64.h"

#include "net/pass/pass.inc"
