// SPDX-License-Identifier: Apache-2.0
// Many poses of a body against others that stay: for each V of all overlaps (model `clip`) and the wrench
// that −∇V is on the moved body. Meshes and pairs stay on the device; a pose is 12 numbers up and 7 down.
//
// A pose is R, row by row, then t: x' = R x + t. Of a pose
//
//   V = Σ V_ij,   f = −∂V/∂t,   m = −∂V/∂ω,  ω a turn about the moved centre R c + t.
//
// f and m are a force and a moment for a pressure of 1 Pa. Every pose's sums are taken in the same order, so
// the processor's vectors, and kernels on any device, give the same bits.
#ifndef TETLAP_DEVICE_POSES_POSES_H
#define TETLAP_DEVICE_POSES_POSES_H

#include "device/device.h"

enum { DEVICE_POSE_SIZE = 12, DEVICE_POSE_SUMS = 7 }; // numbers of a pose; V, f, m

// What is posed; all borrowed.
typedef struct DevicePosesDef {
  int vertex_count, tet_count;
  const double *positions; // [m]                         (vertex_count, 3)
  const int (*tets)[4];    //                             (tet_count)
  double centre[3];        // c [m]
} DevicePosesDef;

typedef struct DevicePoses {
  const Device *device; // borrowed; NULL: the processor's vectors
  DevicePosesDef def;
  void *module; // owned, and all memory
  DeviceKernel kernels[DEVICE_MAX_KERNELS];
  DeviceMemory positions, tets, pairs, poses, parts, doubtful, doubtful_count, rows, sums;
  int pose_capacity, row_capacity;
  int (*pair_list)[2]; // owned                           (pair_count)
  int pair_count;
  long long handed_on; // (pose, pair)s that the host's clip-scalar answered, in all
} DevicePoses;

// A zeroed one, and one whose creation failed, can be destroyed.
Status device_poses_create(DevicePoses *poses, const Device *device, const DevicePosesDef *def);
void device_poses_destroy(DevicePoses *poses);

// The tetrahedra that may overlap in the poses to come: first of the moved body, second of another; copied.
Status device_poses_set_pairs(DevicePoses *poses, int count, const int (*pairs)[2]);

// poses (count, 12), sums (count, 7).
Status device_poses_run(DevicePoses *poses, int count, const double *pose_list, double *sums);

#endif
