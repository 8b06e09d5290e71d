// SPDX-License-Identifier: Apache-2.0
#include "net/forward.h"

#include <assert.h>

#include "net/drive.h"
#include "net/pass.h"

#include "net/real_f32.h"

#include "net/forward.inc"

#include "net/real_f64.h"

#include "net/forward.inc"
