// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/stress/pairs/traits.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "datagen/draw/proof.h"
#include "overlap/exact/exact.h"
#include "overlap/pair/invariant.h"

enum { ANY = -1, EMPTY = -1, POINT, SEGMENT, AREA, BODY };

typedef struct Trait {
  const char *name;
  int least, most;   // dimension of the intersection
  int first, second; // smallest faces that hold it, either way round; ANY
  bool (*holds)(const DatagenHardPair *pair);
} Trait;

static bool boxes_overlap(const DatagenHardPair *pair) {
  for (int c = 0; c < 3; c++) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 8; i++) {
      low[i / 4] = fmin(low[i / 4], pair->x[3 * i + c]);
      high[i / 4] = fmax(high[i / 4], pair->x[3 * i + c]);
    }
    if (!(low[0] < high[1] && low[1] < high[0])) return false;
  }
  return true;
}
static bool boxes_are_apart(const DatagenHardPair *pair) {
  return !boxes_overlap(pair);
}

static double determinant(const DatagenHardPair *pair, int a, int b, int c, int d) {
  return vec3_det4(datagen_hard_vertex(pair, a), datagen_hard_vertex(pair, b), datagen_hard_vertex(pair, c),
                   datagen_hard_vertex(pair, d));
}

// Faces (0, 1, 2) and (4, 5, 6) in one plane, but for the rounding of a rotation.
static bool faces_are_coplanar(const DatagenHardPair *pair) {
  for (int i = 4; i < 7; i++)
    if (!(fabs(determinant(pair, 0, 1, 2, i)) <= 64 * DBL_EPSILON)) return false;
  return true;
}
static bool apexes_agree(const DatagenHardPair *pair) {
  return faces_are_coplanar(pair) && determinant(pair, 0, 1, 2, 3) * determinant(pair, 0, 1, 2, 7) > 0;
}
static bool apexes_oppose(const DatagenHardPair *pair) {
  return faces_are_coplanar(pair) && determinant(pair, 0, 1, 2, 3) * determinant(pair, 0, 1, 2, 7) < 0;
}

static int shared_vertices(const DatagenHardPair *pair) {
  int count = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 4; j < 8; j++) count += memcmp(pair->x + 3 * i, pair->x + 3 * j, 3 * sizeof(double)) == 0;
  return count;
}
static bool shares_one(const DatagenHardPair *pair) {
  return shared_vertices(pair) == 1;
}
static bool shares_two(const DatagenHardPair *pair) {
  return shared_vertices(pair) == 2;
}
static bool shares_three(const DatagenHardPair *pair) {
  return shared_vertices(pair) == 3;
}
static bool shares_all(const DatagenHardPair *pair) {
  return shared_vertices(pair) == 4;
}
static bool is_nearly_the_same(const DatagenHardPair *pair) {
  double both = overlap_invariant_tet_volume(pair->x + 12);
  return shared_vertices(pair) < 4 && fabs(overlap_invariant_tet_volume(pair->x) - both) <= 1e-12 * both;
}

static bool is_enclosed(const DatagenHardPair *pair) {
  double volume;
  unsigned flags;
  return overlap_exact_ops.eval_pair(NULL, pair->x, &(OverlapAnswer){.volume = &volume, .flags = &flags}) ==
             STATUS_OK &&
         fabs(volume - overlap_invariant_tet_volume(pair->x + 12)) <= 1e-9 * volume;
}
static bool is_shallow(const DatagenHardPair *pair) {
  double volume;
  unsigned flags;
  return overlap_exact_ops.eval_pair(NULL, pair->x, &(OverlapAnswer){.volume = &volume, .flags = &flags}) ==
             STATUS_OK &&
         volume < 0.5 * overlap_invariant_smaller_volume(pair->x);
}

static bool is_thin(const double tet[12]) {
  return fabs(overlap_invariant_tet_volume(tet) - 5e-13) <= 6e-13;
}
static bool one_is_thin(const DatagenHardPair *pair) {
  return is_thin(pair->x) && overlap_invariant_tet_volume(pair->x + 12) >= 1e-2;
}
static bool both_are_thin(const DatagenHardPair *pair) {
  return is_thin(pair->x) && is_thin(pair->x + 12);
}
static bool is_far_from_the_origin(const DatagenHardPair *pair) {
  return fabs(pair->x[0]) > 9e5 && overlap_invariant_extent(pair->x) < 2;
}
static bool is_tiny(const DatagenHardPair *pair) {
  return overlap_invariant_extent(pair->x) < 2e-9;
}
static bool is_huge(const DatagenHardPair *pair) {
  return overlap_invariant_extent(pair->x) > 2e8;
}
static bool is_inside_out(const DatagenHardPair *pair) {
  return determinant(pair, 0, 1, 2, 3) < 0 || determinant(pair, 4, 5, 6, 7) < 0;
}

