// SPDX-License-Identifier: GPL-3.0-or-later
// What a probe of the scene (fem/scene/probe/probe.h) reads at a state, and what it has read in a run.
//
// Its force is what acts on its vertices from outside: contact with friction and viscosity, loads, and what
// holds or drives them; not gravity and not the body itself. At a face that is fixed it is the reaction, at a
// face that touches something the force of contact.
#ifndef TETLAP_FEM_MEASURE_READING_H
#define TETLAP_FEM_MEASURE_READING_H

#include "fem/effect/system.h"
#include "fem/scene/probe/probe.h"

// In this order the columns of history.csv.
typedef struct FemReading {
  double force[3];  // [N]
  double moment[3]; // about the mean place of the vertices [N m]
  double pressure; // mean: the force against the mean outward normal, over `area`; NaN without triangles [Pa]
  double area;     // of the triangles, as they are now [m²]
  double displacement[3]; // mean of the vertices [m]
} FemReading;

enum { FEM_READING_COUNT = 11 };
const char *fem_reading_title(int value); // "force_x_N" …

// `external` (vertex_count, 3): the force from outside on every vertex [N].
FemReading fem_reading_take(const FemProbe *probe, const double *rest, const double *positions,
                            const double *external);

// What a run has read after accepted steps.
typedef struct FemReadings {
  FemReading last;
  double largest_force, largest_force_time;               // [N], [s]
  double largest_displacement, largest_displacement_time; // [m], [s]
} FemReadings;

void fem_readings_add(FemReadings *readings, const FemReading *reading, double time);

// For checkpoints: so many numbers.
enum { FEM_READINGS_KEPT = FEM_READING_COUNT + 4 };

#endif
