// SPDX-License-Identifier: Apache-2.0
// The processor that this runs on, for manifests and benchmarks.
#ifndef TETLAP_BASE_MACHINE_CPU_H
#define TETLAP_BASE_MACHINE_CPU_H

#include <stdbool.h>

// The model name as the system gives it, "unknown" if it does not.
const char *cpu_name(void);
bool cpu_has_avx2(void);    // AVX2 and FMA
bool cpu_has_avx512(void);  // AVX-512 F, DQ, VL
int cpu_thread_count(void); // threads that OpenMP would use

#endif
