// SPDX-License-Identifier: Apache-2.0
// y (NET_COLUMN_UNIT) of x (input_count, NET_COLUMN_UNIT) and, unless NULL, gx = dy/dx, laid out as x. x,
// gx and y begin on a cache line. Uses the memory of the work's first thread.
void NET_NAME(net_dense_eval)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, const NET_REAL *x,
                              NET_REAL *y, NET_REAL *gx);
