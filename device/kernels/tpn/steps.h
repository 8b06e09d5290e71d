// SPDX-License-Identifier: Apache-2.0
// What a step of a network is for kernels/tpn/network.inc; part of the program's text, and of
// device/network/tpn.c.
enum { TPN_ITEMS = 64 };
enum { TPN_PAIRS = 32, TPN_ROOM = 368 };             // of a group that wants V: pairs, rows of its memory
enum { TPN_SLOPE_PAIRS = 4, TPN_SLOPE_ROOM = 2000 }; // that wants ∇V, too
enum { TPN_LINEAR, TPN_POOL, TPN_POOL_WITH };        // kinds of steps
// Normalisations, as OVERLAP_TPN_NORMALISE_….
enum { TPN_UNIT = 0, TPN_SORTED = 2, TPN_UNSCALED = 3, TPN_AXIS = 4 };
// What a step's integers are: rows of the group's memory, places in the parameters; −1: none.
enum {
  STEP_KIND,
  STEP_INPUT,
  STEP_INPUT_ROWS,
  STEP_OUTPUT,
  STEP_OUTPUT_ROWS,
  STEP_BASE,
  STEP_WEIGHT,
  STEP_WEIGHT_COLUMNS,
  STEP_BIAS,
  STEP_RELU,
  STEP_COLUMNS, // groups of pairs in a row of the output
  STEP_PARTS,   // that a pool joins
  STEP_PART,    // of a row's groups, the first that the step is for, and how many
  STEP_PART_COUNT,
  STEP_INPUT_SLOPE, // derivatives by input and output
  STEP_OUTPUT_SLOPE,
  STEP_IS_RAW,      // of bf16: a factor is a coordinate, nothing is rounded
  STEP_PACKED,      // of bf16: the weights as fragments (mma.inc), and their transpose
  STEP_PACKED_BACK,
  TPN_STEP
};
// Of a place that a coordinate goes to: its row, the coordinate, the row of its derivative.
enum { VIEW_ROW, VIEW_COORDINATE, VIEW_SLOPE, TPN_VIEW };
// Rows of what is known of a pair: 12 coordinates, then the derivatives by them; what the network tells.
enum { TPN_ROW_TOLD = 12, TPN_ROWS };
// Of a pass.
enum {
  PASS_STEPS,
  PASS_VIEWS,
  PASS_OUTPUT,
  PASS_OUTPUT_SLOPE,
  PASS_SLOPES,
  PASS_SLOPE_ROWS,
  TPN_PASS
};
