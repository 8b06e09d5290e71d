// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/draw/sampler.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "datagen/draw/scene_pairs.h"
#include "datagen/draw/touch.h"
#include "overlap/clip/clip.h"
#include "overlap/separation.h"

static void draw_tet(Random *random, double tet[12]) {
  for (int i = 0; i < 12; i++) tet[i] = random_uniform(random);
}

static double volume_of(const double tet[12]) {
  return fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6;
}

// Of the box that is common to both bounding boxes; 0 if there is none.
static double common_box(const double pair[24]) {
  double volume = 1;
  for (int c = 0; c < 3; c++) {
    double low[2], high[2];
    for (int t = 0; t < 2; t++) {
      const double *x = pair + 12 * t + c;
      low[t] = fmin(fmin(x[0], x[3]), fmin(x[6], x[9]));
      high[t] = fmax(fmax(x[0], x[3]), fmax(x[6], x[9]));
    }
    double length = fmin(high[0], high[1]) - fmax(low[0], low[1]);
    if (!(length > 0)) return 0;
    volume *= length;
  }
  return volume;
}

// The candidate is dropped as soon as its volume must be too small for u < a(V). That changes nothing but
// time: it would be dropped in the end.
static bool try_volumetric(const DatagenVolumeSieve *sieve, Random *random, double pair[24]) {
  const double u = random_uniform(random), floor = datagen_volume_law_sieve_floor(sieve, u);
  draw_tet(random, pair);
  if (!(volume_of(pair) >= floor)) return false;
  draw_tet(random, pair + 12);
  if (!(volume_of(pair + 12) >= floor && common_box(pair) > floor)) return false;
  if (overlap_separation_is_certain(pair)) return false;
  double volume;
  unsigned flags;
  if (overlap_clip_ops.eval_pair(NULL, pair, &(OverlapAnswer){.volume = &volume, .flags = &flags}) !=
      STATUS_OK)
    return false;
  return volume > 0 && u < datagen_volume_law_sieve_keeps(sieve, volume);
}

static bool try_kind(DatagenKind kind, const DatagenVolumeSieve *sieve, Random *random, double pair[24]) {
  switch (kind) {
  case DATAGEN_NONE:
    draw_tet(random, pair);
    draw_tet(random, pair + 12);
    return true;
  case DATAGEN_VOLUMETRIC:
    return try_volumetric(sieve, random, pair);
  case DATAGEN_SCENE:
  case DATAGEN_SCENE_NONE:
    return datagen_scene_pairs_try(random, pair);
  default:
    return datagen_touch_try(kind, random, pair);
  }
}

static void exchange(double *a, double *b, int count) {
  for (int i = 0; i < count; i++) {
    double x = a[i];
    a[i] = b[i], b[i] = x;
  }
}

// Fisher and Yates.
static void shuffle_vertices(Random *random, double tet[12]) {
  for (int v = 3; v > 0; v--) {
    int other = random_below(random, v + 1);
    if (other != v) exchange(tet + 3 * v, tet + 3 * other, 3);
  }
}

DatagenSample datagen_sampler_draw(DatagenKind kind, const DatagenVolumeSieve *sieve, double swap_share,
                                   Random *random) {
  DatagenSample sample;
  memset(&sample, 0, sizeof sample);
  do {
    sample.attempts++;
    if (!try_kind(kind, sieve, random, sample.pair)) continue;
    sample.proof = datagen_proof_of(sample.pair);
    if (datagen_proof_confirms(&sample.proof, kind)) break;
  } while (true);
  shuffle_vertices(random, sample.pair);
  shuffle_vertices(random, sample.pair + 12);
  if (random_uniform(random) < swap_share) exchange(sample.pair, sample.pair + 12, 12);
  return sample;
}
