// SPDX-License-Identifier: GPL-3.0-or-later
// TetrahedronPairNet as an overlap model, as it was published: the pair is normalised (normalise.h), a
// network of net/ tells a status logit z and v, and
//
//     V = factor · max(0, v) / scale,   ∇V through the normalisation.
//
// ∇V is that of this V: piecewise constant in the normalised pair with ReLU. The logit changes nothing here.
// Pairs that the normalisation cannot take are answered by the exact model and flagged FALLBACK.
#ifndef TETLAP_CONTACT_NET_OVERLAP_H
#define TETLAP_CONTACT_NET_OVERLAP_H

#include "contact/normalise.h"
#include "contact/overlap.h"

enum { CONTACT_NET_NORMALISATION_TEXT = 64 };

// What a weights file's card says of the input and the output: "unit, V times 1000".
void contact_net_overlap_print(ContactNormalisation kind, double scale,
                               char text[CONTACT_NET_NORMALISATION_TEXT]);
bool contact_net_overlap_parse(const char *text, ContactNormalisation *kind, double *scale);

// The shipped weights of that name, tpn.safetensors.
extern const ContactOverlapOps contact_overlap_tpn;

// From a weights file. STATUS_INPUT: another kind of network; the message names the file.
Status contact_net_overlap_create(void **self, const char *path);
void contact_net_overlap_destroy(void *self);

// As ContactOverlapOps; `hessian` is not offered.
Status contact_net_overlap_eval_pair(const void *self, const double pair[24], double *volume,
                                     double *gradient, double *hessian, unsigned *flags);
Status contact_net_overlap_eval_batch(const void *self, const ContactOverlapBatch *batch);

// The status logits of pairs (count, 24): positive where the network says that they intersect; of pairs that
// the normalisation cannot take −∞.
Status contact_net_overlap_logits(const void *self, int count, const double *pairs, double *logits);

#endif
