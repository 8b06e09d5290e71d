// SPDX-License-Identifier: Apache-2.0
// A trained network of net/ as the ρ of `geo`: read from a weights file, evaluated in double, whatever the
// file's precision (folded whitening cancels digits).
#ifndef TETLAP_OVERLAP_GEO_NETWORK_H
#define TETLAP_OVERLAP_GEO_NETWORK_H

#include "net/files/weights.h"
#include "overlap/geo/geo.h"

// What the card of such a file gives as its normalisation.
#define OVERLAP_GEO_NORMALISATION "analytic-centre frame"
#define OVERLAP_GEO_BOUND_NORMALISATION "analytic-centre frame, a bound of the error of V"

typedef struct OverlapGeoNet OverlapGeoNet; // opaque: parameters, and memory of evaluation for every thread

// STATUS_INPUT: no weights file, or one of another kind. A dense SiLU network with as many inputs as a set
// has features is wanted, with one output. As many more as a plane has features give the centroid. The
// message names the file.
Status overlap_geo_network_create(OverlapGeoNet **net, const char *path);
// The same of a network that gives a bound of another's error: it has one output, and its card says so.
Status overlap_geo_network_create_bound(OverlapGeoNet **net, const char *path);
void overlap_geo_network_destroy(OverlapGeoNet *net);

// The network itself, the net's.
const NetModel_f64 *overlap_geo_network_model(const OverlapGeoNet *net);

// Numbers as many as its parameters, in their order, as a weights file of the same shape.
Status overlap_geo_network_write(const OverlapGeoNet *net, const double *numbers, const char *path);

// Borrows the net.
OverlapGeoNetwork overlap_geo_network_interface(const OverlapGeoNet *net);

#endif
