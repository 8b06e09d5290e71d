// SPDX-License-Identifier: Apache-2.0
// The way of many pairs through `geo`, side by side in vector lanes: what gate.h, centre.h, frame.h and
// features/features.h do for one. That scalar form serves training and pairs with coplanar faces, and tests
// hold every instruction set against it: a change to one form is a change to both.
//
//   pairs ─ gate ─► those that intersect, moved together ─ frame ─► P ─► features ─► ρ ─ pull ─► ∇ log V
//                   (OverlapGeoBundle)                    blocks of OVERLAP_GEO_BLOCK columns
//
// for the centroid `centroid`, and for second derivatives `bend`, the network's curvature, and `finish`
// (OverlapGeoBends).
//
// A pair's numbers do not depend on the lane it is in nor on its neighbours. Every instruction set takes the
// gate's decisions to the same bits, the scalar form's; what follows differs by rounding, for multiplications
// and additions are fused where the processor can.
#ifndef TETLAP_OVERLAP_GEO_BUNDLE_BUNDLE_H
#define TETLAP_OVERLAP_GEO_BUNDLE_BUNDLE_H

#include "overlap/geo/features/features.h"
#include "overlap/geo/gate.h"

enum {
  OVERLAP_GEO_BUNDLE = 128,    // pairs that are taken at once
  OVERLAP_GEO_BLOCK = 16,      // columns of features that a network is given at once
  OVERLAP_GEO_DIRECTIONS = 12, // along which second derivatives are found: overlap/geo/hessian.h
  OVERLAP_GEO_DIRECTION_PAIRS = OVERLAP_GEO_DIRECTIONS * (OVERLAP_GEO_DIRECTIONS + 1) / 2,
  OVERLAP_GEO_BUNDLE_ROW = OVERLAP_GEO_BUNDLE + OVERLAP_GEO_BLOCK + GEO_LANES, // and a pack beyond
};

// A number of each of the pairs that intersect.
typedef double OverlapGeoRow[OVERLAP_GEO_BUNDLE_ROW];

typedef struct OverlapGeoBundle {
  bool has_across; // given to the gate: derivatives and what is blended with them need `across`
  int count;
  int pair[OVERLAP_GEO_BUNDLE];                  // which of those given
  bool is_enclosed[OVERLAP_GEO_BUNDLE];          // as in OverlapGeoGate
  OverlapGeoRow normal[3 * GEO_LANES];           // ∇s_k [1/m], component c of plane k in row 8 c + k
  OverlapGeoRow least_volume;                    // of the two tetrahedra [m³]
  OverlapGeoRow slack[GEO_LANES];                // at a point inside
  OverlapGeoRow across[2 * 4 * 4];               // [t][v][k]: coordinate k, in the other, of vertex v of t
  OverlapGeoOutcome outcome[OVERLAP_GEO_BUNDLE]; // of every pair given
} OverlapGeoBundle;

typedef double OverlapGeoColumn[OVERLAP_GEO_BLOCK];

// The frames of a block's columns; those beyond the last pair repeat it.
typedef struct OverlapGeoBlock {
  _Alignas(64) OverlapGeoColumn slack[GEO_LANES]; // s_k at the centre
  OverlapGeoColumn scaled[3 * GEO_LANES];         // m, component c of plane k in row 8 c + k
  OverlapGeoColumn basis[3 * GEO_LANES];          // Q, likewise by column
  OverlapGeoColumn projector[GEO_ENTRIES];        // P, entries as in GeoSymmetric
  // In packs of the kernel's width.
  OverlapGeoColumn invariants[sizeof(OverlapGeoInvariants) / sizeof(GeoPack)];
  OverlapGeoColumn volume;   // V₀ [m³]
  OverlapGeoColumn is_fit;   // 1; or 0: the scalar form must say what is wrong
  OverlapGeoColumn is_close; // 1: coplanar faces give the exact volume a share (overlap/geo/coplanar.h)
  OverlapGeoColumn features[OVERLAP_GEO_MAX_FEATURES];
  OverlapGeoColumn weights[OVERLAP_GEO_MAX_FEATURES]; // dρ/df, from the network
  OverlapGeoColumn factor;                            // what `pull` multiplies with
  // From the network: ρ, and the coefficients of the planes' features.
  OverlapGeoColumn outputs[1 + OVERLAP_GEO_MAX_PLANE_FEATURES];
  OverlapGeoColumn place[GEO_LANES];      // s_k at the centroid
  double gradient[OVERLAP_GEO_BLOCK][24]; // factor · ∂ log V/∂x
} OverlapGeoBlock;

