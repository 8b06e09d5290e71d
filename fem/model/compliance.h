// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contact is: κ of each two that can meet, as the scene says or as chosen from the bodies.
//
// For the potential `field` the choice does not depend on the mesh. Under a pressure p the interface of two
// bodies yields by p/(2c) and the bodies by about p L (1/E_A' + 1/E_B'), L the height of the smaller one: a
// patch of contact is no larger than that, and material farther away deforms little. So
//
//   c = 25 / (L (1/E_A' + 1/E_B')),     E' = E/(1 − 3.5 ν⁴)
//
// keeps the first at 2 % of the second: 12.5 E'/L for two equal bodies. E' is a fit to the stiffness of cubes
// that are held on the pressed face. Obstacles do not yield, and a shape without elements presses with c d in
// place of 2 c d: against one, c = 50 E'/L. The height of a body of any shape is the smaller of √12 times its
// least radius of inertia, which is the least edge of a box, and six times its volume over its surface, which
// is the edge of a cube and follows the wall of what is hollow.
//
// An impact may compress bodies by as much as their height. Two bodies that store the energy W of the hardest
// impact of the scene (blow.h) press each other with p = √(2 W / (V_A/E_A + V_B/E_B)), V their volumes.
// Where it is more than the value above, c is such that this p compresses the interface by 1 % of L. Beyond
// p = E the bodies would have no height left: they are crushed, and what holds them apart are their edges.
// An edge of length L that is pressed by d into a half-space stores c L d³/3, into a body 0.57 c L d³. With
//
//   c = 50 q / L, against a shape without elements 100 q / L,     q = max(p, p²/E), E of the softer one
//
// the edge of a cube stores the whole of W, p² L³/(2 E) then (twice that of two equal cubes), within d = L/4
// (L/3).
//
// The rule assumes contact over the whole width. Where the contact is far smaller than both bodies, of radius
// a, they yield by about p a (1/E_A + 1/E_B) only, and the interface by L/a times 2 % of that. For such
// contacts set contact.stiffness to about L/a times the chosen value.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_H
#define TETLAP_FEM_MODEL_COMPLIANCE_H

#include "fem/model/model.h"

// κ of every body with every party, bodies then the obstacles without elements in the scene's order, into
// (body_count, body_count + obstacle_count); entries of what cannot meet are positive too. An array of the
// caller's (memory_free). `party_count`: the columns. STATUS_INPUT: `contact.pairs` names what is not there.
Status fem_compliance_stiffness(const FemModel *model, double **stiffness, int *party_count);

// The number of the body or obstacle of that name as a party; −1: there is none.
int fem_compliance_party(const FemModel *model, const char *name);
// The name of that party; "?" if there is none. Borrowed.
const char *fem_compliance_party_name(const FemModel *model, int party);

// μ between two parties: the scene's, or that of the last of `contact.pairs` with these two. Names must have
// been checked (fem_compliance_stiffness).
double fem_compliance_friction(const FemModel *model, int a, int b);

// Its least and largest entry of what can meet.
Status fem_compliance_range(const FemModel *model, double range[2]);

#endif
