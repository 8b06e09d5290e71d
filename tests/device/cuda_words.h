// SPDX-License-Identifier: GPL-3.0-or-later
// What NVRTC knows of itself, for clang's front end of CUDA without NVIDIA's headers: as much as kernels use.
#define __global__ __attribute__((global))
#define __device__ __attribute__((device))
#define __shared__ __attribute__((shared))
#define __launch_bounds__(...) __attribute__((launch_bounds(__VA_ARGS__)))
#define __forceinline__ __inline__ __attribute__((always_inline))
typedef __SIZE_TYPE__ size_t;
struct uint4 {
  unsigned x, y, z, w;
} __attribute__((aligned(16)));
struct ItemNumber {
  __device__ operator unsigned() const { return __nvvm_read_ptx_sreg_tid_x(); }
};
struct GroupNumber {
  __device__ operator unsigned() const { return __nvvm_read_ptx_sreg_ctaid_x(); }
};
static __device__ const struct { ItemNumber x; } threadIdx = {};
static __device__ const struct { GroupNumber x; } blockIdx = {};
extern "C" {
__device__ double fabs(double);
__device__ double exp(double);
__device__ double log(double);
__device__ double sqrt(double);
__device__ double fmin(double, double);
__device__ double fmax(double, double);
}
#define WORD static __device__ __forceinline__
WORD double __fma_rn(double a, double b, double c) { return __nvvm_fma_rn_d(a, b, c); }
WORD float __fmaf_rn(float a, float b, float c) { return __nvvm_fma_rn_f(a, b, c); }
WORD double __dsqrt_rn(double a) { return __nvvm_sqrt_rn_d(a); }
WORD float __fsqrt_rn(float a) { return __nvvm_sqrt_rn_f(a); }
WORD int atomicAdd(int *p, int v) { return __nvvm_atom_add_gen_i(p, v); }
WORD unsigned __float_as_uint(float a) { return __nvvm_bitcast_f2i(a); }
WORD float __uint_as_float(unsigned a) { return __nvvm_bitcast_i2f(a); }
WORD double __longlong_as_double(long long a) { return __nvvm_bitcast_ll2d(a); }
#pragma clang force_cuda_host_device begin
