// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/job/inputs.h"

#include <limits.h>
#include <string.h>

#include "app/scene/overlap.h"
#include "base/files/digest.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "overlap/hybrid/hybrid.h"
#include "overlap/source.h"
#include "overlap/weights.h"

static void record_digest(Record *record, const char *key, uint64_t digest) {
  char text[DIGEST_TEXT];
  digest_print(digest, text);
  record_text(record, key, text);
}

// Places and elements of each body or obstacle with a mesh are its shape; and which coordinates are
// prescribed.
static void record_meshes(const FemModel *model, Record *record, Record *shapes) {
  for (int b = 0; b < model->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    size_t first = 3 * (size_t)body->vertex_begin,
           values = 3 * (size_t)(body->vertex_end - body->vertex_begin);
    uint64_t digest = digest_bytes(DIGEST_START, model->rest + first, values * sizeof *model->rest);
    digest = digest_bytes(digest, model->tets[body->tet_begin],
                          (size_t)(body->tet_end - body->tet_begin) * sizeof *model->tets);
    record_digest(shapes, body->name ? body->name : "?", digest);
    digest = digest_bytes(digest, model->is_prescribed + first, values * sizeof *model->is_prescribed);
    record_digest(record, body->name ? body->name : "?", digest);
  }
}

// The file with the weights of the scene's overlap model; "": it has none.
static void find_weights(const FemSceneDef *scene, char path[PATH_MAX]) {
  static const char HYBRID[] = "hybrid";
  char source[PATH_MAX];
  path[0] = 0;
  if (!app_scene_overlap_source(scene, source)) return;
  if (app_model_names_locate(source, path)) {
    const char *file;
    path[overlap_source_path(path, &file)] = 0; // a Python file without the function's name
    return;
  }
  const char *name = overlap_source_model(source);
  if (strcmp(name, HYBRID) == 0) name = OVERLAP_HYBRID_NETWORK;
  if (overlap_weights_find(name, path, PATH_MAX) != STATUS_OK) path[0] = 0;
}

static Status record_weights(const FemSceneDef *scene, Record *record) {
  char path[PATH_MAX], *content;
  size_t size;
  find_weights(scene, path);
  record_text(record, "weights_file", path);
  record_text(record, "weights", "none");
  if (!path[0]) return STATUS_OK;
  TRY(file_read(path, &content, &size));
  record_digest(record, "weights", digest_bytes(DIGEST_START, content, size));
  memory_free(content);
  return STATUS_OK;
}

Status app_inputs_record(const FemSceneDef *scene, const FemModel *model, Record *record) {
  Record *meshes = record_child(record, "meshes"), *shapes = record_child(record, "shapes");
  record_meshes(model, meshes, shapes);
  return record_weights(scene, record);
}

bool app_inputs_differ(const Record *was, const Record *is) {
  RecordDifference difference;
  return !was || !is || record_differ(record_find(was, "meshes"), record_find(is, "meshes"), &difference) ||
         record_differ(record_find(was, "weights"), record_find(is, "weights"), &difference) ||
         record_differ(record_find(was, "start"), record_find(is, "start"), &difference);
}
