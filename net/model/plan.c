// SPDX-License-Identifier: Apache-2.0
#include "net/model/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A run of rows in a slot: what one block hands to the next.
typedef struct Rows {
  int slot, first, count;
} Rows;

static int add_slot(NetPlan *plan, int rows, int spread) {
  NetSlot *slot = &plan->slots[plan->slot_count];
  *slot = (NetSlot){
      .rows = rows, .spread = spread, .offset = plan->value_rows, .gradient_offset = plan->gradient_rows};
  plan->value_rows += (size_t)(rows * spread);
  plan->gradient_rows += (size_t)(rows * spread);
  return plan->slot_count++;
}

static int add_tensor(NetPlan *plan, const char *block, const char *leaf, int rows, int columns,
                      double bound) {
  NetTensor *tensor = &plan->tensors[plan->tensor_count];
  *tensor = (NetTensor){.rows = rows, .columns = columns, .offset = plan->parameter_count, .bound = bound};
  snprintf(tensor->name, sizeof tensor->name, "%.20s.%s", block, leaf);
  plan->parameter_count += net_plan_tensor_size(tensor);
  return plan->tensor_count++;
}

// Initial weights: He et al. (2015), eq. 10, uniform: variance 2/fan_in before a rectifier (bound
// √(6/fan_in)), 1/fan_in (bound √(3/fan_in)) where nothing is rectified. Biases begin at 0.
static NetStep *add_linear(NetPlan *plan, const char *name, Rows in, Rows out, bool has_bias,
                           bool is_rectified) {
  NetStep *step = &plan->steps[plan->step_count++];
  *step = (NetStep){
      .kind = NET_STEP_LINEAR,
      .input = in.slot,
      .input_row = in.first,
      .input_rows = in.count,
      .output = out.slot,
      .output_row = out.first,
      .output_rows = out.count,
      .base = -1,
      .bias = -1,
      .part_count = plan->slots[out.slot].spread,
  };
  step->weight =
      add_tensor(plan, name, "weight", out.count, in.count, sqrt((is_rectified ? 6.0 : 3.0) / in.count));
  if (has_bias) step->bias = add_tensor(plan, name, "bias", out.count, 0, 0);
  return step;
}

static void mark_readers(NetPlan *plan) {
  for (int k = 0; k < plan->step_count; k++)
    for (int v = 0; v < plan->view_count; v++)
      if (plan->steps[k].kind == NET_STEP_LINEAR && plan->steps[k].input == plan->views[v].slot &&
          plan->steps[k].input_row == plan->views[v].first_row)
        plan->steps[k].reads_input = true;
}

// From the last step back: what reads a slot is reached by what reads its own output.
static void mark_outputs(NetPlan *plan) {
  uint64_t reached[NET_MAX_SLOTS] = {0};
  for (int k = plan->step_count - 1; k >= 0; k--) {
    NetStep *step = &plan->steps[k];
    step->outputs = reached[step->output];
    for (int r = 0; r < step->output_rows && step->output == plan->output_slot; r++)
      step->outputs |= (uint64_t)1 << (step->output_row + r);
    reached[step->input] |= step->outputs;
    if (step->base >= 0) reached[step->base] |= step->outputs;
  }
}

static void count_flops(NetPlan *plan) {
  for (int k = 0; k < plan->step_count; k++) {
    const NetStep *step = &plan->steps[k];
    if (step->kind == NET_STEP_LINEAR)
      plan->flops += 2.0 * step->input_rows * step->output_rows * step->part_count;
  }
}

// One hidden layer. The rectifier works in place; SiLU keeps what it was applied to, for its derivative.
static void add_layer(NetPlan *plan, const char *name, Rows in, Rows out) {
  if (plan->shape.activation == NET_RELU) {
    add_linear(plan, name, in, out, true, true)->has_relu = true;
    return;
  }
  Rows before = {add_slot(plan, out.count, plan->slots[out.slot].spread), 0, out.count};
  add_linear(plan, name, in, before, true, true);
  plan->steps[plan->step_count++] = (NetStep){
      .kind = NET_STEP_ACTIVATE,
      .input = before.slot,
      .input_rows = out.count,
      .output = out.slot,
      .output_row = out.first,
      .output_rows = out.count,
      .base = -1,
      .weight = -1,
      .bias = -1,
      .part_count = plan->slots[out.slot].spread,
  };
}

