// SPDX-License-Identifier: Apache-2.0
// A TetrahedronPairNet from a weights file, and what its card says, made ready for threads: each evaluation
// acquires a workspace, memory for one portion of pairs, and releases it.
#ifndef TETLAP_OVERLAP_TPN_NETWORK_H
#define TETLAP_OVERLAP_TPN_NETWORK_H

#include <stdatomic.h>

#include "base/status.h"
#include "net/files/weights.h"
#include "net/pass/fold.h"
#include "net/pass/forward.h"
#include "net/pass/tangent.h"
#include "overlap/pair/range.h"
#include "overlap/tpn/normalise.h"

enum { OVERLAP_TPN_NORMALISATION_TEXT = 64, OVERLAP_TPN_ROWS = NET_CHUNK_COLUMNS };

// Directions of second derivatives: the coordinates of the second tetrahedron.
enum { OVERLAP_TPN_TANGENTS = 12 };

// What a weights file's card says of the input and the output: "unit, V times 1000".
void overlap_tpn_network_print(OverlapTpnNormalisation kind, double scale,
                               char text[OVERLAP_TPN_NORMALISATION_TEXT]);
bool overlap_tpn_network_parse(const char *text, OverlapTpnNormalisation *kind, double *scale);

// Rows of the network's input and output, one after another.
typedef struct OverlapTpnWorkspace {
  atomic_flag is_taken;
  NetWork_f32 work;
  int row_count;
  float x[OVERLAP_TPN_ROWS * 24], gx[OVERLAP_TPN_ROWS * 24]; // ∂ of what the rows are weighed with, by x
  float y[OVERLAP_TPN_ROWS * 2], c[OVERLAP_TPN_ROWS * 2];    // logit, volume; their weights
  void *more;                                                // the owner's, owned
} OverlapTpnWorkspace;

typedef struct OverlapTpnNetwork {
  NetModel_f32 network; // folded where the normalisation makes the first tetrahedron the same for all pairs
  int input_first;      // it is shown the pair's numbers from here on: 0, or 12 where it is folded or has one
                        // tetrahedron
  NetCard card;
  OverlapTpnNormalisation kind;
  double scale; // the network's output is scale · V' of the normalised pair
  bool has_range;
  OverlapRange range; // that it was trained on, where the card says it
  int workspace_count;
  OverlapTpnWorkspace *workspaces; // (workspace_count), owned
} OverlapTpnNetwork;

// `kernel` evaluates. `more`: bytes of further memory in each workspace. STATUS_INPUT: another kind of
// network, or another normalisation; the message names the file.
Status overlap_tpn_network_create(OverlapTpnNetwork *model, const char *path, NetKernelKind kernel,
                                  size_t more);
void overlap_tpn_network_destroy(OverlapTpnNetwork *model); // a zeroed one is accepted

// Acquires a thread's own workspace as a rule; another one if threads that OpenMP does not count are about.
OverlapTpnWorkspace *overlap_tpn_network_acquire(const OverlapTpnNetwork *model);
void overlap_tpn_network_release(OverlapTpnWorkspace *workspace);

// Adds a row, the normalised pair as the network sees it.
void overlap_tpn_network_add_row(const OverlapTpnNetwork *model, OverlapTpnWorkspace *workspace,
                                 const double pair[24]);

// Row `row` of gx as a derivative by the normalised pair: 0 for what the network is not shown.
void overlap_tpn_network_pull(const OverlapTpnNetwork *model, const OverlapTpnWorkspace *workspace, int row,
                              double gradient[24]);

#endif
