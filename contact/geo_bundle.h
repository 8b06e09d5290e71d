// SPDX-License-Identifier: GPL-3.0-or-later
// The way of many pairs through `geo`, side by side in vector lanes: what geo_gate.h, geo_centre.h,
// geo_frame.h and geo_features.h do for one.
//
//   pairs ─ gate ─► those that intersect, moved together ─ frame ─► P ─► features ─► ρ ─ pull ─► ∇ log V
//                   (ContactGeoBundle)                    blocks of CONTACT_GEO_BLOCK columns
//
// and for second derivatives `bend`, the network's curvature, and `finish` (ContactGeoBends).
//
// A pair's numbers do not depend on the lane it is in nor on its neighbours. Every instruction set takes the
// gate's decisions to the same bits, the scalar form's; what follows differs by rounding, for multiplications
// and additions are fused where the processor can.
#ifndef TETLAP_CONTACT_GEO_BUNDLE_H
#define TETLAP_CONTACT_GEO_BUNDLE_H

#include "contact/geo_features.h"
#include "contact/geo_gate.h"

enum {
  CONTACT_GEO_BUNDLE = 128,    // pairs that are taken at once
  CONTACT_GEO_BLOCK = 16,      // columns of features that a network is given at once
  CONTACT_GEO_DIRECTIONS = 12, // along which second derivatives are found: geo_hessian.h
  CONTACT_GEO_DIRECTION_PAIRS = CONTACT_GEO_DIRECTIONS * (CONTACT_GEO_DIRECTIONS + 1) / 2,
  CONTACT_GEO_BUNDLE_ROW = CONTACT_GEO_BUNDLE + CONTACT_GEO_BLOCK + GEO_LANES, // and a pack beyond
};

// A number of each of the pairs that intersect.
typedef double ContactGeoRow[CONTACT_GEO_BUNDLE_ROW];

typedef struct ContactGeoBundle {
  int count;
  int pair[CONTACT_GEO_BUNDLE];                  // which of those given
  bool is_enclosed[CONTACT_GEO_BUNDLE];          //
  ContactGeoRow normal[3 * GEO_LANES];           // ∇s_k [1/m], component c of plane k in row 8 c + k
  ContactGeoRow least_volume;                    // of the two tetrahedra [m³]
  ContactGeoRow slack[GEO_LANES];                // at a point inside
  ContactGeoRow across[2 * 4 * 4];               // [t][v][k]: coordinate k, in the other, of vertex v of t
  ContactGeoOutcome outcome[CONTACT_GEO_BUNDLE]; // of every pair given
} ContactGeoBundle;

typedef double ContactGeoColumn[CONTACT_GEO_BLOCK];

// The frames of a block's columns; those beyond the last pair repeat it.
typedef struct ContactGeoBlock {
  _Alignas(64) ContactGeoColumn slack[GEO_LANES]; // s_k at the centre
  ContactGeoColumn scaled[3 * GEO_LANES];         // m, component c of plane k in row 8 c + k
  ContactGeoColumn basis[3 * GEO_LANES];          // Q, likewise by column
  ContactGeoColumn projector[GEO_ENTRIES];        // P, entries as in GeoSymmetric
  ContactGeoColumn
      invariants[sizeof(ContactGeoInvariants) / sizeof(GeoPack)]; // in packs of the kernel's width
  ContactGeoColumn volume;                                        // V₀ [m³]
  ContactGeoColumn is_fit;   // 1; or 0: the scalar form must say what is wrong
  ContactGeoColumn is_close; // 1: coplanar faces give the exact volume a share (geo_coplanar.h)
  ContactGeoColumn features[CONTACT_GEO_MAX_FEATURES];
  ContactGeoColumn weights[CONTACT_GEO_MAX_FEATURES]; // dρ/df, from the network
  ContactGeoColumn factor;                            // what `pull` multiplies with
  double gradient[CONTACT_GEO_BLOCK][24];             // factor · ∂ log V/∂x
} ContactGeoBlock;

// Second derivatives of a block's columns. The vertices of one tetrahedron of each pair are moved: what
// belongs to it comes first.
typedef struct ContactGeoBends {
  _Alignas(64) ContactGeoColumn features[CONTACT_GEO_MAX_FEATURES][1 + CONTACT_GEO_DIRECTIONS]; // and changes
  // Second derivatives of φ along pairs (t, u), u ≤ t, of directions, in row t (t + 1)/2 + u. `bend` gives
  // those at fixed dρ/df.
  ContactGeoColumn curvature[CONTACT_GEO_DIRECTION_PAIRS];
  ContactGeoColumn column[CONTACT_GEO_DIRECTIONS][24]; // of ∇² log V, but for the curvature
  ContactGeoColumn gradient[24];                       // ∂ log V/∂x
  ContactGeoColumn across[4 * 4];                      // of the moved vertices in the other
  ContactGeoColumn normal[4 * 3];                      // ∇λ_b of the other
  ContactGeoColumn is_second;                          // 1: the second tetrahedron is moved; 0: the first
  double hessian[CONTACT_GEO_BLOCK][24 * 24];          // factor (∇² log V + ∇ log V ∇ log Vᵀ)
} ContactGeoBends;

typedef struct ContactGeoBundleKernel {
  const char *name;
  // The gate for pairs (count, 24), at most CONTACT_GEO_BUNDLE.
  void (*gate)(int count, const double *pairs, ContactGeoBundle *bundle);
  // Centre and frame of the bundle's pairs from `first` on.
  void (*frame)(ContactGeoBundle *bundle, int first, ContactGeoBlock *block);
  // block->features of block->projector.
  void (*features)(const ContactGeoFeatureSet *set, ContactGeoBlock *block);
  // block->gradient from block->weights and block->factor, after `features`; `set` NULL: φ is constant.
  void (*pull)(const ContactGeoFeatureSet *set, ContactGeoBlock *block);
  // All of bends but the Hessian, after `features`; the block holds the bundle's pairs from `first` on.
  void (*bend)(const ContactGeoFeatureSet *set, const ContactGeoBundle *bundle, int first,
               ContactGeoBlock *block, ContactGeoBends *bends);
  // bends->hessian, once the network's part is added to the curvature; without: φ is constant.
  void (*finish)(bool has_curvature, const ContactGeoBlock *block, ContactGeoBends *bends);
} ContactGeoBundleKernel;

// The fastest that this processor has.
const ContactGeoBundleKernel *contact_geo_bundle_kernel(void);
// All that it has, the portable one first.
const ContactGeoBundleKernel *const *contact_geo_bundle_kernels(int *count);

// Of each instruction set.
void contact_geo_bundle_gate_portable(int count, const double *pairs, ContactGeoBundle *bundle);
extern const ContactGeoBundleKernel contact_geo_bundle_kernel_portable;
#if defined(__x86_64__)
void contact_geo_bundle_gate_avx2(int count, const double *pairs, ContactGeoBundle *bundle);
void contact_geo_bundle_gate_avx512(int count, const double *pairs, ContactGeoBundle *bundle);
extern const ContactGeoBundleKernel contact_geo_bundle_kernel_avx2;
extern const ContactGeoBundleKernel contact_geo_bundle_kernel_avx512;
#endif

#endif
