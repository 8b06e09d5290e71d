// SPDX-License-Identifier: GPL-3.0-or-later
// The promises of a run, and the numbers that keep them. docs/limits.md is made from this page by
// tools/limits. Each entry ends with what holds its number: tests that fail with another one, or scenes that
// change by more than their own tolerance.
#ifndef TETLAP_FEM_MODEL_LIMITS_H
#define TETLAP_FEM_MODEL_LIMITS_H

// ---- Promises. A run that breaks one is reported as trouble.

// The audited total (fem/time/audit.h) rises by no more than this share of the scene's energy.
// Held by test_audit, test_momentum, test_scenes.
#define FEM_ENERGY 1e-3

// The same share: written forces and motion of a body differ by no more of all its impulses
// (fem/measure/momentum.h).
// Held by test_momentum, test_result.
#define FEM_MOMENTUM FEM_ENERGY

// Without contact nothing jumps, and BDF 2 keeps a modified energy. It differs from the audited total by a
// term of second order in the step. Only a gain of so many times FEM_ENERGY shows an error of the program or
// of the scene. The energy of a strain of so many times time.tolerance is the least that counts as the
// scene's.
// Held by test_audit, test_beam.
#define FEM_WITHOUT_CONTACT 20

// A promise's share of a promise is rounding: of the scene's energy, of a tolerance of Newton's method, of an
// element's cube, of a run's time that a step goes on by.
// Held by test_audit, test_balance.
#define FEM_ROUNDING (FEM_ENERGY * FEM_ENERGY)

// Times that differ by this share of the run's end are one: knots of what is prescribed, frames, the
// shortest step. IDA distinguishes 2e-14.
// Held by test_integrator.
#define FEM_TIME_RESOLUTION 1e-12

// From this share on a doubt is reported: the estimated error of a contact, pairs of elements that a network
// was asked beyond its training. Held by test_result, test_accuracy.
#define FEM_DOUBT 0.01

// ---- What a step may use up. It is taken back before it breaks a promise of the run.

// Share of a promise that is kept for steps that cannot be shortened. As much is left to friction at a
// reversal of slip, to what Newton's method leaves of the balance of forces, and, of the longest step for which
// lists of near pairs hold, to what accelerates.
// Held by test_audit, test_momentum, test_verdict, test_balance, test_steps.
#define FEM_RESERVE 0.2

// Of a run's gain of energy: beyond it a step may gain rounding only.
// Held by test_audit.
#define FEM_ENERGY_NEAR ((1 - FEM_RESERVE) * FEM_ENERGY)

// What a step may always gain of the scene's energy.
// Held by test_audit.
#define FEM_ENERGY_STEP FEM_ROUNDING

// What friction may give in a step to a slip that has reversed within it, of the scene's energy.
// Held by test_verdict.
#define FEM_ENERGY_REVERSED (FEM_RESERVE * FEM_ENERGY)

// What may always be missing in the balance of momentum.
// Held by test_momentum.
#define FEM_MOMENTUM_NEAR ((1 - 2 * FEM_RESERVE) * FEM_MOMENTUM)

// Beyond FEM_MOMENTUM_NEAR a step adds no more than half of what is left to this.
// Held by test_momentum.
#define FEM_MOMENTUM_FAR ((1 - 0.5 * FEM_RESERVE) * FEM_MOMENTUM)

// What a method of order 1 may lack while a force rises and recovers as the force falls: together with
// FEM_MOMENTUM_FAR the promise.
// Held by test_momentum.
#define FEM_MOMENTUM_OWED (FEM_MOMENTUM - FEM_MOMENTUM_FAR)

// What a step may always add, as a share of the promise of momentum.
// Held by test_momentum.
#define FEM_MOMENTUM_STEP (FEM_DOUBT * FEM_MOMENTUM)

// From this share of the impulses on the tolerance of velocities falls, to FEM_RESERVE of itself at
// FEM_MOMENTUM_FAR: steps get shorter before they have to be taken back.
// Held by test_momentum.
#define FEM_MOMENTUM_STRICT (0.5 * FEM_MOMENTUM)

// The forces on a body balance to this share of its weight …
// Held by test_balance, test_field_theory.
#define FEM_BALANCE (FEM_RESERVE * FEM_MOMENTUM)

