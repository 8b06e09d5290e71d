// SPDX-License-Identifier: Apache-2.0
#include "device/network/tpn.h"

#include <string.h>

#include "base/memory.h"
#include "device/kernels/tpn/steps.h"
#include "device/network/pack.h"
#include "overlap/tpn/network.h"
#include "overlap/weights.h"

enum { VOLUME_OUTPUT = 1, MAX_VIEWS = 160 };

// Which matrices are in the group's memory, and where: rows of TPN_PAIRS numbers.
typedef struct Layout {
  const NetPlan *plan;
  int first[NET_MAX_SLOTS];              // −1: not there
  int last[NET_MAX_SLOTS];               // the last step that needs it, −1: none
  int largest;                           // rows in use at most
  int slopes[NET_MAX_SLOTS], slope_rows; // of the derivatives, which follow the values; −1: not there
} Layout;

// What the program that rounds factors takes, besides: the parameters with rounded weights, and these weights
// as fragments, of step k from forward[k] on, their transpose from backward[k] on.
typedef struct Rounded {
  float *parameters; // owned                              (parameter_count)
  unsigned *words;   // owned                              (word_count)
  size_t word_count;
  int forward[NET_MAX_STEPS], backward[NET_MAX_STEPS];
} Rounded;

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

// All that are needed, one after another; then their derivatives, which some share (net/model/plan.h).
static void place_with_slopes(Layout *layout) {
  const NetPlan *plan = layout->plan;
  find_last_uses(layout);
  for (int slot = 0; slot < plan->slot_count; slot++) {
    layout->slopes[slot] = -1;
    if (layout->last[slot] < 0) continue;
    layout->first[slot] = layout->largest;
    layout->largest += rows_of(plan, slot);
  }
  for (int slot = 0; slot < plan->slot_count; slot++) {
    if (layout->first[slot] < 0 || layout->slopes[slot] >= 0) continue;
    int rows = 0;
    for (int other = slot; other < plan->slot_count; other++)
      if (layout->first[other] >= 0 &&
          plan->slots[other].gradient_offset == plan->slots[slot].gradient_offset) {
        layout->slopes[other] = layout->largest + layout->slope_rows;
        rows = rows_of(plan, other) > rows ? rows_of(plan, other) : rows;
      }
    layout->slope_rows += rows;
  }
}

static Status refuse(const char *what) {
  return status_fail(STATUS_INPUT, "the device kernels cannot evaluate this network: %s", what);
}

static Status check(const Layout *layout, int room) {
  const NetPlan *plan = layout->plan;
  if (plan->shape.activation != NET_RELU || plan->shape.pool != NET_MAX)
    return refuse("only ReLU and max pooling are supported");
  if (layout->largest + layout->slope_rows > room)
    return refuse("it is too wide for the memory of a work group");
  return STATUS_OK;
}

static void fill_step(const Layout *layout, const Rounded *rounded, int k, int *to) {
  const NetPlan *plan = layout->plan;
  const NetStep *step = &plan->steps[k];
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
  to[STEP_PART] = step->part;
  to[STEP_PART_COUNT] = step->part_count;
  to[STEP_INPUT_SLOPE] = layout->slopes[step->input] + step->input_row * in->spread;
  to[STEP_OUTPUT_SLOPE] = layout->slopes[step->output] + step->output_row * out->spread;
  to[STEP_IS_RAW] = step->reads_input;
  to[STEP_PACKED] = rounded->forward[k];
  to[STEP_PACKED_BACK] = rounded->backward[k];
}

static int fill_steps(const Layout *layout, const Rounded *rounded, int *steps) {
  int count = 0;
  for (int k = 0; k < layout->plan->step_count; k++)
    if (is_wanted(&layout->plan->steps[k])) fill_step(layout, rounded, k, steps + TPN_STEP * count++);
  return count;
}

// Each place that a coordinate goes to.
static int fill_views(const Layout *layout, int views[TPN_VIEW * MAX_VIEWS]) {
  const NetPlan *plan = layout->plan;
  int count = 0;
  for (int v = 0; v < plan->view_count; v++) {
    const NetView *view = &plan->views[v];
    const int spread = plan->slots[view->slot].spread;
    for (int k = 0; k < view->rows * spread && layout->first[view->slot] >= 0 && count < MAX_VIEWS; k++) {
      int *to = views + TPN_VIEW * count++;
      to[VIEW_ROW] = layout->first[view->slot] + view->first_row * spread + k;
      to[VIEW_COORDINATE] = view->index[k];
      to[VIEW_SLOPE] = layout->slopes[view->slot] + view->first_row * spread + k;
    }
  }
  return count;
}

