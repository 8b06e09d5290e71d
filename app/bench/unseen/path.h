// SPDX-License-Identifier: GPL-3.0-or-later
// An overlap model along a closed path of two bodies in contact, compared with clipping at the same places.
#ifndef TETLAP_APP_BENCH_UNSEEN_PATH_H
#define TETLAP_APP_BENCH_UNSEEN_PATH_H

#include "app/bench/unseen/mesh.h"

// All over the whole path. NaN: nothing to measure.
typedef struct AppUnseenErrors {
  long long pairs;       // that share volume, over all places
  double volume;         // Σ|ΔV| / ΣV
  double moment;         // Σ|Δm| / Σ|m|, each with its own V
  double nodal_force;    // √Σ|Δf|² / √Σ|f|² over vertices
  double total_force;    // √Σ|ΔF|² / √Σ|F|² of the force on the upper body
  double tangential;     // the largest |ΔF_x, ΔF_y| over the largest F_z
  double normal_sum;     // √Σ(ΔN)² / √ΣN², N = Σ|F_ij| over pairs: what friction is bounded by
  double path_work;      // |∮F·dx| / ∮|F·dx|
  double path_work_clip; // the same of clipping: of the potential itself 0, what is left is the quadrature's
  double seconds, seconds_clip; // processor time of the model's volumes, and of clipping's
} AppUnseenErrors;

// `places` of the path. Both with the potential `field`.
Status app_unseen_path_measure(const AppUnseenCase *what, const AppUnseenMesh *mesh,
                               const OverlapModel *model, const OverlapModel *clip, int places,
                               AppUnseenErrors *errors);

#endif
