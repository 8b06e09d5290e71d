// SPDX-License-Identifier: Apache-2.0
#include "overlap/clip/lanes.h"

#include <stddef.h>

#include "base/machine/cpu.h"

#if defined(__x86_64__)
// The narrower first, so that a processor has a number of the first ones.
static const OverlapClipLanes *const lists[3][4] = {
    {NULL},
    {&overlap_clip_lanes_avx2, &overlap_clip_lanes_avx2_single},
    {&overlap_clip_lanes_avx2, &overlap_clip_lanes_avx512, &overlap_clip_lanes_avx2_single,
     &overlap_clip_lanes_avx512_single},
};
#else
static const OverlapClipLanes *const lists[1][4] = {{NULL}};
#endif

static int level(void) {
  return cpu_has_avx2() ? 1 + cpu_has_avx512() : 0;
}

const OverlapClipLanes *const *overlap_clip_lanes_list(int *count) {
  *count = 2 * level();
  return lists[level()];
}

const OverlapClipLanes *overlap_clip_lanes(void) {
  int k = level();
  return k ? lists[k][k - 1] : NULL;
}

const OverlapClipLanes *overlap_clip_lanes_single(void) {
  int k = level();
  return k ? lists[k][2 * k - 1] : NULL;
}
