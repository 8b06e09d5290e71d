// SPDX-License-Identifier: GPL-3.0-or-later
// A small network with random weights for tests of the overlap model `geo`: two SiLU layers in double, its
// gradient and its second derivatives written out plainly.
#ifndef TETLAP_TESTS_GEO_NETWORK_H
#define TETLAP_TESTS_GEO_NETWORK_H

#include <math.h>

#include "base/random.h"
#include "overlap/geo/geo.h"

enum { GEO_NETWORK_WIDTH = 16 };

typedef struct GeoNetwork {
  int feature_count;
  double inner[GEO_NETWORK_WIDTH][OVERLAP_GEO_MAX_FEATURES + 1]; // the last: bias
  double outer[GEO_NETWORK_WIDTH][GEO_NETWORK_WIDTH + 1];
  double last[GEO_NETWORK_WIDTH];
} GeoNetwork;

// Features are divided by what they are at the onset or so, so that all matter.
static inline GeoNetwork geo_network_random(int feature_count, uint64_t seed) {
  GeoNetwork network = {.feature_count = feature_count};
  Random random = random_seeded(seed, 0);
  for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
    for (int j = 0; j <= feature_count; j++)
      network.inner[i][j] = suite_normal(&random) / sqrt(feature_count);
    for (int j = 0; j <= GEO_NETWORK_WIDTH; j++)
      network.outer[i][j] = suite_normal(&random) / sqrt(GEO_NETWORK_WIDTH);
    network.last[i] = suite_normal(&random) / sqrt(GEO_NETWORK_WIDTH);
  }
  return network;
}

// SiLU and its first two derivatives.
static inline void geo_network_silu(double z, double a[3]) {
  double s = 1 / (1 + exp(-z)), t = s * (1 - s);
  a[0] = z * s;
  a[1] = s + z * t;
  a[2] = t * (2 + z * (1 - 2 * s));
}

typedef struct GeoNetworkPass {
  double inner[GEO_NETWORK_WIDTH][3], outer[GEO_NETWORK_WIDTH][3]; // activations and two derivatives
} GeoNetworkPass;

static inline double geo_network_forward(const GeoNetwork *network, const double *f, GeoNetworkPass *pass) {
  int count = network->feature_count;
  double value = 0;
  for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
    double z = network->inner[i][count];
    for (int j = 0; j < count; j++) z += network->inner[i][j] * f[j];
    geo_network_silu(z, pass->inner[i]);
  }
  for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
    double z = network->outer[i][GEO_NETWORK_WIDTH];
    for (int j = 0; j < GEO_NETWORK_WIDTH; j++) z += network->outer[i][j] * pass->inner[j][0];
    geo_network_silu(z, pass->outer[i]);
    value += network->last[i] * pass->outer[i][0];
  }
  return value;
}

// ∂ρ/∂(inner activation j)
static inline double geo_network_back(const GeoNetwork *network, const GeoNetworkPass *pass, int j) {
  double sum = 0;
  for (int i = 0; i < GEO_NETWORK_WIDTH; i++)
    sum += network->last[i] * pass->outer[i][1] * network->outer[i][j];
  return sum;
}

static inline Status geo_network_eval(const void *self, int count, const double *features, double *value,
                                      double *gradient) {
  const GeoNetwork *network = self;
  int size = network->feature_count;
  for (int n = 0; n < count; n++) {
    GeoNetworkPass pass;
    value[n] = geo_network_forward(network, features + n * size, &pass);
    if (!gradient) continue;
    for (int f = 0; f < size; f++) gradient[n * size + f] = 0;
    for (int j = 0; j < GEO_NETWORK_WIDTH; j++) {
      double back = geo_network_back(network, &pass, j) * pass.inner[j][1];
      for (int f = 0; f < size; f++) gradient[n * size + f] += back * network->inner[j][f];
    }
  }
  return STATUS_OK;
}

static inline void geo_network_curve_one(const GeoNetwork *network, const double *features,
                                         int direction_count, const double *directions, double *second) {
  int size = network->feature_count;
  GeoNetworkPass pass;
  double inner[12][GEO_NETWORK_WIDTH], outer[12][GEO_NETWORK_WIDTH]; // changes of the layers' inputs
  geo_network_forward(network, features, &pass);
  for (int d = 0; d < direction_count; d++) {
    for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
      inner[d][i] = 0;
      for (int f = 0; f < size; f++) inner[d][i] += network->inner[i][f] * directions[d * size + f];
    }
    for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
      outer[d][i] = 0;
      for (int j = 0; j < GEO_NETWORK_WIDTH; j++)
        outer[d][i] += network->outer[i][j] * pass.inner[j][1] * inner[d][j];
    }
  }
  for (int d = 0; d < direction_count; d++)
    for (int e = 0; e < direction_count; e++) {
      double sum = 0;
      for (int i = 0; i < GEO_NETWORK_WIDTH; i++) {
        sum += network->last[i] * pass.outer[i][2] * outer[d][i] * outer[e][i];
        sum += geo_network_back(network, &pass, i) * pass.inner[i][2] * inner[d][i] * inner[e][i];
      }
      second[d * direction_count + e] = sum;
    }
}

static inline Status geo_network_curve(const void *self, int count, const double *features,
                                       int direction_count, const double *directions, double *second) {
  const GeoNetwork *network = self;
  int size = network->feature_count;
  for (int n = 0; n < count; n++)
    geo_network_curve_one(network, features + n * size, direction_count,
                          directions + n * direction_count * size,
                          second + n * direction_count * direction_count);
  return STATUS_OK;
}

static inline OverlapGeoNetwork geo_network_interface(const GeoNetwork *network) {
  return (OverlapGeoNetwork){.self = network,
                             .feature_count = network->feature_count,
                             .eval = geo_network_eval,
                             .curve = geo_network_curve};
}

#endif
