// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/capture.h"

#include <stdio.h>
#include <string.h>

#include "datagen/draw/cube.h"
#include "datagen/draw/proof.h"
#include "datagen/generate.h"

enum { BLOCK = 4096, FLAT = 2 };

static void abandon(DatagenCapture *capture) {
  datagen_dataset_writer_abandon(capture->writer);
  datagen_pairs_destroy(&capture->pairs);
  *capture = (DatagenCapture){0};
}

Status datagen_capture_begin(DatagenCapture *capture, const char *path, const char *program,
                             DatagenLabel label) {
  DatagenInfo info;
  memset(&info, 0, sizeof info);
  *capture = (DatagenCapture){.label = label};
  info.generator_version = DATAGEN_GENERATOR_VERSION;
  snprintf(info.program, sizeof info.program, "%s", program);
  snprintf(info.law, sizeof info.law, "captured");
  snprintf(info.mix, sizeof info.mix, "captured");
  snprintf(info.volume_law, sizeof info.volume_law, "captured");
  snprintf(info.label, sizeof info.label, "%s", datagen_plan_label_name(label));
  info.has_gradient = info.has_centroid = true;
  TRY(datagen_pairs_create(&capture->pairs, BLOCK, true));
  Status status = datagen_dataset_writer_begin(&capture->writer, path, &info);
  if (status) abandon(capture);
  return status;
}

// Into its place in the block; a pair that is flat, before rounding in the move or after, gets the status
// FLAT.
static Status add_pair(const DatagenCapture *capture, const double *source, int place) {
  static const double middle[3] = {0.5, 0.5, 0.5};
  const DatagenPairs *pairs = &capture->pairs;
  double *pair = pairs->coordinates + 24 * (size_t)place;
  memcpy(pair, source, 24 * sizeof *pair);
  datagen_cube_fit(pair, middle);
  DatagenProof proof = datagen_proof_of(pair);
  pairs->status[place] = proof.is_flat || datagen_proof_of(source).is_flat ? FLAT : proof.dimension >= 0;
  pairs->kind[place] = (uint8_t)(proof.dimension < 0 ? DATAGEN_SCENE_NONE : DATAGEN_CAPTURED);
  return datagen_generate_label(capture->label, pair, proof.dimension, pairs->volume + place,
                                pairs->gradient + 24 * (size_t)place, pairs->centroid + 3 * (size_t)place);
}

// Moves the others together; how many they are.
static int drop_flat(const DatagenPairs *pairs, int count) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    if (pairs->status[i] == FLAT) continue;
    memmove(pairs->coordinates + 24 * (size_t)kept, pairs->coordinates + 24 * (size_t)i, 24 * sizeof(double));
    memmove(pairs->gradient + 24 * (size_t)kept, pairs->gradient + 24 * (size_t)i, 24 * sizeof(double));
    memmove(pairs->centroid + 3 * (size_t)kept, pairs->centroid + 3 * (size_t)i, 3 * sizeof(double));
    pairs->status[kept] = pairs->status[i];
    pairs->kind[kept] = pairs->kind[i];
    pairs->volume[kept] = pairs->volume[i];
    kept++;
  }
  return kept;
}

static Status append_block(DatagenCapture *capture, const double *source, int count) {
  int failed = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : failed)
  for (int i = 0; i < count; i++) failed += add_pair(capture, source + 24 * (size_t)i, i) != STATUS_OK;
  if (failed) return status_fail(STATUS_SOLVER, "%d captured pairs could not be labelled", failed);
  int kept = drop_flat(&capture->pairs, count);
  capture->flat += count - kept;
  for (int i = 0; i < kept; i++) capture->apart += capture->pairs.status[i] == 0;
  return kept ? datagen_dataset_writer_append(capture->writer, &capture->pairs, (size_t)kept, NULL)
              : STATUS_OK;
}

Status datagen_capture_append(DatagenCapture *capture, const double *pairs, int count) {
  for (int done = 0; done < count; done += BLOCK)
    TRY(append_block(capture, pairs + 24 * (size_t)done, count - done < BLOCK ? count - done : BLOCK));
  return STATUS_OK;
}

long long datagen_capture_count(const DatagenCapture *capture) {
  return datagen_dataset_writer_count(capture->writer);
}

Status datagen_capture_commit(DatagenCapture *capture) {
  DatagenWriter *writer = capture->writer;
  capture->writer = NULL;
  Status status = STATUS_OK;
  if (datagen_dataset_writer_count(writer) > 0)
    status = datagen_dataset_writer_commit(writer);
  else
    datagen_dataset_writer_abandon(writer);
  abandon(capture);
  return status;
}
