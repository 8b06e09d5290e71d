// SPDX-License-Identifier: Apache-2.0
#include "net/gradient.h"

#include <assert.h>
#include <string.h>

#include "net/drive.h"
#include "net/pass.h"

#include "net/real_f32.h"

#include "net/gradient.inc"

#include "net/real_f64.h"

#include "net/gradient.inc"