// Second derivatives of a block's columns. The vertices of one tetrahedron of each pair are moved: what
// belongs to it comes first.
typedef struct OverlapGeoBends {
  _Alignas(64) OverlapGeoColumn features[OVERLAP_GEO_MAX_FEATURES][1 + OVERLAP_GEO_DIRECTIONS]; // and changes
  // Second derivatives of φ along pairs (t, u), u ≤ t, of directions, in row t (t + 1)/2 + u. `bend` gives
  // those at fixed dρ/df.
  OverlapGeoColumn curvature[OVERLAP_GEO_DIRECTION_PAIRS];
  OverlapGeoColumn column[OVERLAP_GEO_DIRECTIONS][24]; // of ∇² log V, but for the curvature
  OverlapGeoColumn gradient[24];                       // ∂ log V/∂x
  OverlapGeoColumn across[4 * 4];                      // of the moved vertices in the other
  OverlapGeoColumn normal[4 * 3];                      // ∇λ_b of the other
  OverlapGeoColumn is_second;                          // 1: the second tetrahedron is moved; 0: the first
  double hessian[OVERLAP_GEO_BLOCK][24 * 24];          // factor (∇² log V + ∇ log V ∇ log Vᵀ)
} OverlapGeoBends;

typedef struct OverlapGeoBundleKernel {
  const char *name;
  // The gate for pairs (count, 24), at most OVERLAP_GEO_BUNDLE.
  void (*gate)(int count, const double *pairs, OverlapGeoBundle *bundle);
  // Centre and frame of the bundle's pairs from `first` on.
  void (*frame)(OverlapGeoBundle *bundle, int first, OverlapGeoBlock *block);
  // block->features of block->projector.
  void (*features)(const OverlapGeoFeatureSet *set, OverlapGeoBlock *block);
  // block->place from block->outputs, after `features`.
  void (*centroid)(const OverlapGeoFeatureSet *set, OverlapGeoBlock *block);
  // block->gradient from block->weights and block->factor, after `features`; `set` NULL: φ is constant.
  void (*pull)(const OverlapGeoFeatureSet *set, OverlapGeoBlock *block);
  // All of bends but the Hessian, after `features`; the block holds the bundle's pairs from `first` on.
  void (*bend)(const OverlapGeoFeatureSet *set, const OverlapGeoBundle *bundle, int first,
               OverlapGeoBlock *block, OverlapGeoBends *bends);
  // bends->hessian, once the network's part is added to the curvature; without: φ is constant.
  void (*finish)(bool has_curvature, const OverlapGeoBlock *block, OverlapGeoBends *bends);
} OverlapGeoBundleKernel;

// The fastest that this processor has.
const OverlapGeoBundleKernel *overlap_geo_bundle_kernel(void);
// All that it has, the portable one first.
const OverlapGeoBundleKernel *const *overlap_geo_bundle_kernels(int *count);

// Of each instruction set.
void overlap_geo_bundle_gate_portable(int count, const double *pairs, OverlapGeoBundle *bundle);
extern const OverlapGeoBundleKernel overlap_geo_bundle_kernel_portable;
#if defined(__x86_64__)
void overlap_geo_bundle_gate_avx2(int count, const double *pairs, OverlapGeoBundle *bundle);
void overlap_geo_bundle_gate_avx512(int count, const double *pairs, OverlapGeoBundle *bundle);
extern const OverlapGeoBundleKernel overlap_geo_bundle_kernel_avx2;
extern const OverlapGeoBundleKernel overlap_geo_bundle_kernel_avx512;
#endif

#endif
