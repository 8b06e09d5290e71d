// SPDX-License-Identifier: Apache-2.0
// A trained network as a file: safetensors whose tensors have PyTorch's names and layout and whose metadata
// say what it is:
//
//   format         "tetlap-net 1"
//   shape          the shape as JSON (net_shape_print)
//   normalisation  what was done to the input before, and is to be done by whoever evaluates
//   range          what inputs it was trained on
//   provenance     data, seed, program: how it came to be
//
// The last three are texts of the caller's, in any form; net/ does not read them. Numbers are F32 or F64,
// converted to the precision that is asked for.
#ifndef NET_WEIGHTS_H
#define NET_WEIGHTS_H

#include "net/model/model.h"

typedef struct NetCard {
  char *normalisation; // owned where it was read
  char *range;
  char *provenance;
} NetCard;

void net_weights_card_destroy(NetCard *card);

#include "net/real_f32.h"

#include "net/files/weights_template.h"

#include "net/real_f64.h"

#include "net/files/weights_template.h"

#endif
