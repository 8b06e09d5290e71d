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

static_assert((int)NET_COLUMN_UNIT == (int)OVERLAP_GEO_CHUNK, "a chunk is what net/ takes side by side");

// Memory of evaluation, used by one caller at a time.
typedef struct Workspace {
  atomic_flag is_taken;
  NetWork_f64 work;
} Workspace;

struct OverlapGeoNet {
  NetModel_f64 model;
  NetCard card;
  double *of_first; // 1 for ρ, 0 for all other outputs     (OVERLAP_GEO_CHUNK, outputs)
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

static int outputs_of(const OverlapGeoNet *net) {
  return net->model.plan->shape.output_count;
}

// ρ of pairs that a chunk holds, by all outputs of the network.
static void eval_chunk(const OverlapGeoNet *net, Workspace *workspace, int count, const double *features,
                       double *value, double *gradient) {
  double outputs[OVERLAP_GEO_CHUNK * (1 + OVERLAP_GEO_MAX_PLANE_FEATURES)];
  if (gradient)
    net_forward_gradient_f64(&workspace->work, &net->model, count, features, net->of_first, outputs,
                             gradient);
  else
    net_forward_eval_f64(&workspace->work, &net->model, count, features, outputs);
  for (int n = 0; n < count; n++) value[n] = outputs[n * outputs_of(net)];
}

static Status eval(const void *self, int count, const double *features, double *value, double *gradient) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  ptrdiff_t size = net->model.plan->shape.input_count;
  for (int first = 0; first < count; first += OVERLAP_GEO_CHUNK)
    eval_chunk(net, workspace, count - first < OVERLAP_GEO_CHUNK ? count - first : OVERLAP_GEO_CHUNK,
               features + first * size, value + first, gradient ? gradient + first * size : NULL);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status eval_columns(const void *self, const double *features, int output_count, double *outputs,
                           double *gradient) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  net_dense_eval_f64(&workspace->work, &net->model, output_count, features, outputs, gradient);
  release_workspace(workspace);
  return STATUS_OK;
}

static Status pull(const void *self, const double *features, int count, const double *seeds, double *outputs,
                   double *slopes) {
  enum { MOST_SEEDS = 3 };
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  double rows[MOST_SEEDS * OVERLAP_GEO_MAX_FEATURES];
  size_t size = (size_t)net->model.plan->shape.input_count;
  for (int n = 0; n < count; n++) memcpy(rows + size * (size_t)n, features, size * sizeof *rows);
  workspace->work.outputs = UINT64_MAX;
  net_forward_eval_f64(&workspace->work, &net->model, 1, features, outputs);
  net_forward_gradient_f64(&workspace->work, &net->model, count, rows, seeds, NULL, slopes);
  workspace->work.outputs = 1;
  release_workspace(workspace);
  return STATUS_OK;
}

static Status curve(const void *self, int count, const double *features, int direction_count,
                    const double *directions, double *second) {
  const OverlapGeoNet *net = self;
  Workspace *workspace = acquire_workspace(net);
  net_tangent_second_f64(&workspace->work, &net->model, count, direction_count, features, directions,
                         net->of_first, NULL, NULL, NULL, second);
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

static Status check(const OverlapGeoNet *net, const char *path, const char *normalisation) {
  const NetShape *shape = &net->model.plan->shape;
  if (!net_dense_is_possible(shape))
    return status_fail(STATUS_INPUT, "%s: geo needs a dense SiLU network, this is another", path);
  if (!overlap_geo_features_set(shape->input_count))
    return status_fail(
        STATUS_INPUT,
        "%s: the network has %d inputs; expected a number of a pair's features: " OVERLAP_GEO_FEATURE_COUNTS,
        path, shape->input_count);
  int planes = overlap_geo_features_plane_count(overlap_geo_features_set(shape->input_count));
  if (shape->output_count != 1 && shape->output_count != 1 + planes)
    return status_fail(STATUS_INPUT, "%s: the network has %d outputs; geo needs one, or with the centroid %d",
                       path, shape->output_count, 1 + planes);
  if (strcmp(net->card.normalisation, normalisation) != 0)
    return status_fail(STATUS_INPUT, "%s: made for the normalisation '%s', here '%s' is needed", path,
                       net->card.normalisation, normalisation);
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
    net->workspaces[d].work.outputs = 1; // derivatives are those of ρ
  }
  return STATUS_OK;
}

static Status load(OverlapGeoNet *net, const char *path, const char *normalisation) {
  NetStatus status = net_weights_read_f64(path, &net->model, &net->card);
  if (status != NET_OK) return fail_as_net(status);
  TRY(check(net, path, normalisation));
  net->of_first = memory_zeroed((size_t)(OVERLAP_GEO_CHUNK * outputs_of(net)), sizeof *net->of_first);
  if (!net->of_first) return status_no_memory("a network");
  for (int n = 0; n < OVERLAP_GEO_CHUNK; n++) net->of_first[n * outputs_of(net)] = 1;
  return create_workspaces(net);
}

static Status create(OverlapGeoNet **net, const char *path, const char *normalisation) {
  *net = memory_zeroed(1, sizeof **net);
  if (!*net) return status_no_memory("a network");
  Status status = load(*net, path, normalisation);
  if (status == STATUS_OK) return STATUS_OK;
  overlap_geo_network_destroy(*net);
  *net = NULL;
  return status;
}

Status overlap_geo_network_create(OverlapGeoNet **net, const char *path) {
  return create(net, path, OVERLAP_GEO_NORMALISATION);
}

Status overlap_geo_network_create_bound(OverlapGeoNet **net, const char *path) {
  return create(net, path, OVERLAP_GEO_BOUND_NORMALISATION);
}

void overlap_geo_network_destroy(OverlapGeoNet *net) {
  if (!net) return;
  for (int d = 0; d < net->workspace_count && net->workspaces; d++)
    net_work_destroy_f64(&net->workspaces[d].work);
  memory_free(net->workspaces);
  memory_free(net->of_first);
  net_weights_card_destroy(&net->card);
  net_model_destroy_f64(&net->model);
  memory_free(net);
}

const NetModel_f64 *overlap_geo_network_model(const OverlapGeoNet *net) {
  return &net->model;
}

Status overlap_geo_network_write(const OverlapGeoNet *net, const double *numbers, const char *path) {
  NetModel_f64 other = net->model; // of which the parameters alone are another's
  other.parameters = (double *)numbers;
  NetStatus status = net_weights_write_f64(path, &other, &net->card);
  return status == NET_OK ? STATUS_OK : fail_as_net(status);
}

OverlapGeoNetwork overlap_geo_network_interface(const OverlapGeoNet *net) {
  return (OverlapGeoNetwork){.self = net,
                             .feature_count = net->model.plan->shape.input_count,
                             .eval = eval,
                             .eval_columns = eval_columns,
                             .pull = pull,
                             .curve = curve,
                             .curve_columns = curve_columns,
                             .has_centroid = outputs_of(net) > 1};
}