static Status send(DeviceTpnPass *pass, const Device *device, const Layout *layout, const Rounded *rounded) {
  int steps[TPN_STEP * NET_MAX_STEPS], views[TPN_VIEW * MAX_VIEWS], sizes[TPN_PASS];
  const int output = layout->plan->output_slot;
  sizes[PASS_STEPS] = fill_steps(layout, rounded, steps);
  sizes[PASS_VIEWS] = fill_views(layout, views);
  sizes[PASS_OUTPUT] = layout->first[output] + VOLUME_OUTPUT;
  sizes[PASS_OUTPUT_SLOPE] = layout->slopes[output] + VOLUME_OUTPUT;
  sizes[PASS_SLOPES] = layout->largest;
  sizes[PASS_SLOPE_ROWS] = layout->slope_rows;
  TRY(device_take(device, (size_t)(TPN_STEP * sizes[PASS_STEPS]), sizeof *steps, steps, &pass->steps));
  TRY(device_take(device, (size_t)(TPN_VIEW * sizes[PASS_VIEWS]), sizeof *views, views, &pass->views));
  return device_take(device, TPN_PASS, sizeof *sizes, sizes, &pass->sizes);
}

// Multiplications and additions of the products that V takes.
static double flops_of(const NetPlan *plan) {
  double flops = 0;
  for (int k = 0; k < plan->step_count; k++) {
    const NetStep *step = &plan->steps[k];
    if (is_wanted(step) && step->kind == NET_STEP_LINEAR)
      flops += 2.0 * step->output_rows * step->input_rows * step->part_count;
  }
  return flops;
}

static bool is_rounded(const NetStep *step) {
  return is_wanted(step) && step->kind == NET_STEP_LINEAR && !step->reads_input;
}

// Whether a tensor is a factor of coordinates in one step, and of other numbers in another.
static bool has_mixed_weights(const NetPlan *plan) {
  for (int k = 0; k < plan->step_count; k++)
    for (int other = 0; other < plan->step_count && is_rounded(&plan->steps[k]); other++) {
      const NetStep *step = &plan->steps[other];
      if (is_wanted(step) && step->reads_input && step->weight == plan->steps[k].weight) return true;
    }
  return false;
}

static const NetTensor *weight_of(const NetPlan *plan, int step) {
  return &plan->tensors[plan->steps[step].weight];
}

// Gives each step its place among the words.
static void place_words(const NetPlan *plan, Rounded *rounded) {
  for (int k = 0; k < plan->step_count; k++) {
    rounded->forward[k] = rounded->backward[k] = -1;
    if (!is_rounded(&plan->steps[k])) continue;
    const NetTensor *weight = weight_of(plan, k);
    rounded->forward[k] = (int)rounded->word_count;
    rounded->word_count += device_pack_size(weight->rows, weight->columns);
    rounded->backward[k] = (int)rounded->word_count;
    rounded->word_count += device_pack_size(weight->columns, weight->rows);
  }
}

static void fill_words(const NetPlan *plan, Rounded *rounded) {
  for (int k = 0; k < plan->step_count; k++) {
    if (rounded->forward[k] < 0) continue;
    const NetTensor *weight = weight_of(plan, k);
    const int rows = weight->rows, columns = weight->columns;
    float *at = rounded->parameters + weight->offset;
    for (size_t e = 0; e < net_plan_tensor_size(weight); e++) at[e] = device_pack_round(at[e]);
    device_pack_matrix(rows, columns, at, columns, 1, rounded->words + rounded->forward[k]);
    device_pack_matrix(columns, rows, at, 1, columns, rounded->words + rounded->backward[k]);
  }
}

static void destroy_rounded(Rounded *rounded) {
  memory_free(rounded->parameters);
  memory_free(rounded->words);
}

// Without is_bf16 the parameters as they are.
static Status create_rounded(Rounded *rounded, const NetModel_f32 *model, bool is_bf16) {
  const NetPlan *plan = model->plan;
  *rounded = (Rounded){0};
  rounded->parameters = memory_copy(model->parameters, plan->parameter_count, sizeof(float));
  if (!rounded->parameters) return status_no_memory("a network's parameters");
  if (!is_bf16) return STATUS_OK;
  if (has_mixed_weights(plan))
    return refuse("coordinates share weights with other numbers, which bf16 rounds");
  place_words(plan, rounded);
  if (!(rounded->words = memory_zeroed(rounded->word_count, sizeof *rounded->words)))
    return status_no_memory("a network's parameters");
  fill_words(plan, rounded);
  return STATUS_OK;
}

