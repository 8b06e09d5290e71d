// SPDX-License-Identifier: Apache-2.0
// As net_tangent_eval (xt and yt NULL with 0 tangents), keeping what the backward half needs. At most
// work->def.batch samples and work->def.tangent_count tangents.
void NET_NAME(net_gradient_forward)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                    int tangents, const NET_REAL *x, const NET_REAL *xt, NET_REAL *y,
                                    NET_REAL *yt);

// From the loss's derivatives gy (count, output_count) and gyt (count, tangents, output_count), NULL for 0,
// with respect to the outputs of the last net_gradient_forward, those with respect to the parameters
// (parameter_count), overwritten. The model and count must not have changed in between.
void NET_NAME(net_gradient_backward)(NET_NAME(NetWork) * work, const NET_NAME(NetModel) * model, int count,
                                     int tangents, const NET_REAL *gy, const NET_REAL *gyt,
                                     NET_REAL *gradient);
