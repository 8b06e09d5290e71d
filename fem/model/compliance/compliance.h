// SPDX-License-Identifier: GPL-3.0-or-later
// How stiff contact is: κ of each two that can meet, as the scene gives it or as it is chosen from the
// bodies. For the potential `field` κ is called c [Pa/m], and chosen by the following.
//
// 1. Bodies. Under a pressure p the interface of two bodies yields by p/(2c) and the bodies by about p L
// (1/E_A' + 1/E_B'). L is the height of the smaller one (extent.h): a patch of contact is no larger than
// that, and material farther away deforms little. So
//
//   c = 25 / (L (1/E_A' + 1/E_B')),     E' = E/(1 − 3.5 ν⁴)
//
// keeps the first at 2 % of the second. For two equal bodies it is 12.5 E'/L. E' is a fit to the stiffness of
// cubes that are held on the pressed face. Obstacles do not yield, nor does a body whose every
// vertex is held or driven. A shape without elements presses with c d
// in place of 2 c d: against one, c = 50 E'/L. Where two curve, a patch of the radius a (patch.h) yields by
// π/2 a (1/E_A' + 1/E_B') for each Pa in its middle. Where that is less than what whole bodies yield, and
// neither lies in a hollow of the other, c keeps 2 % of that.
//
// 2. Impact. An impact may compress bodies by as much as their height. Two bodies that store the energy W of
// the hardest impact of the scene (blow.h) press each other with p = √(2 W / (V_A/E_A + V_B/E_B)), V their
// volumes. c is at least such that this p compresses the interface by 1 % of L. Here L is no more than the
// wall of what is slender or hollow (thickness.h): behind its middle nothing pushes back out. Beyond p = E
// the bodies would have no height left. They are crushed, and their edges hold them apart. An edge of length
// L that is pressed by d into a half-space stores c L d³/3, into a body 0.57 c L d³. With
//
//   c = 50 q / L, against a shape without elements 100 q / L,     q = max(p, p²/E), E of the softer one
//
// the edge of a cube stores the whole of W, which is p² L³/(2 E) then (twice that of two equal cubes), within
// d = L/4 (L/3).
//
// 3. Elements. Where a surface curves, facets touch at corners if the overlap is not as deep as their
// sagittas, and the elements do not resolve what varies within an edge. So the interface yields at least as
// much as λ of the layer of elements at the two surfaces:
//
//   c ≤ 1 / (2 λ (h_A/E_A' + h_B/E_B')),     against a shape without elements twice that,
//
// h the edge there (contact/surface/roundness.h). λ is .34, less in proportion where more than 2.2 edges
// resolve a. It is .25 where one lies in the hollow of another: radii a quarter apart at most, and boxes that
// share half of the lesser one. An impact goes before this bound. Without a hollow the bound is not used
// where a is not known or is more than .6 of the radius of curvature.
//
// 4. Leaves that bend together have a bound of their own (leaf.h). But for them and tips the choice between
// flat faces does not depend on the mesh.
//
// 5. Tips. Under a rigid cone of the half angle β the mean pressure is E* cot β/2 at any load, 1/E* = 1/E_A'
// + 1/E_B' (Sneddon 1965). A tip that does not give way is pressed by c d/3 at the depth d: F = π c tan²β
// d³/3. Where one of the two has a tip (tip.h), c is at least that with which it gives way at a fifth of the
// reach h of its elements, whatever the curvature behind it:
//
//   c = 1.5 E* cot β/(.2 h).
//
// Elements of the other body that are k times as long as h count with k² E': under a tip they are that much
// stiffer.
//
// The pressures that loads and the hardest impact may cause are estimated: Hertz's 2 κ a/(π Σ 1/E'), κ here
// the curvature, in the middle of a patch; between flat faces the larger of F over V/L of the smaller one and
// of p as above. Motions are not counted.
//
// The chosen contact.smooth is the least level at which the overlap in the middle of the patch is as deep as
// 2.5 sagittas of what is left, h²/(8 R · 4^level). It is 2 in a hollow, where pressures are low beside E
// h/R, and 1 where a is not known. Quadratic elements with straight edges stay as they are: nodes between
// corners are no points of a round surface.
#ifndef TETLAP_FEM_MODEL_COMPLIANCE_COMPLIANCE_H
#define TETLAP_FEM_MODEL_COMPLIANCE_COMPLIANCE_H

#include "fem/model/model.h"

// What a κ comes from.
typedef enum FemComplianceBound {
  FEM_COMPLIANCE_SCENE,    // nothing: the scene says it
  FEM_COMPLIANCE_BODIES,   // 2 % of the compression of the bodies
  FEM_COMPLIANCE_BLOW,     // the hardest impact
  FEM_COMPLIANCE_ELEMENTS, // the elements at a curved surface
  FEM_COMPLIANCE_LEAVES,   // two leaves that bend together
  FEM_COMPLIANCE_TIP,      // the elements at the tip of one
} FemComplianceBound;

typedef struct FemCompliance {
  int party_count;            // bodies (obstacles with a mesh among them), then obstacles without elements
  double *stiffness;          // κ of body a with party b                    (body_count, party_count)
  FemComplianceBound *bounds; // what it comes from                          (body_count, party_count)
  double *pressures;          // that they may press each other with, roughly [Pa]; 0: not known; likewise
  int *levels;                // of contact.smooth                           (body_count)
  bool *is_faceted; // quadratic with straight edges, where a level above 0 is due         (body_count)
} FemCompliance;

// Destroy the choice; after a failure there is nothing to destroy. Entries of what cannot meet are positive
// too. STATUS_INPUT: `contact.pairs` names what is not there.
Status fem_compliance_choose(const FemModel *model, FemCompliance *choice);
void fem_compliance_destroy(FemCompliance *choice); // also of a zeroed one

// Whether two parties can meet: a body with another party, or with itself.
bool fem_compliance_meets(const FemModel *model, int a, int b);

// The number of the body or obstacle of that name as a party; −1: there is none.
int fem_compliance_party(const FemModel *model, const char *name);
// The name of that party; "?" if there is none. Borrowed.
const char *fem_compliance_party_name(const FemModel *model, int party);

// μ between two parties: the scene's, or that of the last of `contact.pairs` with these two. Names must have
// been checked (fem_compliance_choose).
FemFrictionDef fem_compliance_friction(const FemModel *model, int a, int b);

// The least and largest κ of what can meet.
void fem_compliance_range(const FemModel *model, const FemCompliance *choice, double range[2]);

#endif
