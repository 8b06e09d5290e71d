// SPDX-License-Identifier: Apache-2.0
typedef struct NET_NAME(NetAdam) {
  NetAdamDef def;
  size_t count;    // parameters
  int64_t step;    // steps taken
  NET_REAL *first; // moments (count), owned
  NET_REAL *second;
} NET_NAME(NetAdam);

NetStatus NET_NAME(net_adam_create)(size_t count, const NetAdamDef *def, NET_NAME(NetAdam) * adam);
void NET_NAME(net_adam_destroy)(NET_NAME(NetAdam) * adam);

// One step at learning rate `rate`: parameters ← (1 − rate · decay) parameters − rate · m̂ / (√v̂ + ε).
void NET_NAME(net_adam_step)(NET_NAME(NetAdam) * adam, double rate, const NET_REAL *gradient,
                             NET_REAL *parameters);

// Scales the gradient to norm `limit` where it is longer; returns the norm it had. Where that is not finite,
// nothing is changed and no step should be taken.
double NET_NAME(net_adam_clip)(size_t count, double limit, NET_REAL *gradient);
