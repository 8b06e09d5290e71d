// SPDX-License-Identifier: Apache-2.0
#include "device/tpn.h"

#include <string.h>

#include "base/memory.h"
#include "device/kernels/tpn_steps.h"
#include "overlap/tpn/network.h"
#include "overlap/weights.h"

enum { VOLUME_OUTPUT = 1, MAX_VIEWS = 160 };

// Which matrices are in the group's memory, and where: rows of TPN_PAIRS numbers.
typedef struct Layout {
  const NetPlan *plan;
  int first[NET_MAX_SLOTS]; // −1: not there
  int last[NET_MAX_SLOTS];  // the last step that needs it, −1: none
  int largest;              // rows in use at most
} Layout;

static bool is_wanted(const NetStep *step) {
  return step->outputs >> VOLUME_OUTPUT & 1;
}

static int rows_of(const NetPlan *plan, int slot) {
  return plan->slots[slot].rows * plan->slots[slot].spread;
}

static void find_last_uses(Layout *layout) {
  const NetPlan *plan = layout->plan;
  for (int slot = 0; slot < plan->slot_count; slot++) layout->first[slot] = layout->last[slot] = -1;
  for (int k = 0; k < plan->step_count; k++) {
    const NetStep *step = &plan->steps[k];
    if (!is_wanted(step)) continue;
    layout->last[step->input] = layout->last[step->output] = k;
    if (step->base >= 0) layout->last[step->base] = k;
  }
  layout->last[plan->output_slot] = plan->step_count;
}

static bool is_free(const Layout *layout, int step, int first, int rows) {
  for (int slot = 0; slot < layout->plan->slot_count; slot++) {
    bool is_there = layout->first[slot] >= 0 && layout->last[slot] >= step;
    if (is_there && first < layout->first[slot] + rows_of(layout->plan, slot) &&
        layout->first[slot] < first + rows)
      return false;
  }
  return true;
}

// The first place where the matrix fits beside those that are still needed.
static void place(Layout *layout, int slot, int step) {
  const int rows = rows_of(layout->plan, slot);
  int first = 0;
  if (layout->first[slot] >= 0) return;
  while (!is_free(layout, step, first, rows)) first++;
  layout->first[slot] = first;
  if (first + rows > layout->largest) layout->largest = first + rows;
}

static void place_all(Layout *layout) {
  const NetPlan *plan = layout->plan;
  find_last_uses(layout);
  for (int v = 0; v < plan->view_count; v++)
    if (layout->last[plan->views[v].slot] >= 0) place(layout, plan->views[v].slot, 0);
  for (int k = 0; k < plan->step_count; k++)
    if (is_wanted(&plan->steps[k])) place(layout, plan->steps[k].output, k);
}

static Status refuse(const char *what) {
  return status_fail(STATUS_INPUT, "the kernels for devices cannot carry out this network: %s", what);
}

static Status check(const Layout *layout) {
  const NetPlan *plan = layout->plan;
  if (plan->shape.activation != NET_RELU || plan->shape.pool != NET_MAX)
    return refuse("they have rectifiers and pools of the largest only");
  if (layout->largest > TPN_ROOM) return refuse("it is too wide for a group's memory");
  for (int k = 0; k < plan->step_count; k++)
    if (plan->steps[k].kind == NET_STEP_LINEAR &&
        plan->steps[k].part_count != plan->slots[plan->steps[k].output].spread)
      return refuse("its vertices have a skip each");
  return STATUS_OK;
}

