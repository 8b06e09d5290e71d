// SPDX-License-Identifier: Apache-2.0
// The C API's meshes: boxes, a sweep for those that overlap (sweep.h), the model for each, what has volume.
#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/api/argument.h"
#include "overlap/api/handle.h"
#include "overlap/api/sweep.h"

enum { SIZE = OVERLAP_PAIR_SIZE, HALF = SIZE / 2 };

// Pairs that the model is asked about at once.
enum { PORTION = 16384 };

// ---- What is given.

static void load_tet(const TetlapOverlapMesh *mesh, int tet, double x[HALF]) {
  for (int a = 0; a < 4; a++)
    memcpy(x + 3 * a, mesh->points + 3 * (size_t)mesh->tets[4 * (size_t)tet + (size_t)a], 3 * sizeof *x);
}

static OverlapApiBox *make_boxes(const TetlapOverlapMesh *mesh) {
  OverlapApiBox *boxes = memory_zeroed(mesh->tet_count, sizeof *boxes);
  for (int t = 0; boxes && t < (int)mesh->tet_count; t++) {
    double x[HALF];
    load_tet(mesh, t, x);
    for (int c = 0; c < 3; c++) {
      boxes[t].low[c] = fmin(fmin(x[c], x[3 + c]), fmin(x[6 + c], x[9 + c]));
      boxes[t].high[c] = fmax(fmax(x[c], x[3 + c]), fmax(x[6 + c], x[9 + c]));
    }
  }
  return boxes;
}

static Status find_candidates(const TetlapOverlapMesh meshes[2], OverlapApiCandidates *candidates) {
  OverlapApiBox *boxes[2] = {make_boxes(&meshes[0]), make_boxes(&meshes[1])};
  Status status = boxes[0] && boxes[1] ? overlap_api_sweep_find(boxes[0], (int)meshes[0].tet_count, boxes[1],
                                                                (int)meshes[1].tet_count, candidates)
                                       : status_no_memory("the boxes of a mesh");
  memory_free(boxes[0]);
  memory_free(boxes[1]);
  return status;
}

// ---- The answers.

// A list, and room for more in it.
typedef struct List {
  TetlapOverlapList shown; // the first member: what the caller has a pointer to
  unsigned wanted;
  size_t capacity[6];
} List;

static Status reserve(List *list, size_t count) {
  TetlapOverlapList *shown = &list->shown;
  bool has_gradient = list->wanted & TETLAP_OVERLAP_GRADIENT,
       has_centroid = list->wanted & TETLAP_OVERLAP_CENTROID;
  if (memory_reserve((void **)&shown->first, &list->capacity[0], count, sizeof *shown->first) &&
      memory_reserve((void **)&shown->second, &list->capacity[1], count, sizeof *shown->second) &&
      memory_reserve((void **)&shown->volume, &list->capacity[2], count, sizeof *shown->volume) &&
      memory_reserve((void **)&shown->flags, &list->capacity[3], count, sizeof *shown->flags) &&
      (!has_gradient ||
       memory_reserve((void **)&shown->gradient, &list->capacity[4], count, SIZE * sizeof(double))) &&
      (!has_centroid ||
       memory_reserve((void **)&shown->centroid, &list->capacity[5], count, 3 * sizeof(double))))
    return STATUS_OK;
  return status_no_memory("the list of overlaps");
}

// What the model is asked and says, a portion at a time.
typedef struct Portion {
  double *pairs, *gradient,
      *centroid; // (PORTION, 24), (PORTION, 24), (PORTION, 3); the latter two may be NULL
  double volume[PORTION];
  unsigned flags[PORTION];
} Portion;

static void destroy_portion(Portion *portion) {
  if (!portion) return;
  memory_free(portion->pairs);
  memory_free(portion->gradient);
  memory_free(portion->centroid);
  memory_free(portion);
}

static Portion *make_portion(unsigned wanted) {
  Portion *portion = memory_zeroed(1, sizeof *portion);
  if (!portion) return NULL;
  portion->pairs = memory_zeroed(PORTION, SIZE * sizeof *portion->pairs);
  if (wanted & TETLAP_OVERLAP_GRADIENT)
    portion->gradient = memory_zeroed(PORTION, SIZE * sizeof *portion->gradient);
  if (wanted & TETLAP_OVERLAP_CENTROID)
    portion->centroid = memory_zeroed(PORTION, 3 * sizeof *portion->centroid);
  if (portion->pairs && (portion->gradient || !(wanted & TETLAP_OVERLAP_GRADIENT)) &&
      (portion->centroid || !(wanted & TETLAP_OVERLAP_CENTROID)))
    return portion;
  destroy_portion(portion);
  return NULL;
}

