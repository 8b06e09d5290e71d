// SPDX-License-Identifier: GPL-3.0-or-later
// An estimate of the error of contact for each pair of bodies, at the state in which the two pressed each
// other most: P = ∫ p dA = Σ |F_ij|, which a shaft in a hole has even where the resultant is none.
//
// give    The interface is a spring in series with the bodies: with the potential U of the pair and the
//         elastic energies E_a, E_b of the two (0 of an obstacle), each of them ½ force · displacement,
//
//           give = U / (U + E_a + E_b)
//
//         is the interface's share of the displacement. Under a prescribed displacement the force is too
//         small by that share; under a prescribed force the displacement is too large by it. U is
//         proportional to 1/c, so the stiffness that brings it to 1 % is c · 99 give / (1 − give).
// rim     Near an edge of a body the nearest surface is its side, and material there is pushed sideways:
//         the share of the force that is lost by that at this depth. With F_k the forces of an element's
//         pairs, w_k and g_k their weights and slopes (contact/pressure/field.h), n = Σ F_k / |Σ F_k|,
//
//           rim = Σ [ c (w_i |g_B| + w_j |g_A|) − F_k · n ] / Σ F_k · n.
//
//         It is proportional to the depth, so to 1/c.
// depth   D = 2 U / P, the mean depth of the overlap, over the mean edge of the elements that take part:
//         how thick the layer of contact is in elements.
// known   the position tolerance of a time step over D: by how much the depth is undetermined in one step
//         of a motion. Forces at rest are balanced more closely than that (docs/time.md).
// across  √area over that edge: how many elements resolve the patch.
// held    the largest P that two accepted steps in a row have: a peak that lasts one step of a motion is far
//         above it.
#ifndef TETLAP_FEM_MEASURE_ACCURACY_H
#define TETLAP_FEM_MEASURE_ACCURACY_H

#include "base/files/record.h"
#include "contact/system.h"
#include "fem/effect/system.h"

// Of one interface. An impact compresses the interface before the body behind it, so `give` is that of the
// state in which U + E_a + E_b was largest. Numbers only, for checkpoints.
typedef struct FemAccuracyPair {
  double force;      // the largest resultant so far [N]
  double force_time; // when that was [s]
  double pressed;    // the largest P so far; 0: the two never touched [N]
  double time;       // when that was [s]
  double resultant;  // at that time [N]
  double area;       // about that time, as what follows from `estimated` on [m²]
  double centre[3];  // of pressure, at that time [m]
  double held;       // the largest P that two accepted steps in a row had [N]
  double last, seen; // P of the last accepted state [N], and its time [s]
  double estimated;  // P of the state that the area and the numbers below are of: 0.99 `pressed` at least [N]
  double energy;     // U there [J]
  double elastic[2]; // E_a, E_b of the state in which most was stored [J]
  double with;       // U of that state [J]
  double stored;     // U + E_a + E_b of that state [J]
  double full_time;  // when that was [s]
  double edge;       // mean edge of the elements that take part [m]
  double rim;        // NaN: the potential is not `field`
} FemAccuracyPair;
enum { FEM_ACCURACY_KEPT = 21 };

typedef struct FemAccuracy {
  int count;
  FemAccuracyPair *pairs; // by interfaces                                 (count)
  FemAccuracyPair *found; // what would replace some of them              (found_count)
  int *places;            // the interfaces of those                      (found_count)
  double *pressed;        // P of the state under trial [N]               (count)
  double *forces;         // resultants of it [N]                         (count)
  double time;            // of it [s]
  int found_count;
  double *energies;  // scratch: of bodies                                (body_count)
  bool has_energies; // whether they are of the state under trial
} FemAccuracy;

// A zeroed one, and one whose creation failed, can be destroyed. `contact` NULL: nothing to estimate.
Status fem_accuracy_create(FemAccuracy *accuracy, const FemModel *model, const ContactSystem *contact);
void fem_accuracy_destroy(FemAccuracy *accuracy);

// Finds pairs that press more than ever before at a state, of which contact's evaluation is; `elastic`: the
// elastic energy of all bodies [J].
Status fem_accuracy_look(FemAccuracy *accuracy, const FemSystem *system, const ContactLayout *layout,
                         const ContactEvaluation *evaluation, const FemState *state, double elastic);
// The state that was looked at is accepted.
void fem_accuracy_accept(FemAccuracy *accuracy);

// What follows for one pair.
typedef struct FemEstimate {
  double give, rim, depth_over_edge, tolerance_over_depth, elements_across; // NaN: not known
  double give_time;                                                         // when it was so [s]
  double depth;                                                             // D [m]
  double stiffness;                                                         // c or κ of the pair
  double stiffness_for; // that would bring give and rim to 1 %; NaN: none would, or the depth is no more
                        // than a step of a motion can tell
  double tolerance_for; // time.tolerance that would bring tolerance_over_depth there; NaN: static
  bool is_brief;        // the largest P lasts one step of a motion
} FemEstimate;
FemEstimate fem_accuracy_estimate(const FemAccuracyPair *pair, const FemModel *model, double stiffness);

#endif
