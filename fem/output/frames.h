// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of a run in its folder: frame_NNNNN.vtu (or .pvtu), what belongs to obstacles beside them, and
// frames.pvd, which lists them. A frame is copied and written while the run goes on if there are threads, and
// if frames are so far apart that the run need not wait for them. Frames are written one at a time, in their
// order. A frame is listed once it is on the disk.
#ifndef TETLAP_FEM_OUTPUT_FRAMES_H
#define TETLAP_FEM_OUTPUT_FRAMES_H

#include <stdbool.h>

#include "base/files/background.h"
#include "fem/model/model.h"
#include "fem/output/vtk/obstacle_frames.h"
#include "fem/output/vtk/pieces.h"
#include "fem/output/vtk/vtu_copy.h"

// While one is written, only fem_frames_wait may touch it.
typedef struct FemFrames {
  const FemModel *model; // borrowed
  const char *directory; // borrowed
  bool writes_pieces;
  FemVtuPart part;             // what this rank writes of frames in pieces
  FemObstacleFrames obstacles; // those without a mesh
  int count;                   // frames that are written
  int listed_count;            // of these in frames.pvd
  double listed_at_s;          // wall clock when it was written
  double writing_s;            // about how long one thread takes to write a frame; 0: not known yet
  double left_at_s;            // wall clock when the last call ended
  const FemVtuFrame *next;     // that is being written
  FemVtuCopy copy;             // of it, if in the background
  Background background;
} FemFrames;

Status fem_frames_create(FemFrames *frames, const FemModel *model, const char *directory);
void fem_frames_destroy(FemFrames *frames); // waits; a zeroed one, too

// Goes on after so many frames that are there.
void fem_frames_continue(FemFrames *frames, int count);

// Writes the next frame, or begins to; its arrays are borrowed during the call, its cells and names until
// fem_frames_wait. A failure may be that of the frame before.
Status fem_frames_write(FemFrames *frames, const FemVtuFrame *frame);

// Waits until all frames are on the disk.
Status fem_frames_wait(FemFrames *frames);

// Waits, and writes the list if it lacks some: in between, long lists are written at most once a second.
Status fem_frames_finish(FemFrames *frames);

#endif
