// SPDX-License-Identifier: Apache-2.0
// TetrahedronPairNet's loss, ½ BCE(logits) + ½ √mean (log1p(max(0, v)) − log1p(target))², from y (count, 2) =
// (logit, v), labels (count) 0 or 1 and targets (count) ≥ 0 in the unit that v has; gy (count, 2) is its
// derivative (0 for v < 0, as ReLU has it, and for the root where every prediction is exact).
NetLossPaper NET_NAME(net_loss_paper)(int count, const NET_REAL *y, const NET_REAL *labels,
                                      const NET_REAL *targets, NET_REAL *gy);

// The Sobolev-log loss, mean over samples of Huber(y − target) + mean over tangents of Huber(scale (yt −
// target_t)): y, target, scale (count), yt and target_t (count, tangents); scale is V/|∇V|, which makes the
// second term dimensionless. gy and gyt are laid out as y and yt.
double NET_NAME(net_loss_sobolev)(int count, int tangents, double delta, const NET_REAL *y,
                                  const NET_REAL *yt, const NET_REAL *target, const NET_REAL *target_t,
                                  const NET_REAL *scale, NET_REAL *gy, NET_REAL *gyt);
