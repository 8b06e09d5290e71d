// SPDX-License-Identifier: GPL-3.0-or-later
// What a run promises, and every bound that keeps a promise, as a share of it.
//
//   energy    the audited total (fem/time/audit.h) rises by no more than this share of the scene's energy
//   momentum  written forces and motion of a body differ by no more than this share of all its impulses
//             (fem/measure/momentum.h)
//
// A run that breaks a promise is told as trouble. So that none is broken, a step that would use up what is
// left of one is taken back, and tried again with a shorter step, before that. Where nothing jumps, without
// contact, steps are bounded by the error test alone: the bounds of energy are then so wide that exceeding
// them shows an error of the program or of the scene.
#ifndef TETLAP_FEM_MODEL_LIMITS_H
#define TETLAP_FEM_MODEL_LIMITS_H

typedef struct FemLimits {
  // Energy, as shares of the scene's.
  double energy;      // a run's gain: the promise
  double energy_near; // of a run's gain, from which on a step may not gain more than `energy_step`
  double energy_step; // what a step may always gain; below it a gain is rounding
  double energy_without_contact, energy_step_without_contact; // the first and the third where nothing jumps
  double turned; // what friction may give in a step to what has turned round within it
  // Momentum, as shares of a body's impulses.
  double momentum;      // of a run: the promise
  double momentum_near; // what may always be missing
  double momentum_far;  // beyond `momentum_near` a step adds no more than half of what is left to this
  double momentum_step; // what a step may always add
  double momentum_owed; // what a method of order 1 may lack while a force rises, which it makes up for as the
                        // force falls, but not if the length of steps or the order has changed in between
  // From the first share to `momentum_far` the tolerance of velocities falls to the second share of itself:
  // steps get shorter before they have to be taken back.
  double momentum_strict, strictest;
} FemLimits;

extern const FemLimits fem_limits;

#endif
