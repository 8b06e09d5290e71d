// SPDX-License-Identifier: GPL-3.0-or-later
// How wide the contact of two curved bodies becomes in a scene, by Hertz.
//
// Two that curve by κ against each other, 1/E* = 1/E_A' + 1/E_B', and approach each other by δ, are pressed
// by F or meet with the energy W, touch within the radius
//
//   a = √(δ/κ),   a³ = 3 F / (4 E* κ),   δ^(5/2) = 15 W √κ / (8 E*)
//
// with the pressure 2 E* κ a / π in the middle. δ is how far what is driven moves against the other until the
// end of a static scene, F the largest sum of loads, or the weight, W the hardest blow
// (fem/model/compliance/blow.h).
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_PATCH_H
#define TETLAP_FEM_MODEL_COMPLIANCE_PATCH_H

#include "fem/model/model.h"

// How far the party (bodies, then obstacles without elements) is moved by what drives it, at most [m]. Of
// driven vertices the one that moves least counts, or the point of the axis amid them: a turn about an axis
// through them moves nothing towards another body.
double fem_patch_travel(const FemModel *model, int party);
// The largest resultant of the loads on a body (a torque has none; a following pressure as at rest), its
// weight included in a static scene; 0: an obstacle [N].
double fem_patch_load(const FemModel *model, int party);

// a of two that curve by `curvature` > 0 [1/m]; `modulus`: E* [Pa]. The largest of those that δ, F and W
// give.
double fem_patch_radius(double curvature, double modulus, double approach, double force, double energy);

#endif
