// SPDX-License-Identifier: GPL-3.0-or-later
// A face between divided and whole edges, in triangles. Which ones depends on the face alone, so neighbours
// fit.
#ifndef TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_FACE_H
#define TETLAP_CONTACT_SURFACE_SMOOTH_SMOOTH_FACE_H

#include "contact/surface/smooth/smooth_points.h"

enum { CONTACT_SMOOTH_FACE_MOST = 1 << 2 * CONTACT_SMOOTH_MOST_LEVEL };

typedef struct ContactSmoothFace {
  int count, corners[CONTACT_SMOOTH_FACE_MOST][3];
} ContactSmoothFace;

// Of a face with these corners, counter-clockwise, which the triangles are too. `inner`: the first of the
// three points within; −1: there are none.
void contact_smooth_face_cut(const ContactSmooth *smooth, const int corners[3], int inner,
                             ContactSmoothFace *to);

// The first of the points within a face of the skin, as a vertex; −1: there are none.
int contact_smooth_face_inner(const ContactSmooth *smooth, int face);

#endif
