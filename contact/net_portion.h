// SPDX-License-Identifier: GPL-3.0-or-later
// What net_overlap.h does with one portion of pairs: who is asked about each, and how V, ∇V and ∇²V come of
// the answers.
//
//   pairs ─ sift ─► disjoint or flat: nothing
//             ├─► the blend wants no network: exact
//             └─► a seat ─ network ─► z, v ─► blend (net_blend.h) ─► V and its derivatives by what it is made
//             of
//                                                                     └─ times theirs by the pair ─► ∇V, ∇²V
//
// ∇²V is that of this very V, but for the exact model's share in it, whose second derivatives are clipping's.
#ifndef TETLAP_CONTACT_NET_PORTION_H
#define TETLAP_CONTACT_NET_PORTION_H

#include "contact/geo.h"
#include "contact/net_blend.h"
#include "contact/net_model.h"

// A portion with second derivatives has at most so many rows.
enum { CONTACT_NET_BENT_ROWS = 32 };

typedef struct ContactNetOverlap {
  ContactNetModel model;
  ContactNetRule rule;
  ContactNetGhosts ghosts;
  bool turns_to_clip;     // where faces nearly lie in one plane
  ContactGeoModel closed; // the closed form, where it fades or blends
} ContactNetOverlap;

// The bytes that a portion needs at a desk.
size_t contact_net_portion_size(void);

// Whether the network's V has second derivatives: it bends everywhere, and only the second tetrahedron's
// normalised coordinates matter.
bool contact_net_portion_bends(const ContactNetModel *model);

// At most CONTACT_NET_ROWS rows, order_count for a pair; with a Hessian, CONTACT_NET_BENT_ROWS.
Status contact_net_portion_eval(const ContactNetOverlap *overlap, const ContactOverlapBatch *batch,
                                ContactNetDesk *desk);

#endif
