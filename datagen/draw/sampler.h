// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of a wanted kind, drawn until the exact proof confirms the kind.
#ifndef TETLAP_DATAGEN_DRAW_SAMPLER_H
#define TETLAP_DATAGEN_DRAW_SAMPLER_H

#include "base/random.h"
#include "datagen/draw/proof.h"
#include "datagen/law/volume_law.h"

typedef struct DatagenSample {
  double pair[24];    // (2, 4, 3)
  DatagenProof proof; // as the kind claims; of the pair before it was swapped
  long long attempts; // candidates drawn, this one among them
} DatagenSample;

// `sieve` matters to VOLUMETRIC only. Vertices of either tetrahedron come in random order; with probability
// `swap_share` the two are exchanged. `kind` is not CAPTURED.
DatagenSample datagen_sampler_draw(DatagenKind kind, const DatagenVolumeSieve *sieve, double swap_share,
                                   Random *random);

#endif
