// SPDX-License-Identifier: GPL-3.0-or-later
// Sleep: bodies that have come to rest take no part in the computation until something acts on them.
//
// A body is calm while every vertex is slower than `speed`. Bodies that touch, or are nearer than the
// contact margin, make an island. An island falls asleep as a whole once each of its bodies has been calm
// for `time`, the forces on each balance, and nothing that acts on it is changing. Forces balance where the
// last step accelerated the centre of mass by no more than `acceleration`. The vertices of an island asleep
// stay where they are and carry no unknowns; contact within it is neither searched nor evaluated. It awakes,
// from velocity 0, when
//   – a body that is awake, or an obstacle that moves, comes within the margin of one of its bodies,
//   – a load, a driven vertex or a release on it, or an obstacle near it, begins to change.
//
// Positions do not jump, and a body that is awake never overlaps one that sleeps, so the forces on all that
// moves are continuous; when an island awakes its forces are those with which it fell asleep. Of the energy
// only the kinetic energy of what falls asleep is lost, at most ½ m speed², and none is ever gained.
//
// Decisions follow from accepted states alone; checkpoints keep what they need.
#ifndef TETLAP_FEM_RUN_REST_REST_H
#define TETLAP_FEM_RUN_REST_REST_H

#include <stdbool.h>

#include "base/files/record.h"
#include "fem/effect/system.h"

typedef struct FemRest FemRest; // opaque

bool fem_rest_is_wanted(const FemSceneDef *scene);

// For a system whose contact is on and which it may change; both borrowed.
Status fem_rest_create(FemRest **rest, FemSystem *system);
void fem_rest_destroy(FemRest *rest); // NULL: nothing

// Decides which bodies sleep, at the system's accepted state; `step` [s] is the expected length of the next
// one. NULL, here and below: no body may sleep.
Status fem_rest_decide(FemRest *rest, double step);
// Whether a body has fallen asleep or awoken since the last call; then the unknowns must be numbered anew.
bool fem_rest_has_changed(FemRest *rest);
bool fem_rest_is_asleep(const FemRest *rest, int body);
// The time at which something that acts on a sleeping body begins to change; INFINITY: never.
double fem_rest_next_change(const FemRest *rest);
// Counts the kinetic energy that was taken from what fell asleep [J].
void fem_rest_add_loss(FemRest *rest, double energy);

// Adds counters to summary.json.
void fem_rest_report(const FemRest *rest, Record *counters);

// For checkpoints: a new array, the caller's; and back, before the first decision. STATUS_INPUT: it does not
// fit.
Status fem_rest_save(const FemRest *rest, double **values, size_t *count);
Status fem_rest_load(FemRest *rest, const double *values, size_t count);

#endif
