// SPDX-License-Identifier: Apache-2.0
#include "net/pass/gradient.h"

#include <assert.h>
#include <string.h>

#include "net/thread.h"
#include "net/pass/pass.h"

#include "net/real_f32.h"

#include "net/pass/gradient.inc"

#include "net/real_f64.h"

#include "net/pass/gradient.inc"