// Hidden layers from `in`; the last one writes to rows `out`, or to a new slot where out.slot is negative.
static Rows add_layers(NetPlan *plan, const char *block, Rows in, const NetWidths *widths, Rows out) {
  for (int k = 0; k < widths->count; k++) {
    char name[NET_NAME_SIZE];
    snprintf(name, sizeof name, "%s.%d", block, k);
    bool is_given = k == widths->count - 1 && out.slot >= 0;
    Rows next =
        is_given ? out
                 : (Rows){add_slot(plan, widths->width[k], plan->slots[in.slot].spread), 0, widths->width[k]};
    add_layer(plan, name, in, next);
    in = next;
  }
  return in;
}

// out = base + S raw (+ c). The derivative with respect to base is the one with respect to out: they share
// it.
static void add_skip(NetPlan *plan, const char *name, NetSkip skip, Rows raw, Rows base, Rows out) {
  const NetSlot *target = &plan->slots[out.slot];
  int count = skip == NET_SKIP_PER_INDEX ? 4 : 1;
  for (int k = 0; k < count; k++) {
    char numbered[NET_NAME_SIZE];
    snprintf(numbered, sizeof numbered, count == 1 ? "%.20s" : "%.20s.%d", name, k);
    NetStep *step = add_linear(plan, numbered, raw, out, skip == NET_SKIP_BIASED, false);
    step->base = base.slot;
    step->part_count = target->spread / count;
    step->part = k * step->part_count;
  }
  plan->slots[base.slot].gradient_offset = target->gradient_offset + (size_t)(out.first * target->spread);
}

// A block: hidden layers from `in`, then the skip from `raw`, into the first rows of a slot with `extra` rows
// more.
static Rows add_block(NetPlan *plan, const char *block, Rows in, const NetWidths *widths, NetSkip skip,
                      Rows raw, Rows out) {
  if (skip == NET_SKIP_NONE) return add_layers(plan, block, in, widths, out);
  Rows none = {-1, 0, 0};
  Rows base = add_layers(plan, block, in, widths, none);
  char name[NET_NAME_SIZE];
  snprintf(name, sizeof name, "%s_skip", block);
  add_skip(plan, name, skip, raw, base, out);
  return out;
}

static int add_pool(NetPlan *plan, int input, int spread) {
  int output = add_slot(plan, plan->slots[input].rows, spread);
  int rows = plan->slots[input].rows;
  plan->steps[plan->step_count++] = (NetStep){
      .kind = NET_STEP_POOL,
      .input = input,
      .input_rows = rows,
      .output = output,
      .output_rows = rows,
      .base = -1,
      .weight = -1,
      .bias = -1,
      .part_count = spread,
  };
  return output;
}

static void pool_with_constant(NetPlan *plan, NetStep *step) {
  step->kind = NET_STEP_POOL_WITH;
  step->bias = add_tensor(plan, "first", "features", step->input_rows, 0, 0);
}

static NetView *add_view(NetPlan *plan, Rows rows) {
  NetView *view = &plan->views[plan->view_count++];
  *view = (NetView){.slot = rows.slot, .first_row = rows.first, .rows = rows.count};
  return view;
}

static void add_head(NetPlan *plan, const char *block, Rows in, const NetWidths *widths, int output_row) {
  Rows none = {-1, 0, 0};
  Rows hidden = add_layers(plan, block, in, widths, none);
  char name[NET_NAME_SIZE];
  snprintf(name, sizeof name, "%s.%d", block, widths->count);
  add_linear(plan, name, hidden, (Rows){plan->output_slot, output_row, 1}, true, false);
}

// The three ways the input is looked at, n tetrahedra of it: input element 12 t + 3 a + c is coordinate c of
// vertex a of tetrahedron t.
static void add_vertex_view(NetPlan *plan, int n, Rows rows) {
  NetView *view = add_view(plan, rows);
  for (int c = 0; c < 3; c++)
    for (int a = 0; a < 4; a++)
      for (int t = 0; t < n; t++) view->index[(c * 4 + a) * n + t] = 12 * t + 3 * a + c;
}

static Rows add_tetrahedron_view(NetPlan *plan, int n) {
  Rows rows = {add_slot(plan, 12, n), 0, 12};
  NetView *view = add_view(plan, rows);
  for (int k = 0; k < 12; k++)
    for (int t = 0; t < n; t++) view->index[k * n + t] = 12 * t + k;
  return rows;
}

