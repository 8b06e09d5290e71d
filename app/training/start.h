// SPDX-License-Identifier: GPL-3.0-or-later
// First weights of a training from a file, to fine-tune what was trained before.
#ifndef TETLAP_APP_TRAINING_START_H
#define TETLAP_APP_TRAINING_START_H

#include "base/status.h"
#include "net/model/model.h"
#include "net/model/whitening.h"

// Reads the parameters of a file, or of a model whose weights ship, with the model's shape and the card's
// normalisation. With a whitening (may be NULL) the file's network takes features f and the model takes
// w = M (f − mean): the first layer is brought over, W ← W M⁻¹, b ← b + W mean. With that of vectors.h (may
// be NULL) so are the last layer's rows from the second on; a file without those leaves the model's as they
// are. STATUS_INPUT: another shape or normalisation.
Status app_training_start_read(const char *name, const char *normalisation, const NetWhitening *whitening,
                               const NetWhitening *vectors, NetModel_f32 *model);

#endif
