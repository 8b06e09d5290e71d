// SPDX-License-Identifier: GPL-3.0-or-later
// By which law the overlap volume V of volumetric pairs is distributed, and how pairs that are drawn without
// regard to V are sifted to obey it.
//
// Two tetrahedra with vertices uniform in the unit cube have a common volume with probability 0.611; let f be
// the density of ln V among all of them (natural). A pair of volume V is kept with probability
//
//     a(V) = p(ln V) / (c f(ln V)),   c the maximum of p / f over the law's range,
//
// p the density that the law asks for. Kept pairs have exactly the shapes that uniform pairs of that volume
// have, nothing is scaled or moved, and ln V has the density p times the relative error of our f, which is
// below 0.7 % (volume_law.c). 1/c of all pairs drawn is kept.
//
// The number that decides, u < a(V), is drawn first: V must then be at least floor(u), and most pairs that
// are too small for a law that wants large volumes are dropped before V is computed.
#ifndef TETLAP_DATAGEN_LAW_VOLUME_LAW_H
#define TETLAP_DATAGEN_LAW_VOLUME_LAW_H

#include <stddef.h>

#include "base/status.h"

typedef enum DatagenVolumeShape {
  DATAGEN_VOLUME_NATURAL,     // every pair that intersects
  DATAGEN_VOLUME_LOG_UNIFORM, // ln V uniform
  DATAGEN_VOLUME_UNIFORM,     // V uniform
} DatagenVolumeShape;

typedef struct DatagenVolumeLaw {
  DatagenVolumeShape shape;
  double low, high; // of V, in cubes of the unit cube's edge; not used by NATURAL
} DatagenVolumeLaw;

enum { DATAGEN_SIEVE_KNOTS = 257, DATAGEN_VOLUME_TEXT = 64 };

// "natural", "uniform:LOW:HIGH", "log-uniform:LOW:HIGH". STATUS_USAGE: what would be right.
Status datagen_volume_law_parse(DatagenVolumeLaw *law, const char *text);
// The inverse: parses to the same law.
void datagen_volume_law_print(const DatagenVolumeLaw *law, char *text, size_t size);

// A law made ready.
typedef struct DatagenVolumeSieve {
  DatagenVolumeLaw law;
  double log_peak;                      // ln c
  double share;                         // of all uniform pairs that are kept
  double knots[DATAGEN_SIEVE_KNOTS];    // V, evenly spaced in ln V over the law's range
  double ceilings[DATAGEN_SIEVE_KNOTS]; // a is nowhere larger between this knot and the next
} DatagenVolumeSieve;

// STATUS_USAGE: the range is empty, goes beyond 0.03 (where f is not known well), or is so narrow that less
// than one uniform pair in 100,000 would be kept.
Status datagen_volume_law_sieve_make(DatagenVolumeSieve *sieve, const DatagenVolumeLaw *law);

// a(V), in [0, 1]; V > 0.
double datagen_volume_law_sieve_keeps(const DatagenVolumeSieve *sieve, double volume);
// A volume below which a(V) > u is impossible; INFINITY if it is nowhere possible.
double datagen_volume_law_sieve_floor(const DatagenVolumeSieve *sieve, double u);

// ln f(ln V).
double datagen_volume_law_natural(double log_volume);

#endif
