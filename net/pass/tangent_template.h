// SPDX-License-Identifier: Apache-2.0
// y (count, output_count) and yt (count, tangents, output_count) from x (count, input_count) and directions
// xt (count, tangents, input_count). At most work->def.tangent_count tangents.
void NET_NAME(net_tangent_eval)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                int tangents, const NET_REAL *x, const NET_REAL *xt, NET_REAL *y,
                                NET_REAL *yt);

// For the scalar f = Σ_o c_o y_o of each sample, c (count, output_count): y, yt as above, gx (count,
// input_count) = ∇f, and second (count, tangents, tangents) = f″[t, u]. With the unit vectors for directions
// that is the Hessian; with the columns of a Jacobian J it is Jᵀ ∇²f J. Any of y, yt, gx may be NULL.
//
// Only activations bend a network, so f″[t, u] = Σ_activations σ″(z) ā ż_t ż_u: one forward pass of all
// directions, one backward pass of values, no derivative of a derivative. ReLU and max add nothing: the
// Hessian of a ReLU network is 0 wherever it exists.
void NET_NAME(net_tangent_second)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                  int tangents, const NET_REAL *x, const NET_REAL *xt, const NET_REAL *c,
                                  NET_REAL *y, NET_REAL *yt, NET_REAL *gx, NET_REAL *second);
