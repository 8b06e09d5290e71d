// SPDX-License-Identifier: GPL-3.0-or-later
// Sleep: bodies that have come to rest take no part in the computation until something acts on them.
//
// A body is calm while every vertex is slower than `speed`. Bodies that touch, or are nearer than the contact
// margin, make an island. An island falls asleep as a whole once each of its bodies has been calm for `time`,
// the forces on each balance (its centre of mass was accelerated by no more than `acceleration` in the last
// step), and nothing that acts on it is changing: its vertices stay where they are and carry no unknowns, and
// contact within it is neither searched nor evaluated. It awakes, from velocity 0, when
//   – a body that is awake, or an obstacle that moves, comes within the margin of one of its bodies,
//   – a load, a driven vertex or a release on it, or an obstacle near it, begins to change.
//
// Positions do not jump, and a body that is awake never overlaps one that sleeps, so the forces on all that
// moves are continuous; when an island awakes its forces are those with which it fell asleep. Of the energy
// only the kinetic energy of what falls asleep is lost, at most ½ m speed², and none is ever gained.
//
// All is decided in `prepare`, from accepted states, and goes through checkpoints.
#ifndef TETLAP_FEM_EFFECT_REST_H
#define TETLAP_FEM_EFFECT_REST_H

#include <stdbool.h>

#include "fem/model/model.h"

struct FemSystem;

// Whether a body has fallen asleep or awoken since the last call; then the unknowns must be numbered anew.
// NULL: false.
bool fem_effect_rest_has_changed(void *effect);
// Whether a body sleeps. NULL: false.
bool fem_effect_rest_is_asleep(const void *effect, int body);
// The time at which something that acts on a sleeping body begins to change; INFINITY: never. NULL: INFINITY.
double fem_effect_rest_next_change(const void *effect);
// Counts the kinetic energy that was taken from what fell asleep [J].
void fem_effect_rest_add_loss(void *effect, double energy);

#endif