// Nothing in common but what rounding gave.
static bool barely_touches(const DatagenHardPair *pair) {
  double volume;
  unsigned flags;
  return overlap_exact_ops.eval_pair(NULL, pair->x, &(OverlapAnswer){.volume = &volume, .flags = &flags}) ==
             STATUS_OK &&
         volume < 1e-14;
}
static bool one_is_small(const DatagenHardPair *pair) {
  return overlap_invariant_tet_volume(pair->x + 12) < 0.5 * overlap_invariant_tet_volume(pair->x);
}

static const Trait traits[] = {
    {"far", EMPTY, EMPTY, ANY, ANY, boxes_are_apart},
    {"boxes", EMPTY, EMPTY, ANY, ANY, boxes_overlap},
    {"uniform", EMPTY, BODY, ANY, ANY, NULL},
    {"wild", EMPTY, BODY, ANY, ANY, NULL},
    {"shallow", BODY, BODY, ANY, ANY, is_shallow},
    {"vertex on face", POINT, POINT, AREA, POINT, NULL},
    {"edge on face", SEGMENT, SEGMENT, AREA, SEGMENT, NULL},
    {"face on face", AREA, AREA, AREA, AREA, NULL},
    {"vertex on vertex", POINT, POINT, POINT, POINT, NULL},
    {"vertex on edge", POINT, POINT, SEGMENT, POINT, NULL},
    {"edge on edge", POINT, POINT, SEGMENT, SEGMENT, NULL},
    {"shared edge", SEGMENT, SEGMENT, SEGMENT, SEGMENT, shares_two},
    {"shared face", AREA, AREA, AREA, AREA, shares_three},
    {"shared vertex, overlapping", POINT, BODY, ANY, ANY, shares_one},
    {"shared edge, overlapping", SEGMENT, BODY, ANY, ANY, shares_two},
    {"shared face, overlapping", AREA, BODY, ANY, ANY, shares_three},
    {"coplanar, same side, axis", EMPTY, BODY, ANY, ANY, apexes_agree},
    {"coplanar, same side, tilted", EMPTY, BODY, ANY, ANY, apexes_agree},
    {"coplanar, same side, rotated", EMPTY, BODY, ANY, ANY, apexes_agree},
    {"coplanar, opposite, axis", EMPTY, AREA, ANY, ANY, apexes_oppose},
    {"coplanar, opposite, tilted", EMPTY, AREA, ANY, ANY, apexes_oppose},
    {"coplanar, opposite, rotated", EMPTY, BODY, ANY, ANY, apexes_oppose},
    {"identical", BODY, BODY, ANY, ANY, shares_all},
    {"identical but a few ulp", BODY, BODY, ANY, ANY, is_nearly_the_same},
    {"inside", BODY, BODY, ANY, ANY, is_enclosed},
    {"inside, touching", BODY, BODY, ANY, ANY, is_enclosed},
    {"sliver and fat", EMPTY, BODY, ANY, ANY, one_is_thin},
    {"sliver and sliver", EMPTY, BODY, ANY, ANY, both_are_thin},
    {"offset 1e6", EMPTY, BODY, ANY, ANY, is_far_from_the_origin},
    {"scale 1e-9", EMPTY, BODY, ANY, ANY, is_tiny},
    {"scale 1e9", EMPTY, BODY, ANY, ANY, is_huge},
    {"touching, moved", EMPTY, BODY, ANY, ANY, barely_touches},
    {"small through a face", BODY, BODY, ANY, ANY, one_is_small},
    {"mesh cells", BODY, BODY, ANY, ANY, NULL},
    {"inverted", EMPTY, BODY, ANY, ANY, is_inside_out},
};

static const Trait *find(const char *name) {
  for (size_t t = 0; t < sizeof traits / sizeof *traits; t++)
    if (strcmp(traits[t].name, name) == 0) return &traits[t];
  return NULL;
}

static bool lies_on(const DatagenProof *proof, const Trait *trait) {
  if (trait->first == ANY) return true;
  int a = proof->carrier[0], b = proof->carrier[1];
  return (a == trait->first && b == trait->second) || (a == trait->second && b == trait->first);
}

bool app_stress_traits_hold(int class_index, const DatagenHardPair *pair) {
  const char *name = datagen_hard_classes[class_index].name;
  const Trait *trait = find(name);
  DatagenProof proof = datagen_proof_of(pair->x);
  if (!trait) return strcmp(name, "flat") == 0 && proof.is_flat;
  return !proof.is_flat && proof.dimension >= trait->least && proof.dimension <= trait->most &&
         lies_on(&proof, trait) && (!trait->holds || trait->holds(pair));
}
