// SPDX-License-Identifier: GPL-3.0-or-later
// What a run writes of obstacles without a mesh beside its frames: obstacles.vtu once, of those that stand,
// and obstacles_NNNNN.vtu with every frame, of those that move.
#ifndef TETLAP_FEM_OUTPUT_VTK_OBSTACLE_FRAMES_H
#define TETLAP_FEM_OUTPUT_VTK_OBSTACLE_FRAMES_H

#include "base/files/file.h"
#include "fem/output/vtk/obstacle_surface.h"

typedef struct FemObstacleFrames {
  FemObstacleSurface standing, moving;
  bool has_standing; // is written
} FemObstacleFrames;

Status fem_obstacle_frames_create(FemObstacleFrames *frames, const FemModel *model);
void fem_obstacle_frames_destroy(FemObstacleFrames *frames); // a zeroed one, too

// Whether there is anything to write.
bool fem_obstacle_frames_any(const FemObstacleFrames *frames);
// Moves them to where the model has them at that time [s].
void fem_obstacle_frames_place(FemObstacleFrames *frames, double time);
// Writes what belongs to frame `frame`, of that time, where they were placed; reads no model. Fails as
// fem_vtu_write.
Status fem_obstacle_frames_write(FemObstacleFrames *frames, const char *directory, int frame, double time);
// Adds its parts, from 1 on, to the list of frames.
void fem_obstacle_frames_list(const FemObstacleFrames *frames, FileWriter *list, int frame, double time);

#endif
