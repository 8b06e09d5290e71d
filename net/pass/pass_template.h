// SPDX-License-Identifier: Apache-2.0
// Arrays of callers begin at the chunk's first sample: inputs (count, input_count), outputs (count,
// output_count), tangents (count, tangents, …). Derivatives are laid out as what they belong to.
typedef struct NET_NAME(NetPass) {
  const NetPlan *plan;
  const NET_NAME(NetKernel) * kernel;
  const NET_REAL *parameters;
  int count;             // samples
  int n;                 // columns of a part: count, rounded up. What is beyond repeats the last sample.
  int tangents;          // forward
  int gradient_tangents; // backward: 0 or tangents
  NET_REAL *values;      // slots
  NET_REAL *gradients;   // derivatives of slots
  NET_REAL *parameter_gradient; // added to; NULL: not wanted
  uint64_t outputs;             // those to be computed, a bit for each; the others are 0
  bool wants_input;             // backward down to the input
} NET_NAME(NetPass);

// A pass over the samples of chunk `index` of `count` in all, in memory number `place` and thread number
// `thread`.
NET_NAME(NetPass)
NET_NAME(net_pass_begin)
(const NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count, int tangents, int index,
 int place, int thread);

// Inputs (and tangents, NULL where there are none) into the slots, all steps, outputs (NULL: not wanted) out
// of them.
void NET_NAME(net_pass_forward)(const NET_NAME(NetPass) * pass, const NET_REAL *x, const NET_REAL *xt,
                                NET_REAL *y, NET_REAL *yt);

// From derivatives with respect to outputs and their tangents (NULL: 0) to those of everything before.
void NET_NAME(net_pass_backward)(const NET_NAME(NetPass) * pass, const NET_REAL *gy, const NET_REAL *gyt);

// The derivative with respect to the inputs, after a backward pass that wants it.
void NET_NAME(net_pass_input_gradient)(const NET_NAME(NetPass) * pass, NET_REAL *gx);

// After a forward pass: of the first sample, a slot's rows of part 0.
void NET_NAME(net_pass_features)(const NET_NAME(NetPass) * pass, int slot, NET_REAL *features);

// After a backward pass of values: Σ over activations f″ ā ż_t ż_u, (count, tangents, tangents). `sums` is
// scratch.
void NET_NAME(net_pass_second)(const NET_NAME(NetPass) * pass, NET_REAL *sums, NET_REAL *second);
