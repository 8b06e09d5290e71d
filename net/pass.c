// SPDX-License-Identifier: Apache-2.0
#include "net/pass.h"

#include <string.h>

#include "net/real_f32.h"

#include "net/pass.inc"

#include "net/real_f64.h"

#include "net/pass.inc"
