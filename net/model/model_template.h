// SPDX-License-Identifier: Apache-2.0
typedef struct NET_NAME(NetModel) {
  NetPlan *plan;        // owned
  NET_REAL *parameters; // (plan->parameter_count), tensors one after another; owned
} NET_NAME(NetModel);

// Parameters are 0. Destroy it; a zeroed model can be destroyed.
NetStatus NET_NAME(net_model_create)(const NetShape *shape, NET_NAME(NetModel) * model);
void NET_NAME(net_model_destroy)(NET_NAME(NetModel) * model);

// He et al.'s uniform weights, zero biases. The same numbers, rounded, in either precision.
void NET_NAME(net_model_initialise)(NET_NAME(NetModel) * model, uint64_t seed);

// A tensor's elements, borrowed; NULL if there is none of that name.
NET_REAL *NET_NAME(net_model_tensor)(const NET_NAME(NetModel) * model, const char *name);
