// SPDX-License-Identifier: GPL-3.0-or-later
// The balance of momentum: whether the forces in the output are those that moved the bodies. Of each body,
// over its coordinates that are free,
//
//   Δp = Σ m Δv,     J = ∫ (Σ contact + M g + Σ loads + Σ reactions) dt,     S = ∫ Σ |each of them| dt,
//
// by the trapezoidal rule over accepted steps; contact between two as history.csv has it
// (fem/output/forces.h), reactions are those of `fixed` and `driven`. In exact mechanics J = Δp. The gap is
// |J − Δp| over the larger of S and M times the velocity tolerance of one step; the latter is the resolution
// for a body on which almost no force acts. Within a step J, Δp and S are interpolated.
#ifndef TETLAP_FEM_MEASURE_MOMENTUM_H
#define TETLAP_FEM_MEASURE_MOMENTUM_H

#include "contact/interface.h"
#include "fem/effect/system.h"

// What has been added up until the last state, and that state.
typedef struct FemMomentumBody {
  double change[3];  // Δp [kg m/s]
  double impulse[3]; // J [N s]
  double size;       // S [N s]
  double p[3];       // [kg m/s]
  double force[3];   // [N]
  double sum;        // Σ |f| [N]
  double driven;     // of the fastest obstacle that presses it [m/s]
} FemMomentumBody;

// What a collision may stop, or transfer to a body of a group.
typedef struct FemMomentumMotion {
  int body_count;   // of the group
  double mass;      // [kg]
  double common[3]; // the velocity of the group that nothing detects (fem/model/floating.h) [m/s]
  double momentum;  // Σ |p| of all bodies [kg m/s]
  double speed;     // of the fastest [m/s]
} FemMomentumMotion;

typedef struct FemMomentum {
  FemSystem *system; // borrowed
  int body_count;
  double time;           // of the last state
  FemMomentumBody *now;  // until then                                     (body_count)
  FemMomentumBody *next; // until the end of the step that is looked at    (body_count)
  double next_time;
  // Bodies that have pressed each other, directly or through others, are a group: its first body's number.
  int *groups, *next_groups;  // of each body, as `now` and `next`            (body_count)
  FemMomentumMotion *motions; // scratch, of each group at its body's number  (body_count)
  double *loads;              // scratch; NULL: no loads                    (vertex_count, 3)
} FemMomentum;

// A zeroed one, and one whose creation failed, can be destroyed.
Status fem_momentum_create(FemMomentum *momentum, FemSystem *system);
void fem_momentum_destroy(FemMomentum *momentum);

// The contact forces of a state: those of `interfaces`, `forces` on the first side of each [N].
typedef struct FemMomentumContact {
  int count;
  const ContactInterface *interfaces; //                                    (count)
  const double (*forces)[3];          //                                    (count)
} FemMomentumContact;

// The next step begins at this state: with other free coordinates, or where forces have jumped.
Status fem_momentum_begin(FemMomentum *momentum, const FemState *state, const FemMomentumContact *contact);
// Measures a state at which a step would end; what has been added up stays as it is.
Status fem_momentum_end(FemMomentum *momentum, const FemState *state, const FemMomentumContact *contact);
// The step has ended at the state that was measured last: it is added up.
void fem_momentum_accept(FemMomentum *momentum);
// Whether the step that was evaluated last leaves a body with a larger gap than is allowed, by an estimate of
// S at the end of the run, the time `end`.
bool fem_momentum_is_refused(const FemMomentum *momentum, double end);
// The factor, at most 1, of the velocities' tolerance in the next step: small imbalances of many steps add
// up. Bodies on which only gravity acts do not count. It is a function of the accepted state, so a resumed
// run has the same.
double fem_momentum_strictness(const FemMomentum *momentum, double end);

// J − Δp of a body up to a time in the step that was evaluated last [N s].
void fem_momentum_missing(const FemMomentum *momentum, double time, int body, double missing[3]);
// The gap of a body, and the largest of all bodies with the body's number (`body` may be NULL); NaN is the
// largest.
double fem_momentum_gap(const FemMomentum *momentum, double time, int body);
double fem_momentum_largest_gap(const FemMomentum *momentum, double time, int *body);

// What a checkpoint keeps: 8 numbers a body.
enum { FEM_MOMENTUM_KEPT = 8 };
void fem_momentum_save(const FemMomentum *momentum, double *values);
// Whether they can be loaded: a group has the number of its first body.
bool fem_momentum_fits(const FemMomentum *momentum, const double *values);
void fem_momentum_load(FemMomentum *momentum, const double *values);

#endif
