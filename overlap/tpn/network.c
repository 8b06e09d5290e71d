// SPDX-License-Identifier: Apache-2.0
#include "overlap/tpn/network.h"

#include <assert.h>
#include <math.h>
#include <omp.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"

void overlap_tpn_network_print(OverlapTpnNormalisation kind, double scale,
                               char text[OVERLAP_TPN_NORMALISATION_TEXT]) {
  snprintf(text, OVERLAP_TPN_NORMALISATION_TEXT, "%s, V times %.17g", overlap_tpn_normalise_name(kind),
           scale);
}

bool overlap_tpn_network_parse(const char *text, OverlapTpnNormalisation *kind, double *scale) {
  char name[16];
  int used = 0;
  if (sscanf(text, "%15[a-z], V times %lf%n", name, scale, &used) != 2 || text[used]) return false;
  for (int k = 0; k < OVERLAP_TPN_NORMALISE_COUNT; k++) {
    *kind = (OverlapTpnNormalisation)k;
    if (strcmp(name, overlap_tpn_normalise_name(*kind)) == 0) return *scale > 0 && isfinite(*scale);
  }
  return false;
}

static Status fail_as_net(NetStatus status) {
  Status code = status == NET_NO_MEMORY ? STATUS_MEMORY : status == NET_BAD_IO ? STATUS_IO : STATUS_INPUT;
  return status_fail(code, "%s", net_status_message());
}

void overlap_tpn_network_destroy(OverlapTpnNetwork *model) {
  for (int d = 0; model->workspaces && d < model->workspace_count; d++) {
    net_work_destroy_f32(&model->workspaces[d].work);
    memory_free(model->workspaces[d].more);
  }
  memory_free(model->workspaces);
  net_weights_card_destroy(&model->card);
  net_model_destroy_f32(&model->network);
  *model = (OverlapTpnNetwork){0};
}

static Status create_workspaces(OverlapTpnNetwork *model, NetKernelKind kernel, size_t more) {
  model->workspace_count = omp_get_max_threads();
  model->workspaces = memory_zeroed((size_t)model->workspace_count, sizeof *model->workspaces);
  if (!model->workspaces) return status_no_memory("the network's memory of evaluation");
  NetWorkDef def = net_work_default();
  def.tangent_count = OVERLAP_TPN_TANGENTS;
  def.kernel = kernel;
  for (int d = 0; d < model->workspace_count; d++) {
    OverlapTpnWorkspace *workspace = &model->workspaces[d];
    atomic_flag_clear(&workspace->is_taken);
    workspace->more = memory_zeroed(1, more);
    if (!workspace->more) return status_no_memory("the network's memory of evaluation");
    NetStatus status = net_work_create_f32(model->network.plan, &def, &workspace->work);
    if (status != NET_OK) return fail_as_net(status);
  }
  return STATUS_OK;
}

// What the normalisation makes of every first tetrahedron, the network need not be shown.
static Status fold(OverlapTpnNetwork *model, const char *path) {
  const double *first = overlap_tpn_normalise_first(model->kind);
  bool has_one = model->network.plan->shape.has_one_tetrahedron;
  if (has_one && !first)
    return status_fail(STATUS_INPUT,
                       "%s: a network of the second tetrahedron alone cannot have the normalisation %s", path,
                       overlap_tpn_normalise_name(model->kind));
  model->input_first = first ? 12 : 0;
  if (!first || has_one) return STATUS_OK;
  float coordinates[12];
  for (int c = 0; c < 12; c++) coordinates[c] = (float)first[c];
  NetModel_f32 whole = model->network;
  NetStatus status = net_fold_create_f32(&whole, coordinates, &model->network);
  net_model_destroy_f32(&whole);
  return status == NET_OK ? STATUS_OK : fail_as_net(status);
}

static Status load(OverlapTpnNetwork *model, const char *path, NetKernelKind kernel, size_t more) {
  NetStatus status = net_weights_read_f32(path, &model->network, &model->card);
  if (status != NET_OK) return fail_as_net(status);
  if (model->network.plan->shape.kind != NET_TPN)
    return status_fail(STATUS_INPUT, "%s: a TetrahedronPairNet is needed, this is another network", path);
  if (!overlap_tpn_network_parse(model->card.normalisation, &model->kind, &model->scale))
    return status_fail(
        STATUS_INPUT,
        "%s: made for the normalisation '%s'; expected 'unit, V times NUMBER', 'pca, …', 'sorted, …', "
        "'unscaled, …' or 'axis, …'",
        path, model->card.normalisation);
  model->has_range = overlap_range_parse(model->card.range, &model->range);
  TRY(fold(model, path));
  return create_workspaces(model, kernel, more);
}

Status overlap_tpn_network_create(OverlapTpnNetwork *model, const char *path, NetKernelKind kernel,
                                  size_t more) {
  *model = (OverlapTpnNetwork){0};
  Status status = load(model, path, kernel, more);
  if (status != STATUS_OK) overlap_tpn_network_destroy(model);
  return status;
}

// There is one for each thread of the program that made the model; where more ask, those that wait let others
// run.
OverlapTpnWorkspace *overlap_tpn_network_acquire(const OverlapTpnNetwork *model) {
  int count = model->workspace_count, first = omp_get_thread_num() % count;
  for (int tried = 0;; tried = (tried + 1) % count) {
    OverlapTpnWorkspace *workspace = &model->workspaces[(first + tried) % count];
    if (!atomic_flag_test_and_set_explicit(&workspace->is_taken, memory_order_acquire)) {
      workspace->row_count = 0;
      return workspace;
    }
    if (tried == count - 1) sched_yield();
  }
}

void overlap_tpn_network_release(OverlapTpnWorkspace *workspace) {
  atomic_flag_clear_explicit(&workspace->is_taken, memory_order_release);
}

void overlap_tpn_network_add_row(const OverlapTpnNetwork *model, OverlapTpnWorkspace *workspace,
                                 const double pair[24]) {
  assert(workspace->row_count < OVERLAP_TPN_ROWS);
  int first = model->input_first, width = 24 - first;
  float *row = workspace->x + (ptrdiff_t)width * workspace->row_count++;
  for (int c = 0; c < width; c++) row[c] = (float)pair[first + c];
}

void overlap_tpn_network_pull(const OverlapTpnNetwork *model, const OverlapTpnWorkspace *workspace, int row,
                              double gradient[24]) {
  int first = model->input_first, width = 24 - first;
  for (int c = 0; c < first; c++) gradient[c] = 0;
  for (int c = 0; c < width; c++) gradient[first + c] = (double)workspace->gx[(ptrdiff_t)width * row + c];
}
