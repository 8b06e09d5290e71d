// SPDX-License-Identifier: Apache-2.0
// The whole state of a training as a safetensors file: a run that is resumed continues as if it had never
// stopped, to the bit. The file appears whole. It is of one precision and one shape; another is refused.
#ifndef NET_CHECKPOINT_H
#define NET_CHECKPOINT_H

#include "net/model/model.h"
#include "net/model/random.h"
#include "net/model/whitening.h"
#include "net/training/adam.h"
#include "net/training/schedule.h"

#include "net/real_f32.h"

#include "net/files/checkpoint_template.h"

#include "net/real_f64.h"

#include "net/files/checkpoint_template.h"

#endif
