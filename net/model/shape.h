// SPDX-License-Identifier: Apache-2.0
// What a network looks like, as data: nothing else decides its layers. A shape travels as JSON in the weights
// file.
//
//   tpn  TetrahedronPairNet. Input: two tetrahedra, (2, 4, 3) coordinates; output: (status logit, volume).
//
//          vertex layers (+ skip) ──► [features | xyz] ──► pool over 4
//            ──► tetrahedron layers (+ skip of its 12 coordinates) ──► pool over 2
//            ──► combiner layers (+ skip of all 24) ──► backbone layers ──► status head, volume head
//
//        With the Unit normalisation the first tetrahedron is constant (the unit simplex); it is fed all the
//        same, so that the input is 24 numbers whatever the normalisation. `has_one_tetrahedron`: it is not
//        fed, the input is the second one's (1, 4, 3), and there is no pool over tetrahedra.
//   mlp  Dense layers: input_count → hidden → output_count, the last linear.
//
// Every layer is linear followed by the activation; a skip is a linear map of the block's raw input, added
// after the block's last activation; a head ends in a linear layer of width 1. `ends_linear`: no activation
// follows the last layer of the vertex, tetrahedron and combiner blocks.
#ifndef NET_SHAPE_H
#define NET_SHAPE_H

#include <stdbool.h>
#include <stddef.h>

#include "net/status.h"

enum { NET_MAX_DEPTH = 8, NET_MAX_WIDTH = 8192, NET_MAX_OUTPUTS = 64, NET_SHAPE_TEXT = 2048 };

typedef enum NetKind { NET_TPN, NET_MLP } NetKind;
typedef enum NetActivation { NET_RELU, NET_SILU } NetActivation;
typedef enum NetPool { NET_MAX, NET_SUM } NetPool;

typedef enum NetSkip {
  NET_SKIP_NONE,
  NET_SKIP_BIASED,
  NET_SKIP_UNBIASED,
  NET_SKIP_PER_INDEX, // vertices only: a matrix for each of the four indices, without bias. Not invariant.
  NET_SKIP_OWN,       // a matrix and a bias for each of the pair's eight vertices or two tetrahedra, all of
                      // them made, also those of a tetrahedron that is not fed. Not invariant.
} NetSkip;

typedef struct NetWidths {
  int count;
  int width[NET_MAX_DEPTH];
} NetWidths;

typedef struct NetShape {
  NetKind kind;
  NetActivation activation;
  NetPool pool;          // tpn
  bool has_coordinates;  // tpn: raw xyz beside the vertex features before they are pooled
  NetWidths vertex;      // tpn, at least one
  NetWidths tetrahedron; // tpn, at least one
  NetWidths combiner;    // tpn, at least one
  NetWidths backbone;    // tpn, may be empty
  NetWidths status_head; // tpn, hidden widths: the layer to one output is not listed
  NetWidths volume_head; // tpn, likewise
  NetSkip vertex_skip;
  NetSkip tetrahedron_skip; // a tetrahedron's 12 coordinates in their order: not invariant to the order of
                            // vertices
  NetSkip combiner_skip;    // all 24: neither to the order of vertices nor of tetrahedra
  NetWidths hidden;         // mlp, may be empty: then the network is affine
  bool has_one_tetrahedron; // tpn: the input is the second one alone
  bool ends_linear;         // tpn
  int input_count;          // tpn 24, or 12 with one tetrahedron
  int output_count;         // tpn 2
} NetShape;

// Two readings of the paper's Table 3 that have exactly 73,370 parameters, without its 1024-wide
// backbone: (a) coordinates concatenated, all skips biased; (b) none concatenated, a vertex skip for each
// index, one bias-free skip from the tetrahedron, a biased one from the pair.
NetShape net_shape_tpn_a(void);
NetShape net_shape_tpn_b(void);

// (c) The published network, off its authors' public code: one tetrahedron, blocks that end linearly, a skip
// of its own for each vertex and tetrahedron. 73,370 parameters, of which 1,008 are made for the other
// tetrahedron and never reached.
NetShape net_shape_tpn_c(void);

// Reading (a) with the 1024-wide backbone that the table names (410,266 parameters).
NetShape net_shape_tpn_backbone(void);

// `depth` hidden SiLU layers of one width.
NetShape net_shape_mlp(int input_count, int width, int depth, int output_count);

// NET_BAD_ARGUMENT with the name of the field that is out of range.
NetStatus net_shape_check(const NetShape *shape);

bool net_shape_equal(const NetShape *a, const NetShape *b);

// JSON in and out. Reading refuses unknown and missing keys by name (NET_BAD_FILE); it leaves a shape that
// net_shape_check accepts.
NetStatus net_shape_print(const NetShape *shape, char text[NET_SHAPE_TEXT]);
NetStatus net_shape_parse(const char *text, NetShape *shape);

#endif
