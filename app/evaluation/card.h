// SPDX-License-Identifier: GPL-3.0-or-later
// What kind of overlap model a name stands for and how large its network is.
#ifndef TETLAP_APP_EVALUATION_CARD_H
#define TETLAP_APP_EVALUATION_CARD_H

#include "overlap/model.h"

typedef struct AppModelCard {
  const char *family;   // "geo" or "tpn"; else the model's own name
  long long parameters; // of its network; 0: it has none
} AppModelCard;

// The card of a model that was made by that name (overlap/source.h). STATUS_INPUT: its weights file holds no
// network.
Status app_evaluation_card_read(const OverlapModel *model, const char *name, AppModelCard *card);

#endif
