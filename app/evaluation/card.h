// SPDX-License-Identifier: GPL-3.0-or-later
// What kind of overlap model a name stands for and how large its network is: for tables and frontiers.
#ifndef TETLAP_APP_EVALUATION_CARD_H
#define TETLAP_APP_EVALUATION_CARD_H

#include <stdbool.h>

#include "overlap/model.h"

typedef struct AppModelCard {
  const char *family;   // "geo" or "tpn"; else the model's own name
  bool is_learned;      // what follows is 0 where it is not
  int features;         // inputs of the network
  int width, depth;     // geo: hidden layers; tpn: of the combiner's, and layers a block
  long long parameters; //
  double flops;         // multiplications and additions of its matrix products for one pair's V
  bool is_float;        // they are done in float
  char path[512];       // of the weights file
} AppModelCard;

// The card of a model that was made by that name or from that file. STATUS_INPUT: the file holds no network.
Status app_evaluation_card_read(const OverlapModel *model, const char *name, AppModelCard *card);

#endif