static void append(List *list, OverlapApiCandidate pair, const Portion *portion, int k) {
  TetlapOverlapList *shown = &list->shown;
  size_t at = shown->count++;
  shown->first[at] = pair.first;
  shown->second[at] = pair.second;
  shown->volume[at] = portion->volume[k];
  shown->flags[at] = portion->flags[k];
  if (shown->gradient)
    memcpy(shown->gradient + SIZE * at, portion->gradient + SIZE * k, SIZE * sizeof(double));
  if (shown->centroid) memcpy(shown->centroid + 3 * at, portion->centroid + 3 * k, 3 * sizeof(double));
}

static Status answer_portion(const OverlapModel *model, const TetlapOverlapMesh meshes[2],
                             const OverlapApiCandidate *candidates, int count, Portion *portion, List *list) {
  for (int k = 0; k < count; k++) {
    load_tet(&meshes[0], candidates[k].first, portion->pairs + SIZE * k);
    load_tet(&meshes[1], candidates[k].second, portion->pairs + SIZE * k + HALF);
  }
  OverlapBatch batch = {.pair_count = count,
                        .pairs = portion->pairs,
                        .volume = portion->volume,
                        .gradient = portion->gradient,
                        .flags = portion->flags,
                        .centroid = portion->centroid};
  TRY(overlap_model_eval(model, &batch));
  TRY(reserve(list, list->shown.count + (size_t)count));
  for (int k = 0; k < count; k++)
    if (portion->volume[k] > 0) append(list, candidates[k], portion, k);
  return STATUS_OK;
}

static Status answer(const OverlapModel *model, const TetlapOverlapMesh meshes[2],
                     const OverlapApiCandidates *candidates, List *list) {
  Portion *portion = make_portion(list->wanted);
  Status status = portion ? STATUS_OK : status_no_memory("a portion of pairs");
  for (size_t begin = 0; begin < candidates->count && status == STATUS_OK; begin += PORTION) {
    size_t left = candidates->count - begin;
    status = answer_portion(model, meshes, candidates->at + begin, left < PORTION ? (int)left : PORTION,
                            portion, list);
  }
  destroy_portion(portion);
  return status;
}

static Status fill_list(const OverlapModel *model, const TetlapOverlapMesh meshes[2], List *list) {
  OverlapApiCandidates candidates = {0};
  Status status = find_candidates(meshes, &candidates);
  list->shown.candidates = candidates.count;
  if (status == STATUS_OK) status = reserve(list, 1);
  if (status == STATUS_OK) status = answer(model, meshes, &candidates, list);
  overlap_api_sweep_destroy(&candidates);
  return status;
}

// ---- The call.

static Status check_wanted(const TetlapOverlap *overlap, unsigned wanted) {
  const unsigned known = TETLAP_OVERLAP_VOLUME | TETLAP_OVERLAP_GRADIENT | TETLAP_OVERLAP_CENTROID;
  if (!overlap) return status_fail(STATUS_INPUT, "the handle is NULL");
  if (wanted & ~known)
    return status_fail(STATUS_INPUT, "meshes: only VOLUME, GRADIENT and CENTROID can be requested");
  return STATUS_OK;
}

static Status overlap_meshes(const TetlapOverlap *overlap, const TetlapOverlapMesh *a,
                             const TetlapOverlapMesh *b, unsigned wanted, TetlapOverlapList **shown) {
  TetlapOverlapMesh meshes[2];
  const TetlapOverlapMesh *given[2] = {a, b};
  if (!shown) return status_fail(STATUS_INPUT, "the list's place is NULL");
  *shown = NULL;
  TRY(check_wanted(overlap, wanted));
  for (int m = 0; m < 2; m++) TRY(overlap_api_argument_mesh(&meshes[m], given[m], m + 1));
  List *list = memory_zeroed(1, sizeof *list);
  if (!list) return status_no_memory("the list of overlaps");
  list->shown.size = sizeof list->shown;
  list->wanted = wanted;
  int before = overlap_api_handle_enter(overlap);
  Status status = fill_list(&overlap->model, meshes, list);
  overlap_api_handle_leave(before);
  if (status == STATUS_OK)
    *shown = &list->shown;
  else
    tetlap_overlap_list_free(&list->shown);
  return status;
}

int tetlap_overlap_meshes(const TetlapOverlap *overlap, const TetlapOverlapMesh *a,
                          const TetlapOverlapMesh *b, unsigned wanted, TetlapOverlapList **list) {
  return overlap_api_argument_status(overlap_meshes(overlap, a, b, wanted, list));
}

void tetlap_overlap_list_free(TetlapOverlapList *list) {
  if (!list) return;
  memory_free(list->first);
  memory_free(list->second);
  memory_free(list->volume);
  memory_free(list->gradient);
  memory_free(list->centroid);
  memory_free(list->flags);
  memory_free(list);
}
