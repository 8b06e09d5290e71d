// SPDX-License-Identifier: GPL-3.0-or-later
// Checkpoints. The input is a list of edits (hdf5_edit.h) of a good one, whose digest is then made anew:
// without that nothing would come as far as HDF5. An input that begins with 'R' is a file as it stands. See
// fuzz_dataset.c about TETLAP_FUZZ_DAMAGE.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files/digest.h"
#include "base/memory.h"
#include "fem/run/checkpoint/checkpoint.h"
#include "hdf5_edit.h"
#include "target.h"

enum { HEAD = 512, VERTEX_COUNT = 4, ROOM = 1 << 20 };

static const char file_name[] = "fuzz_checkpoint.h5";

static void fill(FemCheckpoint *checkpoint) {
  static const char origin[] = "{\"scene\": {}}";
  FUZZ_CLAIM(fem_checkpoint_create(checkpoint, VERTEX_COUNT) == STATUS_OK, "%s", status_message());
  checkpoint->time = 0.5, checkpoint->step = 1e-3;
  checkpoint->next_frame = 3, checkpoint->history = (JournalMark){.size = 7, .digest = 1};
  checkpoint->origin = memory_copy(origin, sizeof origin, 1);
  checkpoint->effect_count = 2;
  for (int e = 0; e < 2; e++) {
    FemCheckpointEffect *effect = &checkpoint->effects[e];
    snprintf(effect->name, sizeof effect->name, "effect %d", e);
    effect->count = 3;
    effect->values = memory_zeroed(effect->count, sizeof *effect->values);
  }
}

// The whole good file, made once.
static const FuzzImage *template_image(void) {
  static FuzzImage image;
  if (image.bytes) return &image;
  const char *path = fuzz_target_file(file_name, "", 0);
  FemCheckpoint checkpoint;
  fill(&checkpoint);
  FUZZ_CLAIM(fem_checkpoint_write(&checkpoint, path) == STATUS_OK, "%s", status_message());
  fem_checkpoint_destroy(&checkpoint);
  image.bytes = malloc(ROOM);
  FUZZ_CLAIM(image.bytes, "no memory");
  image.size = fuzz_target_read(path, image.bytes, ROOM);
  FUZZ_CLAIM(image.size > HEAD, "the good file is too large");
  return &image;
}

// The head of a file in the form that fem/run/checkpoint/file.c writes; a changed form is seen by what the
// good file becomes without edits (seed 0).
static const char *put_file(const FuzzImage *good, const FuzzImage *image) {
  char digest[DIGEST_TEXT];
  int version = 0;
  uint8_t *file = malloc(HEAD + image->size);
  FUZZ_CLAIM(file, "no memory");
  digest_print(digest_bytes(DIGEST_START, image->bytes, image->size), digest);
  FUZZ_CLAIM(sscanf((const char *)good->bytes, "tetlap checkpoint %d", &version) == 1, "another head");
  memset(file, ' ', HEAD);
  int used = snprintf((char *)file, HEAD,
                      "tetlap checkpoint %d\nbytes %zu\ndigest %s\nHDF5 follows: h5dump reads this file\n",
                      version, image->size, digest);
  file[used] = ' ', file[HEAD - 1] = '\n';
  memcpy(file + HEAD, image->bytes, image->size);
  const char *path = fuzz_target_file(file_name, file, HEAD + image->size);
  free(file);
  return path;
}

static void check_checkpoint(const FemCheckpoint *checkpoint) {
  FUZZ_CLAIM(checkpoint->time >= 0 && checkpoint->step >= 0, "time %g, step %g", checkpoint->time,
             checkpoint->step);
  FUZZ_CLAIM(checkpoint->vertex_count >= 0 && checkpoint->next_frame >= 0 && checkpoint->history.size >= 0,
             "%d vertices, next frame %d, %lld bytes of history", checkpoint->vertex_count,
             checkpoint->next_frame, checkpoint->history.size);
  FUZZ_CLAIM(checkpoint->effect_count >= 0 && checkpoint->effect_count <= FEM_MAX_EFFECTS, "%d effects",
             checkpoint->effect_count);
  FUZZ_CLAIM(checkpoint->origin && checkpoint->so_far.counters, "a text is missing");
  FemCheckpoint copy;
  FUZZ_CLAIM(fem_checkpoint_copy(&copy, checkpoint) == STATUS_OK, "%s", status_message());
  fem_checkpoint_destroy(&copy);
}

static Status read_file(const char *path) {
  FemCheckpoint checkpoint;
  Status status = fem_checkpoint_read(&checkpoint, path);
  if (status) {
    FUZZ_CLAIM(status == STATUS_INPUT, "status %d: %s", (int)status, status_message());
    FUZZ_CLAIM(strstr(status_message(), path), "no path in '%s'", status_message());
    return status;
  }
  check_checkpoint(&checkpoint);
  fem_checkpoint_destroy(&checkpoint);
  return STATUS_OK;
}

static void run(const uint8_t *data, size_t size) {
  const FuzzImage *good = template_image();
  if (size > 0 && data[0] == 'R') {
    read_file(fuzz_target_file(file_name, data + 1, size - 1));
    return;
  }
  if (fuzz_hdf5_has_damage(data, size) && !getenv("TETLAP_FUZZ_DAMAGE")) return;
  FuzzImage image = fuzz_hdf5_edit(good->bytes + HEAD, good->size - HEAD, data, size);
  Status status = read_file(put_file(good, &image));
  if (size < FUZZ_HDF5_EDIT) FUZZ_CLAIM(!status, "the good file is refused: %s", status_message());
  free(image.bytes);
}

const FuzzTarget fuzz_checkpoint = {
    .name = "checkpoint", .run = run, .seed = fuzz_hdf5_seed, .mutate = fuzz_hdf5_mutate};
