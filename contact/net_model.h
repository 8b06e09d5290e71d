// SPDX-License-Identifier: GPL-3.0-or-later
// A TetrahedronPairNet from a weights file, and what its card says, made ready for threads: each evaluation
// takes a desk, memory for one portion of pairs, and gives it back.
#ifndef TETLAP_CONTACT_NET_MODEL_H
#define TETLAP_CONTACT_NET_MODEL_H

#include <stdatomic.h>

#include "base/status.h"
#include "contact/net_range.h"
#include "contact/normalise.h"
#include "net/fold.h"
#include "net/forward.h"
#include "net/tangent.h"
#include "net/weights.h"

enum { CONTACT_NET_NORMALISATION_TEXT = 64, CONTACT_NET_ROWS = NET_CHUNK_COLUMNS };

// Directions of second derivatives: the coordinates of the second tetrahedron.
enum { CONTACT_NET_TANGENTS = 12 };

// What a weights file's card says of the input and the output: "unit, V times 1000".
void contact_net_model_print(ContactNormalisation kind, double scale,
                             char text[CONTACT_NET_NORMALISATION_TEXT]);
bool contact_net_model_parse(const char *text, ContactNormalisation *kind, double *scale);

// Rows of the network's input and output, one after another.
typedef struct ContactNetDesk {
  atomic_flag is_taken;
  NetWork_f32 work;
  int row_count;
  float x[CONTACT_NET_ROWS * 24], gx[CONTACT_NET_ROWS * 24]; // ∂ of what the rows are weighed with, by x
  float y[CONTACT_NET_ROWS * 2], c[CONTACT_NET_ROWS * 2];    // logit, volume; their weights
  void *more;                                                // the owner's, owned
} ContactNetDesk;

typedef struct ContactNetModel {
  NetModel_f32 network; // folded where the normalisation makes the first tetrahedron the same for all pairs
  int input_first;      // it is shown the pair's numbers from here on: 0, or 12 where it is folded
  NetCard card;
  ContactNormalisation kind;
  double scale; // the network tells scale · V' of the normalised pair
  bool has_range;
  ContactNetRange range; // that it was trained on, where the card says it
  int desk_count;
  ContactNetDesk *desks; // (desk_count), owned
} ContactNetModel;

// `kernel` evaluates. `more`: bytes of further memory at each desk. STATUS_INPUT: another kind of network, or
// another normalisation; the message names the file.
Status contact_net_model_create(ContactNetModel *model, const char *path, NetKernelKind kernel, size_t more);
void contact_net_model_destroy(ContactNetModel *model); // a zeroed one is accepted

// A thread's own desk as a rule; another one if threads that OpenMP does not count are about.
ContactNetDesk *contact_net_model_take(const ContactNetModel *model);
void contact_net_model_leave(ContactNetDesk *desk);

// Adds a row, the normalised pair as the network sees it.
void contact_net_model_lay(const ContactNetModel *model, ContactNetDesk *desk, const double pair[24]);

// Row `row` of gx as a derivative by the normalised pair: 0 for what the network is not shown.
void contact_net_model_lift(const ContactNetModel *model, const ContactNetDesk *desk, int row,
                            double gradient[24]);

#endif
