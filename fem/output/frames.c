// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/output/frames.h"

#include <stdio.h>

#include "base/files/file.h"
#include "base/machine/clock.h"
#include "base/machine/cpu.h"
#include "base/memory.h"
#include "base/ranks.h"
#include "fem/output/vtk/pvd.h"

enum { NAME_SIZE = 32 };

// A larger frame is written from the run's own arrays, compressed by all threads: a copy would show in the
// memory that a run takes. [bytes]
static const size_t LARGEST_COPY = (size_t)256 << 20;

Status fem_frames_create(FemFrames *frames, const FemModel *model, const char *directory) {
  *frames = (FemFrames){.model = model, .directory = directory, .writes_pieces = model->scene->write_pieces};
  if (frames->writes_pieces)
    TRY(ranks()->worst(fem_vtu_part_create(&frames->part, model->vertex_count, model->tet_count,
                                           (const int(*)[4])model->tets, model->share)));
  return fem_obstacle_frames_create(&frames->obstacles, model);
}

void fem_frames_destroy(FemFrames *frames) {
  fem_frames_wait(frames);
  fem_obstacle_frames_destroy(&frames->obstacles);
  fem_vtu_part_destroy(&frames->part);
  fem_vtu_copy_destroy(&frames->copy);
  *frames = (FemFrames){0};
}

void fem_frames_continue(FemFrames *frames, int count) {
  frames->count = frames->listed_count = count;
}

static Status write_whole(const char *directory, const char *name, const FemVtuFrame *frame) {
  char file[NAME_SIZE + 8];
  snprintf(file, sizeof file, "%s.vtu", name);
  char *path = file_join(directory, file);
  if (!path) return status_no_memory("a file name");
  Status status = fem_vtu_write(path, frame);
  memory_free(path);
  return status;
}

static Status write_frame(FemFrames *frames) {
  char name[NAME_SIZE];
  snprintf(name, sizeof name, "frame_%05d", frames->count);
  if (frames->writes_pieces)
    TRY(fem_vtu_pieces_write(frames->directory, name, frames->next, &frames->part));
  else
    TRY(write_whole(frames->directory, name, frames->next));
  TRY(fem_obstacle_frames_write(&frames->obstacles, frames->directory, frames->count, frames->next->time));
  frames->count++;
  return STATUS_OK;
}

// The list follows from how many frames there are, so none of it is kept.
static Status write_list(FemFrames *frames) {
  FileWriter list;
  char *path = file_join(frames->directory, "frames.pvd");
  if (!path) return status_no_memory("a file name");
  Status status = fem_pvd_begin(&list, path);
  memory_free(path);
  TRY(status);
  for (int frame = 0; frame < frames->count; frame++) {
    char file[NAME_SIZE];
    double time = fem_scene_frame_time(frames->model->scene, frame);
    snprintf(file, sizeof file, "frame_%05d.%s", frame, frames->writes_pieces ? "pvtu" : "vtu");
    fem_pvd_add(&list, time, 0, fem_obstacle_frames_any(&frames->obstacles) ? "bodies" : NULL, file);
    fem_obstacle_frames_list(&frames->obstacles, &list, frame, time);
  }
  TRY(fem_pvd_commit(&list));
  frames->listed_count = frames->count;
  frames->listed_at_s = clock_wall_s();
  return STATUS_OK;
}

// To write the whole list after every frame would take time that grows with the square of their number.
static bool is_list_due(const FemFrames *frames) {
  static const double PERIOD_S = 1;
  enum { SHORT = 1000 };
  return frames->count <= SHORT || clock_wall_s() - frames->listed_at_s >= PERIOD_S;
}

static Status write_next(void *self) {
  FemFrames *frames = self;
  TRY(write_frame(frames));
  return is_list_due(frames) ? write_list(frames) : STATUS_OK;
}

// Whether the run has taken longer since the last frame than to write one takes a single thread: else it
// would wait, and all threads write sooner. Ranks wait for each other.
static bool may_copy(const FemFrames *frames, const FemVtuFrame *frame) {
  return background_is_apart() && ranks()->count == 1 && fem_vtu_copy_bytes(frame) <= LARGEST_COPY &&
         frames->writing_s > 0 && clock_wall_s() - frames->left_at_s >= frames->writing_s;
}

static Status write_here(FemFrames *frames, const FemVtuFrame *frame) {
  const double began = clock_wall_s();
  frames->next = frame;
  TRY(write_next(frames));
  frames->writing_s = cpu_thread_count() * (clock_wall_s() - began);
  return STATUS_OK;
}

static Status write_apart(FemFrames *frames, const FemVtuFrame *frame) {
  TRY(fem_vtu_copy_take(&frames->copy, frame));
  frames->next = &frames->copy.frame;
  return background_begin(&frames->background, write_next, frames);
}

Status fem_frames_write(FemFrames *frames, const FemVtuFrame *frame) {
  const bool is_apart = may_copy(frames, frame);
  TRY(fem_frames_wait(frames));
  fem_obstacle_frames_place(&frames->obstacles, frame->time);
  Status status = is_apart ? write_apart(frames, frame) : write_here(frames, frame);
  frames->left_at_s = clock_wall_s();
  return status;
}

Status fem_frames_wait(FemFrames *frames) {
  return background_wait(&frames->background);
}

Status fem_frames_finish(FemFrames *frames) {
  TRY(fem_frames_wait(frames));
  return frames->listed_count < frames->count ? write_list(frames) : STATUS_OK;
}
