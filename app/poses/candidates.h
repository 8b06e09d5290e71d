// SPDX-License-Identifier: GPL-3.0-or-later
// Which tetrahedra of a body may meet which others in any of several poses.
#ifndef TETLAP_APP_POSES_CANDIDATES_H
#define TETLAP_APP_POSES_CANDIDATES_H

#include "base/status.h"
#include "contact/search/boxes.h"
#include "fem/model/model.h"

typedef struct AppPosesCandidates {
  const FemModel *model; // borrowed
  int body;              // the one that is moved
  double (*swept)[6];    // boxes of its vertices over the poses
  double (*own)[6];      // of its tetrahedra                       (own_count)
  double (*others)[6];   // of all others                           (other_count)
  int *other_tets;       // their numbers                           (other_count)
  int own_count, other_count;
  ContactBoxPairs found; // pairs: a tetrahedron of the body, one of another; sorted
} AppPosesCandidates;

// A zeroed one, and one whose creation failed, can be destroyed.
Status app_poses_candidates_create(AppPosesCandidates *candidates, const FemModel *model, int body);
void app_poses_candidates_destroy(AppPosesCandidates *candidates);

// Fills `found` for poses (count, 12): all pairs whose boxes meet in one of them, and some more.
Status app_poses_candidates_find(AppPosesCandidates *candidates, int count, const double *poses);

#endif
