// SPDX-License-Identifier: GPL-3.0-or-later
// A trained network of net/ as the ρ of `geo`: read from a weights file, evaluated in double, whatever the
// file's precision (folded whitening cancels digits).
#ifndef TETLAP_CONTACT_GEO_NET_H
#define TETLAP_CONTACT_GEO_NET_H

#include "contact/geo.h"
#include "net/weights.h"

// What the card of such a file gives as its normalisation.
#define CONTACT_GEO_NORMALISATION "analytic-centre frame"

typedef struct ContactGeoNet ContactGeoNet; // opaque: parameters, and memory of evaluation for every thread

// STATUS_INPUT: no weights file, or one of another kind: a dense SiLU network with 36, 70 or 100 inputs and
// one output is wanted. The message names the file.
Status contact_geo_net_create(ContactGeoNet **net, const char *path);
void contact_geo_net_destroy(ContactGeoNet *net);

// Borrows the net.
ContactGeoNetwork contact_geo_net_interface(const ContactGeoNet *net);

const NetCard *contact_geo_net_card(const ContactGeoNet *net);

#endif
