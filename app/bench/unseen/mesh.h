// SPDX-License-Identifier: GPL-3.0-or-later
// Two bodies of tetrahedra unlike those in the training data: other splits of cells, gradings, slivers, large
// strain, thin parts, edges. The lower one is below z = 0 and fixed; the caller moves the upper one, whose
// lowest vertex is at z = 0.
#ifndef TETLAP_APP_BENCH_UNSEEN_MESH_H
#define TETLAP_APP_BENCH_UNSEEN_MESH_H

#include <stdint.h>

#include "contact/def.h"
#include "fem/mesh/mesh.h"

// A body: a box of cells, or of that size filled by gmsh with edges as long as the cell's first.
typedef struct AppUnseenBody {
  bool is_made;
  double growth; // of a made one's edges, from one end of x to the other
  int cells[3];
  double cell[3];     // size of those at the surface that meets the other body
  double grading;     // each layer below is so many times as thick; and likewise aside from the middle
  double jitter;      // of inner and outer vertices, as a share of the cell
  bool is_five;       // five tetrahedra a cell, mirrored from cell to cell; else six
  double turn, tilt;  // about z, then about x
  double shear, push; // strain: x by `shear` times z, z times `push`
} AppUnseenBody;

typedef struct AppUnseenCase {
  const char *name, *help;
  AppUnseenBody lower, upper;
  double depth; // of the middle of the path below the touch
  double slide; // how far the path goes aside, to either side
} AppUnseenCase;

extern const AppUnseenCase app_unseen_cases[];
extern const int app_unseen_case_count;

typedef struct AppUnseenMesh {
  int vertex_count, tet_count;
  double *rest, *x; // before and after the strain                     (vertex_count, 3)
  int (*tets)[4];   //                                                 (tet_count)
  ContactBody bodies[2];
} AppUnseenMesh;

// Made bodies differ from seed to seed by the length of their edges. They fail as reading a .geo does.
Status app_unseen_mesh_create(AppUnseenMesh *mesh, const AppUnseenCase *what, uint64_t seed);
void app_unseen_mesh_destroy(AppUnseenMesh *mesh); // a zeroed one is accepted

#endif
