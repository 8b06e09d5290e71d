// SPDX-License-Identifier: Apache-2.0
typedef struct NET_NAME(NetWork) {
  NetWorkDef def;
  uint64_t outputs;                   // those that net_forward_* computes, a bit for each; all to begin with
  const NetPlan *plan;                // borrowed; the model of every call has an equal one
  const NET_NAME(NetKernel) * kernel; // static
  size_t value_size, gradient_size;   // elements of one chunk
  int kept_chunks;                    // chunks of a batch
  NET_REAL *values;                   // (max(kept_chunks, thread_count), value_size)
  NET_REAL *gradients;                // (thread_count, gradient_size)
  NET_REAL *lanes;                    // (NET_LANES, parameter_count), where a batch is kept
  NET_REAL *seconds;                  // (thread_count, pairs of tangents, samples of a chunk)
} NET_NAME(NetWork);

// NET_BAD_ARGUMENT for a definition that cannot be or a kernel this processor lacks. A zeroed work can be
// destroyed.
NetStatus NET_NAME(net_work_create)(const NetPlan *plan, const NetWorkDef *def, NET_NAME(NetWork) * work);
void NET_NAME(net_work_destroy)(NET_NAME(NetWork) * work);
