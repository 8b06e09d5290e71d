// SPDX-License-Identifier: Apache-2.0
// A shape compiled: which parameters there are and which steps a pass takes over which matrices. Constant,
// and the same for float and double.
//
// Everything a pass computes lives in slots: matrices (rows, columns) with features as rows, so that samples
// are contiguous, joining features is placing rows beside each other, and pooling adds or compares whole
// rows. The columns of a slot with spread p for n samples and T tangents are
//
//     (1 + T) groups: the values, then each tangent  ×  p parts  ×  n samples
//
// and parts are (vertex a, tetrahedron t) with spread 8, (tetrahedron t) with 2, nothing with 1; where a tpn
// is folded, (vertex a) with 4. A pool over the outermost part index therefore leaves the next layout.
#ifndef NET_PLAN_H
#define NET_PLAN_H

#include <stddef.h>
#include <stdint.h>

#include "net/model/shape.h"

enum {
  NET_MAX_TENSORS = 128,
  NET_MAX_SLOTS = 128,
  NET_MAX_STEPS = 128,
  NET_MAX_VIEWS = 3,
  NET_NAME_SIZE = 32
};

// A parameter tensor, row-major in the flat parameter array. Names are PyTorch's: BLOCK.LAYER.weight, .bias.
typedef struct NetTensor {
  char name[NET_NAME_SIZE];
  int rows;      // outputs
  int columns;   // inputs; 0: a bias, one-dimensional
  size_t offset; // of its first element in the parameters
  double bound;  // initial values are uniform in ±bound
} NetTensor;

typedef struct NetSlot {
  int rows;
  int spread;
  size_t offset;          // [columns of one part]: memory begins at offset · (1 + T) · n
  size_t gradient_offset; // likewise for the derivative of the loss with respect to this slot
} NetSlot;

typedef enum NetStepKind {
  NET_STEP_LINEAR,   // output = [base +] W input + b; then ReLU where `has_relu`
  NET_STEP_ACTIVATE, // output = SiLU(input)
  NET_STEP_POOL,     // output = max or sum over the outermost parts of input
  NET_STEP_POOL_WITH // output = max or sum of input and a constant, the tensor `bias`, that comes first
} NetStepKind;

// Rows input_row … of slot `input` to rows output_row … of slot `output`, on parts part … part + part_count
// − 1.
typedef struct NetStep {
  NetStepKind kind;
  int input, input_row, input_rows;
  int output, output_row, output_rows;
  int base; // slot that a skip is added to, −1: none. Shares the derivative's memory with the output.
  int weight, bias; // tensors; bias −1: none
  int part, part_count;
  bool has_relu;
  uint64_t outputs; // a bit for each output of the network that depends on the step's
  bool reads_input; // nothing of ours made the input: its derivative is wanted only as dV/dinput
} NetStep;

// Where the input goes: rows first_row … of slot; its element of (row, part) is input[index[row · spread +
// part]].
typedef struct NetView {
  int slot, first_row, rows;
  int index[24]; // tpn; an mlp has one view, in the order of the input
} NetView;

typedef struct NetPlan {
  NetShape shape;
  int tensor_count, slot_count, step_count, view_count;
  NetTensor tensors[NET_MAX_TENSORS];
  NetSlot slots[NET_MAX_SLOTS];
  NetStep steps[NET_MAX_STEPS];
  NetView views[NET_MAX_VIEWS];
  int output_slot; // (output_count, n)
  size_t parameter_count;
  size_t value_rows;    // Σ rows · spread: elements per sample of one group of the slots
  size_t gradient_rows; // likewise of their derivatives
  double flops;         // multiplications and additions of the matrix products in one sample's output
} NetPlan;

// NET_BAD_ARGUMENT where the shape is wrong.
NetStatus net_plan_create(const NetShape *shape, NetPlan *plan);

// A tpn of two tetrahedra whose first one is the same in all samples (fold.h): the input is the second one's
// 12 coordinates, what the first one gives is a constant of the pool over tetrahedra and in the bias of the
// combiner's skip. Its shape is the given one but for the input's width and that bias.
NetStatus net_plan_create_folded(const NetShape *shape, NetPlan *plan);

// The tensor's index, −1 if there is none of that name.
int net_plan_find(const NetPlan *plan, const char *name);

static inline size_t net_plan_tensor_size(const NetTensor *tensor) {
  return (size_t)tensor->rows * (size_t)(tensor->columns ? tensor->columns : 1);
}

#endif