// … or to this share of what its acceleration takes, if that is more. What is left turns a stiff body that
// flies, and gives it energy.
// Held by test_balance, test_scenes.
#define FEM_BALANCE_OF_INERTIA (2 * FEM_MOMENTUM)

// Once what is left has given a body's rotation FEM_RESERVE of the promise of energy, it goes on with at most
// this share of the power Σ m v̇ v (of moduli). That is 2 K a radian, K the kinetic energy, so with 1/4π a turn
// gives FEM_ENERGY of K. This is as much.
// Held by test_balance.
#define FEM_BALANCE_OF_TURN (2 * FEM_RESERVE * FEM_BALANCE)

// ---- What a step may err by: the tolerances of IDA's error test, beside time.tolerance.

// Share of time.tolerance that velocities may err by with contact, over the slowest wave's speed, and
// positions without contact, over the smallest body's length. The waves of an impact carry the speed of the
// impact, hundredths of √(E/ρ); without contact bending needs accurate positions.
// Held by test_tolerance, test_beam, test_impact.
#define FEM_FINE 0.03

// The speed of waves counts up to so many times the speed that is expected in the scene. In stiff bodies that
// move slowly waves carry far less than a hundredth of √(E/ρ).
// Held by test_tolerance, test_impact.
#define FEM_OF_EXPECTED_SPEED 10

// With contact velocities may err by so many times time.tolerance of the present speed of the fastest
// of the bodies that have pressed each other.
// Held by test_tolerance, test_steps; 13_dead_bounce takes 869 steps instead of 336 with a third of it.
#define FEM_OF_PRESENT_SPEED 5

// ---- Rest (fem/run/rest/rest.h).

// A body rests once it has been calm for so many times the longest time in which a wave crosses a body. A
// body rings with twice that period, and some periods without motion are no turning point.
// Held by test_tolerance, test_rest.
#define FEM_REST_CROSSINGS 20

// It is balanced if its acceleration is below so many times the speed of rest in that time: the integrator's
// own errors accelerate a body at rest by some hundredths.
// Held by test_tolerance, test_rest.
#define FEM_REST_ACCELERATION 5

// ---- Lengths of steps.

// Of the run's end: the longest step, also of a run whose bodies all sleep.
// Held by 10_incline: 109 steps instead of 89 with a third of it.
#define FEM_LONGEST_STEP 0.1

// A step is lengthened with contact only if it can grow by this factor; a change of length costs a factor of
// the matrix. IDA's own is 2, which holds without contact.
// Held by 13_dead_bounce: 464 steps instead of 336 without it.
#define FEM_LEAST_GROWTH 1.2

// A step that does not stand is tried again with this share of its length. So are a time that all bodies
// sleep through, and a correction of Newton's method, where forces cannot be evaluated. A line search takes
// at least half of this share.
// Held by test_verdict, test_accuracy; wedge takes back 335 steps instead of 240 with 0.25.
#define FEM_CUT 0.2

// Of the time in which a wave √(E/ρ) crosses the smallest mean edge h: nothing moves in less, so no shorter
// step is tried again. For energy that of √(h p′/ρ) counts, too, where contact has a pressure that rises by p′
// per depth. The first step of a start is FEM_CUT of the former at least.
// Held by test_result, test_impact.
#define FEM_SHORTEST_RETRY 2.5e-3

// ---- Newton's method.

// Iterations before a step is given up, and cuts of one correction. As many may a linear solution take by the
// factor of another step's matrix, and all such twice as many, before there is a new factor, which costs as much
// as some tens of them.
// Held by 21_release: 175 factors instead of 142 with 16.
#define FEM_NEWTON_ITERATIONS 20

// Matrices made anew within a step before it is given up: a step that needs more is solved in the end, but is
// too long for an impact.
// Held by test_accuracy: the peak force of 01_drop at a fine tolerance errs by 3.5 % instead of 0.1 % with
// more.
#define FEM_NEWTON_RENEWALS 5

// What a linear solution may leave: of what Newton's test lets pass, and of the right-hand side.
// Held by test_newton; three times as much or as little changes numbers of steps by 2 % at most.
#define FEM_SOLVED (2 * FEM_DOUBT)

#endif
