// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of tetrahedra that are hard for overlap models, by class. `tetlap stress` and the tests give them to
// every model.
//
// "On the grid" below: coordinates are small multiples of 2⁻¹², so that points made of them with dyadic
// weights are exact and touching or coplanar means exactly that.
#ifndef TETLAP_DATAGEN_HARD_H
#define TETLAP_DATAGEN_HARD_H

#include <stdbool.h>

#include "base/random.h"
#include "base/vec3.h"

typedef struct DatagenHardPair {
  double x[24];        // two tetrahedra, four vertices, three coordinates
  double volume;       // what V must be; NaN: only an oracle knows
  double slack;        // by how much rounding of the coordinates may have changed it [same unit]
  bool is_flat;        // a tetrahedron has no volume at all: V = 0 and the flag FLAT
  bool is_smooth;      // V has a derivative here: central differences may be compared
  const char *failure; // NULL; else why it is none of its class (its `x` is some pair then)
} DatagenHardPair;

typedef struct DatagenHardClass {
  const char *name;
  void (*make)(Random *random, DatagenHardPair *pair); // NULL: `make_of` a number
  void (*make_of)(Random *random, DatagenHardPair *pair, double number);
  double number;
} DatagenHardClass;

enum { DATAGEN_HARD_CLASS_COUNT = 36 };
extern const DatagenHardClass datagen_hard_classes[DATAGEN_HARD_CLASS_COUNT];

// Makes a member of the class: its coordinates and what is known of it; the rest of the pair stays.
void datagen_hard_fill(const DatagenHardClass *class, Random *random, DatagenHardPair *pair);

// The k-th (0 … 23) order of a tetrahedron's vertices; every second one turns it inside out.
void datagen_hard_permute(const double tet[12], int k, double permuted[12]);

// x ← scale · R x + shift for `count` points.
void datagen_hard_transform(double *x, int count, const double rotation[9], double scale, Vec3 shift);

// Four tetrahedra that fill `tet`, meeting at the inner point of these barycentric weights.
void datagen_hard_subdivide(const double tet[12], const double weights[4], double parts[4][12]);

Vec3 datagen_hard_vertex(const DatagenHardPair *pair, int i);

void datagen_hard_set(DatagenHardPair *pair, int i, Vec3 p);

// Tetrahedron `which` (0, 1): vertices on the grid of the unit cube, six times the volume at least 0.1.
void datagen_hard_fat(Random *random, DatagenHardPair *pair, int which);

// The normal of the face of the first tetrahedron opposite to its vertex 0, pointing away from that vertex.
// Exact on the grid.
Vec3 datagen_hard_face_normal(const DatagenHardPair *pair, int opposite);

// Always the same pair for the same numbers. `failure` is set where the exact volume, which one class needs,
// finds no memory.
DatagenHardPair datagen_hard_make(int class_index, int member);

#endif
