// SPDX-License-Identifier: Apache-2.0
// What a step of a network is for kernels/tpn.inc; part of the program's text, and of device/tpn.c.
enum {
  TPN_ITEMS = 64,
  TPN_PAIRS = 32,
  TPN_ROOM = 368,
  TPN_STEP = 12
};                                            // TPN_ROOM: rows of the group's memory
enum { TPN_LINEAR, TPN_POOL, TPN_POOL_WITH }; // kinds of steps
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
  STEP_COLUMNS, // groups of TPN_PAIRS in a row of the output
  STEP_PARTS    // that a pool joins
};
