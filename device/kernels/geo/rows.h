// SPDX-License-Identifier: Apache-2.0
// Where the kernels of geo keep a pair's numbers between them: rows of a table whose columns are the pairs
// that intersect (slots). Part of the program's text, and of device/network/geo.c.
enum {
  GEO_ROW_SLACK = 0,     // s_k
  GEO_ROW_SCALED = 8,    // ∇s_k, then m: component c of plane k in row 8 c + k
  GEO_ROW_BASIS = 32,    // Q, likewise by column
  GEO_ROW_VOLUME = 56,   // the smaller tetrahedron's volume, then V₀
  GEO_ROW_FEATURES = 57, // then dρ/df; the network's outputs follow
};

enum { GEO_ITEMS = 64, GEO_COLUMNS = 16, GEO_ROOM = 320 }; // pairs of a group in the network, its rows

// What a layer of the network is: rows of the group's memory, places in the parameters. −1: none.
enum {
  LAYER_INPUT,
  LAYER_INPUT_ROWS,
  LAYER_OUTPUT,
  LAYER_OUTPUT_ROWS,
  LAYER_SLOPE,
  LAYER_WEIGHT,
  LAYER_BIAS,
  GEO_LAYER
};
enum { GEO_MOST_LAYERS = 8 };