static Rows add_pair_view(NetPlan *plan, int n) {
  Rows rows = {add_slot(plan, 12 * n, 1), 0, 12 * n};
  NetView *view = add_view(plan, rows);
  for (int k = 0; k < 12 * n; k++) view->index[k] = k;
  return rows;
}

// n = 2 tetrahedra, or 1 where the first one is folded into constants.
static void plan_tpn(NetPlan *plan, int n) {
  const NetShape *shape = &plan->shape;
  Rows nothing = {-1, 0, 0};
  plan->output_slot = add_slot(plan, 2, 1);

  // Vertices. Coordinates that are joined to the features lie below them in the same slot, where the layers
  // read them.
  int width = shape->vertex.width[shape->vertex.count - 1];
  int vertex_slot = add_slot(plan, width + (shape->has_coordinates ? 3 : 0), 4 * n);
  Rows xyz = shape->has_coordinates ? (Rows){vertex_slot, width, 3} : (Rows){add_slot(plan, 3, 4 * n), 0, 3};
  add_vertex_view(plan, n, xyz);
  add_block(plan, "vertex", xyz, &shape->vertex, shape->vertex_skip, xyz, (Rows){vertex_slot, 0, width});

  // Tetrahedra.
  int pooled = add_pool(plan, vertex_slot, n);
  Rows raw = shape->tetrahedron_skip == NET_SKIP_NONE ? nothing : add_tetrahedron_view(plan, n);
  width = shape->tetrahedron.width[shape->tetrahedron.count - 1];
  Rows tetrahedron = {add_slot(plan, width, n), 0, width};
  add_block(plan, "tetrahedron", (Rows){pooled, 0, plan->slots[pooled].rows}, &shape->tetrahedron,
            shape->tetrahedron_skip, raw, tetrahedron);

  // The pair.
  pooled = add_pool(plan, tetrahedron.slot, 1);
  if (n == 1) pool_with_constant(plan, &plan->steps[plan->step_count - 1]);
  raw = shape->combiner_skip == NET_SKIP_NONE ? nothing : add_pair_view(plan, n);
  width = shape->combiner.width[shape->combiner.count - 1];
  Rows pair = {add_slot(plan, width, 1), 0, width};
  add_block(plan, "combiner", (Rows){pooled, 0, plan->slots[pooled].rows}, &shape->combiner,
            shape->combiner_skip, raw, pair);
  pair = add_layers(plan, "backbone", pair, &shape->backbone, nothing);
  add_head(plan, "status_head", pair, &shape->status_head, 0);
  add_head(plan, "volume_head", pair, &shape->volume_head, 1);
}

static void plan_mlp(NetPlan *plan) {
  const NetShape *shape = &plan->shape;
  plan->output_slot = add_slot(plan, shape->output_count, 1);
  Rows input = {add_slot(plan, shape->input_count, 1), 0, shape->input_count};
  add_view(plan, input);
  Rows hidden = add_layers(plan, "layer", input, &shape->hidden, (Rows){-1, 0, 0});
  char name[NET_NAME_SIZE];
  snprintf(name, sizeof name, "layer.%d", shape->hidden.count);
  add_linear(plan, name, hidden, (Rows){plan->output_slot, 0, shape->output_count}, true, false);
}

static void complete(NetPlan *plan) {
  mark_readers(plan);
  mark_outputs(plan);
  count_flops(plan);
}

NetStatus net_plan_create(const NetShape *shape, NetPlan *plan) {
  NET_TRY(net_shape_check(shape));
  *plan = (NetPlan){.shape = *shape};
  if (shape->kind == NET_TPN)
    plan_tpn(plan, 2);
  else
    plan_mlp(plan);
  complete(plan);
  return NET_OK;
}

NetStatus net_plan_create_folded(const NetShape *shape, NetPlan *plan) {
  NET_TRY(net_shape_check(shape));
  if (shape->kind != NET_TPN)
    return net_status_fail(NET_BAD_ARGUMENT,
                           "a network to fold must be a tpn: others have no first tetrahedron");
  *plan = (NetPlan){.shape = *shape};
  plan->shape.input_count = 12;
  if (shape->combiner_skip != NET_SKIP_NONE) plan->shape.combiner_skip = NET_SKIP_BIASED;
  plan_tpn(plan, 1);
  complete(plan);
  return NET_OK;
}

int net_plan_find(const NetPlan *plan, const char *name) {
  for (int k = 0; k < plan->tensor_count; k++)
    if (strcmp(plan->tensors[k].name, name) == 0) return k;
  return -1;
}
