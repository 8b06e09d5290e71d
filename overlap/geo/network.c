// SPDX-License-Identifier: Apache-2.0
#include "overlap/geo/network.h"

#include <assert.h>
#include <omp.h>
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "net/dense.h"
#include "net/pass/forward.h"
#include "net/pass/tangent.h"
#include "net/work.h"

enum { DIRECTIONS = 12 };

// What the derivative of ρ itself weighs its one output with, for each pair.
static const double ones[] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
static_assert(sizeof ones / sizeof *ones == OVERLAP_GEO_CHUNK, "one for each pair of a chunk");
static_assert((int)NET_COLUMN_UNIT == (int)OVERLAP_GEO_CHUNK, "a chunk is what net/ takes side by side");

// Memory of evaluation, used by one caller at a time.
typedef struct Workspace {
  atomic_flag is_taken;
  NetWork_f64 work;
} Workspace;

struct OverlapGeoNet {
  NetModel_f64 model;
  NetCard card;
  int workspace_count;
  Workspace *workspaces; // (workspace_count)
};

static Status fail_as_net(NetStatus status) {
  Status code = status == NET_NO_MEMORY ? STATUS_MEMORY : status == NET_BAD_IO ? STATUS_IO : STATUS_INPUT;
  return status_fail(code, "%s", net_status_message());
}

// A thread's own workspace as a rule; another one if threads that OpenMP does not count are about.
static Workspace *acquire_workspace(const OverlapGeoNet *net) {
  for (int d = omp_get_thread_num();; d++) {
    Workspace *workspace = &net->workspaces[d % net->workspace_count];
    if (!atomic_flag_test_and_set_explicit(&workspace->is_taken, memory_order_acquire)) return workspace;
  }
}

static void release_workspace(Workspace *workspace) {
  atomic_flag_clear_explicit(&workspace->is_taken, memory_order_release);
}

static Status eval(const void *self, int count, const double *features, double *value, double *gradient) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  if (gradient)
    net_forward_gradient_f64(&workspace->work, &net->model, count, features, ones, value, gradient);
  else
    net_forward_eval_f64(&workspace->work, &net->model, count, features, value);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status eval_columns(const void *self, const double *features, double *value, double *gradient) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  net_dense_eval_f64(&workspace->work, &net->model, features, value, gradient);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status curve(const void *self, int count, const double *features, int direction_count,
                    const double *directions, double *second) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  net_tangent_second_f64(&workspace->work, &net->model, count, direction_count, features, directions, ones,
                         NULL, NULL, NULL, second);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status curve_columns(const void *self, const double *features, double *second) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  net_dense_second_f64(&workspace->work, &net->model, DIRECTIONS, features, second);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status check(const OverlapGeoNet *net, const char *path) {
  const NetShape *shape = &net->model.plan->shape;
  if (!net_dense_is_possible(shape))
    return status_fail(STATUS_INPUT, "%s: geo needs a dense SiLU network with one output, this is another",
                       path);
  if (!overlap_geo_features_set(shape->input_count))
    return status_fail(STATUS_INPUT,
                       "%s: the network has %d inputs, the features of a pair are 36, 70 or 100", path,
                       shape->input_count);
  if (strcmp(net->card.normalisation, OVERLAP_GEO_NORMALISATION) != 0)
    return status_fail(STATUS_INPUT, "%s: made for the normalisation '%s', geo has '%s'", path,
                       net->card.normalisation, OVERLAP_GEO_NORMALISATION);
  return STATUS_OK;
}

static Status create_workspaces(OverlapGeoNet *net) {
  net->workspace_count = omp_get_max_threads();
  net->workspaces = memory_zeroed((size_t)net->workspace_count, sizeof *net->workspaces);
  if (!net->workspaces) return status_no_memory("the network's memory of evaluation");
  NetWorkDef def = net_work_default();
  def.tangent_count = DIRECTIONS;
  for (int d = 0; d < net->workspace_count; d++) {
    atomic_flag_clear(&net->workspaces[d].is_taken);
    NetStatus status = net_work_create_f64(net->model.plan, &def, &net->workspaces[d].work);
    if (status != NET_OK) return fail_as_net(status);
  }
  return STATUS_OK;
}

static Status load(OverlapGeoNet *net, const char *path) {
  NetStatus status = net_weights_read_f64(path, &net->model, &net->card);
  if (status != NET_OK) return fail_as_net(status);
  TRY(check(net, path));
  return create_workspaces(net);
}

Status overlap_geo_network_create(OverlapGeoNet **net, const char *path) {
  *net = memory_zeroed(1, sizeof **net);
  if (!*net) return status_no_memory("a network");
  Status status = load(*net, path);
  if (status == STATUS_OK) return STATUS_OK;
  overlap_geo_network_destroy(*net);
  *net = NULL;
  return status;
}

void overlap_geo_network_destroy(OverlapGeoNet *net) {
  if (!net) return;
  for (int d = 0; d < net->workspace_count && net->workspaces; d++)
    net_work_destroy_f64(&net->workspaces[d].work);
  memory_free(net->workspaces);
  net_weights_card_destroy(&net->card);
  net_model_destroy_f64(&net->model);
  memory_free(net);
}

OverlapGeoNetwork overlap_geo_network_interface(const OverlapGeoNet *net) {
  return (OverlapGeoNetwork){.self = net,
                             .feature_count = net->model.plan->shape.input_count,
                             .eval = eval,
                             .eval_columns = eval_columns,
                             .curve = curve,
                             .curve_columns = curve_columns};
}