static Status send_parameters(DeviceTpn *tpn, const Device *device, const NetPlan *plan,
                              const Rounded *rounded) {
  TRY(device_take(device, plan->parameter_count, sizeof(float), rounded->parameters, &tpn->parameters));
  if (!rounded->words) return STATUS_OK;
  return device_take(device, rounded->word_count, sizeof(unsigned), rounded->words, &tpn->packed);
}

static Status send_all(DeviceTpn *tpn, const Device *device, const OverlapTpnNetwork *network,
                       const Rounded *rounded) {
  const NetPlan *plan = network->network.plan;
  Layout volume = {.plan = plan}, gradient = {.plan = plan};
  place_all(&volume);
  place_with_slopes(&gradient);
  TRY(check(&volume, TPN_ROOM));
  TRY(check(&gradient, TPN_SLOPE_ROOM));
  tpn->scale = network->scale;
  tpn->normalisation = (int)network->kind;
  tpn->flops = flops_of(plan);
  TRY(send(&tpn->volume, device, &volume, rounded));
  TRY(send(&tpn->gradient, device, &gradient, rounded));
  return send_parameters(tpn, device, plan, rounded);
}

static Status send_network(DeviceTpn *tpn, const Device *device, const OverlapTpnNetwork *network,
                           bool is_bf16) {
  Rounded rounded;
  Status status = create_rounded(&rounded, &network->network, is_bf16);
  if (status == STATUS_OK) status = send_all(tpn, device, network, &rounded);
  destroy_rounded(&rounded);
  return status;
}

static bool is_known(OverlapTpnNormalisation kind) {
  return kind != OVERLAP_TPN_NORMALISE_PCA;
}

Status device_tpn_create(DeviceTpn *tpn, const Device *device, const char *weights, bool is_bf16) {
  char path[4096];
  OverlapTpnNetwork network;
  *tpn = (DeviceTpn){0};
  TRY(overlap_weights_find(weights, path, sizeof path));
  TRY(overlap_tpn_network_create(&network, path, net_kernel_best(), 1));
  Status status = is_known(network.kind) ? send_network(tpn, device, &network, is_bf16)
                                         : refuse("the normalisation 'pca' is not supported");
  overlap_tpn_network_destroy(&network);
  return status;
}

static void destroy_pass(DeviceTpnPass *pass, const Device *device) {
  device->ops->release(device->self, &pass->sizes);
  device->ops->release(device->self, &pass->steps);
  device->ops->release(device->self, &pass->views);
}

void device_tpn_destroy(DeviceTpn *tpn, const Device *device) {
  destroy_pass(&tpn->volume, device), destroy_pass(&tpn->gradient, device);
  DeviceMemory *const all[] = {&tpn->parameters, &tpn->packed, &tpn->shown, &tpn->factor};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) device->ops->release(device->self, all[k]);
  *tpn = (DeviceTpn){0};
}

Status device_tpn_make_room(DeviceTpn *tpn, const Device *device, int count) {
  if (count <= tpn->room) return STATUS_OK;
  tpn->room = 0;
  device->ops->release(device->self, &tpn->shown);
  device->ops->release(device->self, &tpn->factor);
  TRY(device_take(device, TPN_ROWS * (size_t)count, sizeof(float), NULL, &tpn->shown));
  TRY(device_take(device, (size_t)count, sizeof(double), NULL, &tpn->factor));
  tpn->room = count;
  return STATUS_OK;
}

int device_tpn_table(const DeviceTpn *tpn, DeviceArgument *arguments) {
  const DeviceArgument given[] = {device_memory(&tpn->shown), device_memory(&tpn->factor),
                                  device_int(tpn->room), device_int(tpn->normalisation)};
  memcpy(arguments, given, sizeof given);
  return sizeof given / sizeof *given;
}

int device_tpn_arguments(const DeviceTpn *tpn, bool has_gradient, int count, DeviceArgument *arguments) {
  const DeviceTpnPass *pass = has_gradient ? &tpn->gradient : &tpn->volume;
  const DeviceArgument given[] = {device_int(count),
                                  device_memory(&tpn->shown),
                                  device_int(tpn->room),
                                  device_memory(&pass->sizes),
                                  device_memory(&pass->steps),
                                  device_memory(&pass->views),
                                  device_memory(&tpn->parameters),
                                  device_memory(&tpn->packed),
                                  device_memory(&tpn->factor), // of the gradient's, with what follows
                                  device_double(tpn->scale)};
  memcpy(arguments, given, sizeof given);
  return has_gradient ? sizeof given / sizeof *given : sizeof given / sizeof *given - 2;
}

int device_tpn_groups(bool has_gradient, int count) {
  const int pairs = has_gradient ? TPN_SLOPE_PAIRS : TPN_PAIRS;
  return count / pairs + (count % pairs > 0);
}
