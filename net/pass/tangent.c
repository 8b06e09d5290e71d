// SPDX-License-Identifier: Apache-2.0
#include "net/pass/tangent.h"

#include <assert.h>

#include "net/thread.h"
#include "net/pass/pass.h"

#include "net/real_f32.h"

#include "net/pass/tangent.inc"

#include "net/real_f64.h"

#include "net/pass/tangent.inc"
