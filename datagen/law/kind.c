// SPDX-License-Identifier: GPL-3.0-or-later
#include "datagen/law/kind.h"

#include <string.h>

#include "base/text.h"

static const DatagenKindInfo kinds[DATAGEN_KIND_COUNT] = {
    [DATAGEN_NONE] = {"none", "disjoint, uniform in the unit cube", -1, {3, 3}},
    [DATAGEN_VERTEX_FACE] = {"vertex-face", "a vertex of the second in a face of the first", 0, {2, 0}},
    [DATAGEN_EDGE_FACE] = {"edge-face", "an edge of the second in a face of the first", 1, {2, 1}},
    [DATAGEN_FACE_FACE] = {"face-face", "two faces in one plane share a polygon", 2, {2, 2}},
    [DATAGEN_VOLUMETRIC] = {"volumetric", "uniform in the unit cube, V by the volume law", 3, {3, 3}},
    [DATAGEN_VERTEX_VERTEX] = {"vertex-vertex", "a common vertex and nothing else", 0, {0, 0}},
    [DATAGEN_VERTEX_EDGE] = {"vertex-edge", "a vertex of the second in an edge of the first", 0, {1, 0}},
    [DATAGEN_EDGE_EDGE] = {"edge-edge", "two edges cross in a point", 0, {1, 1}},
    [DATAGEN_SCENE] = {"scene", "elements of two meshes pressed together, intersecting", 3, {3, 3}},
    [DATAGEN_SCENE_NONE] = {"scene-none", "elements of two meshes, boxes overlap, disjoint", -1, {3, 3}},
    [DATAGEN_CAPTURED] = {"captured", "from a run of a scene", 3, {3, 3}},
};

const DatagenKindInfo *datagen_kind_info(int kind) {
  return kind >= 0 && kind < DATAGEN_KIND_COUNT ? &kinds[kind] : NULL;
}

Status datagen_kind_find(const char *name, DatagenKind *kind) {
  char known[256] = "";
  size_t used = 0;
  TextGuess guess = text_guess_of(name);
  for (int k = 0; k < DATAGEN_KIND_COUNT; k++) {
    if (strcmp(kinds[k].name, name) == 0) {
      *kind = (DatagenKind)k;
      return STATUS_OK;
    }
    text_append(known, sizeof known, &used, "%s%s", k ? ", " : "", kinds[k].name);
    text_guess_offer(&guess, kinds[k].name);
  }
  if (guess.best)
    return status_fail(STATUS_USAGE, "there is no kind of pair '%s': did you mean '%s'? Known are %s", name,
                       guess.best, known);
  return status_fail(STATUS_USAGE, "there is no kind of pair '%s': known are %s", name, known);
}
