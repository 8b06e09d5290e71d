// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/vtk/obstacle_frames.h"

#include <math.h>
#include <stdio.h>

#include "base/memory.h"
#include "fem/output/vtk/pvd.h"

static const char STANDING_FILE[] = "obstacles.vtu";

enum { NAME_SIZE = 32 };

static void name_moving(int frame, char name[NAME_SIZE]) {
  snprintf(name, NAME_SIZE, "obstacles_%05d.vtu", frame);
}

Status fem_obstacle_frames_create(FemObstacleFrames *frames, const FemModel *model) {
  *frames = (FemObstacleFrames){0};
  Status status = fem_obstacle_surface_create(&frames->standing, model, false);
  if (!status) status = fem_obstacle_surface_create(&frames->moving, model, true);
  if (status) fem_obstacle_frames_destroy(frames);
  return status;
}

void fem_obstacle_frames_destroy(FemObstacleFrames *frames) {
  fem_obstacle_surface_destroy(&frames->standing);
  fem_obstacle_surface_destroy(&frames->moving);
  *frames = (FemObstacleFrames){0};
}

bool fem_obstacle_frames_any(const FemObstacleFrames *frames) {
  return frames->standing.vertex_count > 0 || frames->moving.vertex_count > 0;
}

static Status write_surface(const FemObstacleSurface *surface, const char *directory, const char *name,
                            double time) {
  char *path = file_join(directory, name);
  if (!path) return status_no_memory("a file name");
  Status status = fem_obstacle_surface_write(surface, path, time);
  memory_free(path);
  return status;
}

void fem_obstacle_frames_place(FemObstacleFrames *frames, double time) {
  if (frames->moving.vertex_count > 0) fem_obstacle_surface_place(&frames->moving, time);
}

Status fem_obstacle_frames_write(FemObstacleFrames *frames, const char *directory, int frame, double time) {
  if (frames->standing.vertex_count > 0 && !frames->has_standing) {
    TRY(write_surface(&frames->standing, directory, STANDING_FILE, NAN));
    frames->has_standing = true;
  }
  if (frames->moving.vertex_count == 0) return STATUS_OK;
  char name[NAME_SIZE];
  name_moving(frame, name);
  return write_surface(&frames->moving, directory, name, time);
}

void fem_obstacle_frames_list(const FemObstacleFrames *frames, FileWriter *list, int frame, double time) {
  int part = 1;
  char name[NAME_SIZE];
  name_moving(frame, name);
  if (frames->standing.vertex_count > 0) fem_pvd_add(list, time, part++, "standing obstacles", STANDING_FILE);
  if (frames->moving.vertex_count > 0) fem_pvd_add(list, time, part, "moving obstacles", name);
}
