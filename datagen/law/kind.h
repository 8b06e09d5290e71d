// SPDX-License-Identifier: GPL-3.0-or-later
// What a pair of a data set is an example of. A kind is a claim about the intersection of the two closed
// tetrahedra, which the generator proves for every pair (proof.h). It is the dimension of that, and of the
// smallest face of either tetrahedron that holds all of it.
//
//   dimension   −1 disjoint    0 a point     1 a segment    2 a polygon    3 a common volume
//   carrier      0 a vertex    1 an edge     2 a face       3 the tetrahedron itself
//
// Two edges that lie along each other (dimension 1, carriers 1 and 1) have no kind: none is generated.
#ifndef TETLAP_DATAGEN_LAW_KIND_H
#define TETLAP_DATAGEN_LAW_KIND_H

#include "base/status.h"

// The codes that files hold; only ever added to.
typedef enum DatagenKind {
  DATAGEN_NONE,        // vertices uniform in the unit cube, disjoint
  DATAGEN_VERTEX_FACE, // a vertex of the second inside a face of the first
  DATAGEN_EDGE_FACE,   // an edge of the second in a face of the first
  DATAGEN_FACE_FACE,   // faces in one plane, back to back, that share a polygon
  DATAGEN_VOLUMETRIC,  // vertices uniform in the unit cube, V by the volume law
  DATAGEN_VERTEX_VERTEX,
  DATAGEN_VERTEX_EDGE, // a vertex of the second inside an edge of the first
  DATAGEN_EDGE_EDGE,   // edges that cross in one inner point of either
  DATAGEN_SCENE,       // elements of two jittered meshes pressed together, intersecting
  DATAGEN_SCENE_NONE,  // the same or from a run, disjoint although their boxes overlap
  DATAGEN_CAPTURED,    // from a run of a scene, not disjoint; or none of the others: claims nothing
  DATAGEN_KIND_COUNT,
} DatagenKind;

typedef struct DatagenKindInfo {
  const char *name; // as files, mixes and tables spell it
  const char *help; // one line
  int dimension;    // of the intersection, −1 … 3
  int carrier[2];   // of the first and the second tetrahedron, 0 … 3; without meaning if disjoint
} DatagenKindInfo;

// NULL: no kind has that code.
const DatagenKindInfo *datagen_kind_info(int kind);
// STATUS_USAGE: no kind has that name; the message lists the known ones and the nearest.
Status datagen_kind_find(const char *name, DatagenKind *kind);

#endif
