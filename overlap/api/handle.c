// SPDX-License-Identifier: Apache-2.0
// The C API's models: opened, described, closed.
#include "overlap/api/handle.h"

#include <omp.h>
#include <string.h>

#include "base/memory.h"
#include "overlap/api/argument.h"
#include "overlap/models.h"

const char *tetlap_overlap_message(void) {
  return status_message();
}

const char *tetlap_overlap_version(void) {
  return TETLAP_VERSION;
}

const char *tetlap_overlap_model(int index) {
  int count;
  const OverlapOps *const *models = overlap_models_list(&count);
  return index >= 0 && index < count ? models[index]->name : NULL;
}

int overlap_api_handle_enter(const TetlapOverlap *overlap) {
  int before = omp_get_max_threads();
  if (overlap->threads > 0) omp_set_num_threads(overlap->threads);
  return before;
}

void overlap_api_handle_leave(int threads) {
  omp_set_num_threads(threads);
}

// What models keep for every thread is made for the handle's number of them.
static Status make(TetlapOverlap *overlap, const TetlapOverlapOptions *options) {
  overlap->threads = options->threads;
  int before = overlap_api_handle_enter(overlap);
  Status status = overlap_models_create_with(&overlap->model, options->model, options->weights, NULL);
  overlap_api_handle_leave(before);
  return status;
}

static Status open_with(TetlapOverlap **overlap, const TetlapOverlapOptions *given) {
  TetlapOverlapOptions options;
  if (!overlap) return status_fail(STATUS_INPUT, "the handle's place is NULL");
  *overlap = NULL;
  TRY(overlap_api_argument_copy(&options, sizeof options, sizeof options, given, "TetlapOverlapOptions"));
  if (!options.model)
    return status_fail(STATUS_INPUT, "no model is named: \"clip\" is fast and accurate; tetlap_overlap_model "
                                     "lists them");
  if (options.threads < 0)
    return status_fail(STATUS_INPUT, "%d threads: 0 (as many as OpenMP would use) or more are expected",
                       options.threads);
  TetlapOverlap *made = memory_zeroed(1, sizeof *made);
  if (!made) return status_no_memory("an overlap model");
  Status status = make(made, &options);
  if (status == STATUS_OK)
    *overlap = made;
  else
    memory_free(made);
  return status;
}

int tetlap_overlap_open_with(TetlapOverlap **overlap, const TetlapOverlapOptions *options) {
  return overlap_api_argument_status(open_with(overlap, options));
}

int tetlap_overlap_open(TetlapOverlap **overlap, const char *model) {
  TetlapOverlapOptions options = TETLAP_OVERLAP_OPTIONS_INIT;
  options.model = model;
  return tetlap_overlap_open_with(overlap, &options);
}

void tetlap_overlap_close(TetlapOverlap *overlap) {
  if (!overlap) return;
  overlap_model_destroy(&overlap->model);
  memory_free(overlap);
}

static Status describe(const TetlapOverlap *overlap, TetlapOverlapInfo *info) {
  TetlapOverlapInfo known;
  if (!overlap) return status_fail(STATUS_INPUT, "the handle is NULL");
  TRY(overlap_api_argument_copy(&known, sizeof known, sizeof known, info, "TetlapOverlapInfo"));
  const OverlapModel *model = &overlap->model;
  known.name = model->ops->name;
  known.description = model->ops->help;
  known.gives = TETLAP_OVERLAP_VOLUME | TETLAP_OVERLAP_GRADIENT | TETLAP_OVERLAP_CENTROID |
                (overlap_model_has_hessian(model) ? (unsigned)TETLAP_OVERLAP_HESSIAN : 0);
  known.threads = overlap->threads > 0 ? overlap->threads : omp_get_max_threads();
  known.seconds_per_pair = model->ops->seconds_per_pair;
  memcpy(info, &known, known.size < sizeof known ? known.size : sizeof known);
  return STATUS_OK;
}

int tetlap_overlap_info(const TetlapOverlap *overlap, TetlapOverlapInfo *info) {
  return overlap_api_argument_status(describe(overlap, info));
}
