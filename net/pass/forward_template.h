// SPDX-License-Identifier: Apache-2.0
// y (count, output_count) from x (count, input_count).
void NET_NAME(net_forward_eval)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                const NET_REAL *x, NET_REAL *y);

// y (NULL: not wanted) and gx (count, input_count), the derivative of Σ_o c_o y_o with respect to the
// sample's input, c (count, output_count): dV/dinput with c = (0, 1).
void NET_NAME(net_forward_gradient)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                    const NET_REAL *x, const NET_REAL *c, NET_REAL *y, NET_REAL *gx);

// As net_forward_gradient, where c depends on y: once y is known, `weigh` fills c, memory of the caller's. At
// most NET_CHUNK_COLUMNS samples, in the calling thread.
void NET_NAME(net_forward_pull)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                const NET_REAL *x, void (*weigh)(void *self, const NET_REAL *y, NET_REAL *c),
                                void *self, NET_REAL *y, NET_REAL *c, NET_REAL *gx);
