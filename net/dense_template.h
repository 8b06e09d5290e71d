// SPDX-License-Identifier: Apache-2.0
// y (output_count, NET_COLUMN_UNIT), the first so many outputs, of x (input_count, NET_COLUMN_UNIT) and,
// unless NULL, gx = dy/dx of the first output, laid out as x. x, gx and y begin on a cache line. Uses the
// memory of the work's first thread.
void NET_NAME(net_dense_eval)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int output_count,
                              const NET_REAL *x, NET_REAL *y, NET_REAL *gx);

// Second derivatives of the first output along pairs (t, u), u ≤ t, of `tangents` directions, at most the
// work's: second (pairs, NET_COLUMN_UNIT), pair (t, u) in row t (t + 1)/2 + u. x holds the inputs and their
// tangents (input_count, 1 + tangents, NET_COLUMN_UNIT). Both begin on a cache line.
void NET_NAME(net_dense_second)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int tangents,
                                const NET_REAL *x, NET_REAL *second);