static void fill_step(const Layout *layout, const NetStep *step, int *to) {
  const NetPlan *plan = layout->plan;
  const NetSlot *in = &plan->slots[step->input], *out = &plan->slots[step->output];
  to[STEP_KIND] = step->kind == NET_STEP_LINEAR ? TPN_LINEAR
                  : step->kind == NET_STEP_POOL ? TPN_POOL
                                                : TPN_POOL_WITH;
  to[STEP_INPUT] = layout->first[step->input] + step->input_row * in->spread;
  to[STEP_INPUT_ROWS] = step->input_rows;
  to[STEP_OUTPUT] = layout->first[step->output] + step->output_row * out->spread;
  to[STEP_OUTPUT_ROWS] = step->output_rows;
  to[STEP_BASE] = step->base < 0 ? -1 : layout->first[step->base];
  to[STEP_WEIGHT] = step->weight < 0 ? -1 : (int)plan->tensors[step->weight].offset;
  to[STEP_WEIGHT_COLUMNS] = step->weight < 0 ? 0 : plan->tensors[step->weight].columns;
  to[STEP_BIAS] = step->bias < 0 ? -1 : (int)plan->tensors[step->bias].offset;
  to[STEP_RELU] = step->has_relu;
  to[STEP_COLUMNS] = out->spread;
  to[STEP_PARTS] = in->spread / out->spread;
}

static int fill_steps(const Layout *layout, int *steps) {
  int count = 0;
  for (int k = 0; k < layout->plan->step_count; k++)
    if (is_wanted(&layout->plan->steps[k]))
      fill_step(layout, &layout->plan->steps[k], steps + TPN_STEP * count++);
  return count;
}

// (row, coordinate) of each place that a coordinate goes to.
static int fill_views(const Layout *layout, int views[2 * MAX_VIEWS]) {
  const NetPlan *plan = layout->plan;
  int count = 0;
  for (int v = 0; v < plan->view_count; v++) {
    const NetView *view = &plan->views[v];
    const int spread = plan->slots[view->slot].spread;
    for (int k = 0; k < view->rows * spread && layout->first[view->slot] >= 0 && count < MAX_VIEWS; k++) {
      views[2 * count] = layout->first[view->slot] + view->first_row * spread + k;
      views[2 * count++ + 1] = view->index[k];
    }
  }
  return count;
}

static Status send(DeviceTpn *tpn, const Device *device, const OverlapTpnNetwork *network) {
  const NetPlan *plan = network->network.plan;
  int steps[TPN_STEP * NET_MAX_STEPS], views[2 * MAX_VIEWS];
  Layout layout = {.plan = plan};
  place_all(&layout);
  TRY(check(&layout));
  tpn->step_count = fill_steps(&layout, steps);
  tpn->view_count = fill_views(&layout, views);
  tpn->output_row = layout.first[plan->output_slot] + VOLUME_OUTPUT;
  tpn->scale = network->scale;
  TRY(device_take(device, (size_t)(TPN_STEP * tpn->step_count), sizeof *steps, steps, &tpn->steps));
  TRY(device_take(device, (size_t)(2 * tpn->view_count), sizeof *views, views, &tpn->views));
  return device_take(device, plan->parameter_count, sizeof(float), network->network.parameters,
                     &tpn->parameters);
}

Status device_tpn_create(DeviceTpn *tpn, const Device *device, const char *weights) {
  char path[4096];
  OverlapTpnNetwork network;
  *tpn = (DeviceTpn){0};
  TRY(overlap_weights_find(weights, path, sizeof path));
  TRY(overlap_tpn_network_create(&network, path, net_kernel_best(), 1));
  Status status = network.kind == OVERLAP_TPN_NORMALISE_SORTED
                      ? send(tpn, device, &network)
                      : refuse("they have the normalisation 'sorted' only");
  overlap_tpn_network_destroy(&network);
  return status;
}

void device_tpn_destroy(DeviceTpn *tpn, const Device *device) {
  device->ops->release(device->self, &tpn->steps);
  device->ops->release(device->self, &tpn->views);
  device->ops->release(device->self, &tpn->parameters);
  *tpn = (DeviceTpn){0};
}

int device_tpn_arguments(const DeviceTpn *tpn, DeviceArgument *arguments) {
  const DeviceArgument given[] = {device_memory(&tpn->steps),      device_int(tpn->step_count),
                                  device_memory(&tpn->views),      device_int(tpn->view_count),
                                  device_memory(&tpn->parameters), device_int(tpn->output_row),
                                  device_double(tpn->scale)};
  memcpy(arguments, given, sizeof given);
  return sizeof given / sizeof *given;
}

int device_tpn_groups(int count) {
  return count / TPN_PAIRS + (count % TPN_PAIRS > 0);
}
