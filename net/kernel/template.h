// SPDX-License-Identifier: Apache-2.0
// The part of kernel.h that depends on the precision.

// c = [ReLU] (base + bias + A B), with A (m, k), B (k, n), C (m, n). A's element (i, l) is a[i a_row + l
// a_column], one of which is 1, so a transposed A costs nothing. Base (m, n) and bias (m) may be NULL; base
// may be c.
typedef struct NET_NAME(NetProduct) {
  int m, n, k;
  const NET_REAL *a;
  ptrdiff_t a_row, a_column;
  const NET_REAL *b;
  ptrdiff_t b_row;
  const NET_REAL *base;
  ptrdiff_t base_row;
  const NET_REAL *bias;
  NET_REAL *c;
  ptrdiff_t c_row;
  bool has_relu;
  // A factor is the network's input, or what is wanted is a derivative by it: bf16 keeps to float.
  bool is_raw;
} NET_NAME(NetProduct);

// A matrix of values and tangents: `rows` rows, each 1 + tangents groups of n columns.
typedef struct NET_NAME(NetKernel) {
  void (*product)(const NET_NAME(NetProduct) * product);

  // C (m, k) += A (m, n) Bᵀ with B (k, n); rows of C follow each other.
  void (*outer)(int m, int k, int n, const NET_REAL *a, ptrdiff_t a_row, const NET_REAL *b, ptrdiff_t b_row,
                NET_REAL *c);

  // sums[i] += Σ_j a[i, j]
  void (*row_sums)(int m, int n, const NET_REAL *a, ptrdiff_t a_row, NET_REAL *sums);

  // a = SiLU(z), ȧ = SiLU′(z) ż.
  void (*silu)(int rows, int n, int tangents, const NET_REAL *z, NET_REAL *a);

  // a = SiLU(z) and, unless NULL, slope = SiLU′(z), of `count` numbers, a multiple of NET_COLUMN_UNIT.
  void (*silu_slope)(int count, const NET_REAL *z, NET_REAL *a, NET_REAL *slope);

  // b = a b, of as many.
  void (*scale)(int count, const NET_REAL *a, NET_REAL *b);

  // Tangents where the value was rectified to 0 become 0. In place; the values already are max(0, ·).
  void (*relu_tangents)(int rows, int n, int tangents, NET_REAL *a);

  // From derivatives with respect to a, ȧ those with respect to z, ż; gz may be ga. For ReLU z may be the
  // rectified value. z̄ = f′ ā + Σ_t f″ ż_t ǡ_t,  ż̄_t = f′ ǡ_t.
  void (*activation_backward)(NetActivation activation, int rows, int n, int tangents, const NET_REAL *z,
                              ptrdiff_t z_row, const NET_REAL *ga, NET_REAL *gz);

  // What SiLU adds to second derivatives: second[pair(t, u), j] += Σ over rows and parts of σ″(z) ā ż_t ż_u,
  // u ≤ t, pair (t, u) = t (t + 1)/2 + u. A group has `parts` times n columns; rows of ga are `ga_row` apart.
  void (*silu_second)(int rows, int n, int parts, int tangents, const NET_REAL *z, const NET_REAL *ga,
                      ptrdiff_t ga_row, NET_REAL *second);

  // out[j] = max or sum over parts of in[part, j], tangents follow the value that won (the first of equals).
  // `n` columns of the output's group, `parts` (2 or 4) times as many in the input's.
  void (*pool)(NetPool pool, int rows, int n, int parts, int tangents, const NET_REAL *in, NET_REAL *out);

  // Adds the derivative with respect to in, whose rows are `in_row` apart.
  void (*pool_backward)(NetPool pool, int rows, int n, int parts, int tangents, const NET_REAL *in,
                        ptrdiff_t in_row, const NET_REAL *gout, NET_REAL *gin);

  // The same of two parts, of which the first is a constant for each row.
  void (*pool_with)(NetPool pool, int rows, int n, int tangents, const NET_REAL *in, const NET_REAL *constant,
                    NET_REAL *out);
  void (*pool_with_backward)(NetPool pool, int rows, int n, int tangents, const NET_REAL *in,
                             ptrdiff_t in_row, const NET_REAL *constant, const NET_REAL *gout, NET_REAL *gin);
} NET_NAME(NetKernel);

// NULL where this processor cannot run it, or not in this precision.
const NET_NAME(NetKernel) * NET_NAME(net_kernel)(NetKernelKind kind);

extern const NET_NAME(NetKernel) NET_NAME(net_kernel_blas);
#if defined(__x86_64__)
extern const NET_NAME(NetKernel) NET_NAME(net_kernel_avx2);
extern const NET_NAME(NetKernel) NET_NAME(net_kernel_avx512);
#endif
