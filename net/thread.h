// SPDX-License-Identifier: Apache-2.0
// The number of the calling OpenMP thread, 0 without OpenMP. Private to net/.
#ifndef NET_THREAD_H
#define NET_THREAD_H

#ifdef _OPENMP
#include <omp.h>
static inline int net_thread_index(void) {
  return omp_get_thread_num();
}
#else
static inline int net_thread_index(void) {
  return 0;
}
#endif

#endif
