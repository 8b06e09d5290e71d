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

// Hidden layers from `in`; the last one writes to rows `out`, or to a new slot where out.slot is negative,
// and has no activation where it `ends_linear`.
static Rows add_layers(NetPlan *plan, const char *block, Rows in, const NetWidths *widths, bool ends_linear,
                       Rows out) {
  for (int k = 0; k < widths->count; k++) {
    char name[NET_NAME_SIZE];
    snprintf(name, sizeof name, "%s.%d", block, k);
    bool is_last = k == widths->count - 1, is_given = is_last && out.slot >= 0;
    Rows next =
        is_given ? out
                 : (Rows){add_slot(plan, widths->width[k], plan->slots[in.slot].spread), 0, widths->width[k]};
    if (is_last && ends_linear)
      add_linear(plan, name, in, next, true, false);
    else
      add_layer(plan, name, in, next);
    in = next;
  }
  return in;
}

// Tetrahedra of a pair that a plan works on.
typedef struct Seen {
  int first, count;
} Seen;

static bool is_seen(Seen seen, int tetrahedron) {
  return tetrahedron >= seen.first && tetrahedron < seen.first + seen.count;
}

// One map of a skip: out = base + S raw (+ c) on the parts from `part` on.
static void add_skip_map(NetPlan *plan, const char *name, NetSkip skip, Rows raw, Rows base, Rows out,
                         int part, int part_count) {
  NetStep *step = add_linear(plan, name, raw, out, skip == NET_SKIP_BIASED || skip == NET_SKIP_OWN, false);
  step->base = base.slot;
  step->part = part;
  step->part_count = part_count;
}

// A map for each of the pair's two tetrahedra, `members` of each: one, or four vertices. Those of a
// tetrahedron that is not seen are made and never used.
static void add_own_skips(NetPlan *plan, const char *name, Seen seen, int members, Rows raw, Rows base,
                          Rows out) {
  for (int t = 0; t < 2; t++)
    for (int a = 0; a < members; a++) {
      char numbered[NET_NAME_SIZE];
      snprintf(numbered, sizeof numbered, "%.20s.%d", name, members * t + a);
      if (is_seen(seen, t)) {
        add_skip_map(plan, numbered, NET_SKIP_OWN, raw, base, out, a * seen.count + t - seen.first, 1);
      } else {
        add_tensor(plan, numbered, "weight", out.count, raw.count, sqrt(3.0 / raw.count));
        add_tensor(plan, numbered, "bias", out.count, 0, 0);
      }
    }
}

// out = base + S raw (+ c). The derivative with respect to base is the one with respect to out: they share
// it.
static void add_skip(NetPlan *plan, const char *name, NetSkip skip, Seen seen, Rows raw, Rows base,
                     Rows out) {
  const NetSlot *target = &plan->slots[out.slot];
  int count = skip == NET_SKIP_PER_INDEX ? 4 : 1;
  if (skip == NET_SKIP_OWN) add_own_skips(plan, name, seen, target->spread / seen.count, raw, base, out);
  for (int k = 0; k < count && skip != NET_SKIP_OWN; k++) {
    char numbered[NET_NAME_SIZE];
    snprintf(numbered, sizeof numbered, count == 1 ? "%.20s" : "%.20s.%d", name, k);
    int part_count = target->spread / count;
    add_skip_map(plan, numbered, skip, raw, base, out, k * part_count, part_count);
  }
  plan->slots[base.slot].gradient_offset = target->gradient_offset + (size_t)(out.first * target->spread);
}

// A block: hidden layers from `in`, then the skip from `raw`, into the first rows of a slot with `extra` rows
// more.
static Rows add_block(NetPlan *plan, const char *block, Rows in, const NetWidths *widths, NetSkip skip,
                      Seen seen, Rows raw, Rows out) {
  bool ends_linear = plan->shape.ends_linear;
  if (skip == NET_SKIP_NONE) return add_layers(plan, block, in, widths, ends_linear, out);
  Rows none = {-1, 0, 0};
  Rows base = add_layers(plan, block, in, widths, ends_linear, none);
  char name[NET_NAME_SIZE];
  snprintf(name, sizeof name, "%s_skip", block);
  add_skip(plan, name, skip, seen, raw, base, out);
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
  Rows hidden = add_layers(plan, block, in, widths, false, none);
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

// Of both tetrahedra, of the only one that there is, or of the second where the first one is folded into
// constants.
static void plan_tpn(NetPlan *plan, Seen seen, bool is_folded) {
  const NetShape *shape = &plan->shape;
  const int n = seen.count;
  Rows nothing = {-1, 0, 0};
  plan->output_slot = add_slot(plan, 2, 1);

  // Vertices. Coordinates that are joined to the features lie below them in the same slot, where the layers
  // read them.
  int width = shape->vertex.width[shape->vertex.count - 1];
  int vertex_slot = add_slot(plan, width + (shape->has_coordinates ? 3 : 0), 4 * n);
  Rows xyz = shape->has_coordinates ? (Rows){vertex_slot, width, 3} : (Rows){add_slot(plan, 3, 4 * n), 0, 3};
  add_vertex_view(plan, n, xyz);
  add_block(plan, "vertex", xyz, &shape->vertex, shape->vertex_skip, seen, xyz,
            (Rows){vertex_slot, 0, width});

  // Tetrahedra.
  int pooled = add_pool(plan, vertex_slot, n);
  Rows raw = shape->tetrahedron_skip == NET_SKIP_NONE ? nothing : add_tetrahedron_view(plan, n);
  width = shape->tetrahedron.width[shape->tetrahedron.count - 1];
  Rows tetrahedron = {add_slot(plan, width, n), 0, width};
  add_block(plan, "tetrahedron", (Rows){pooled, 0, plan->slots[pooled].rows}, &shape->tetrahedron,
            shape->tetrahedron_skip, seen, raw, tetrahedron);

  // The pair.
  pooled = shape->has_one_tetrahedron ? tetrahedron.slot : add_pool(plan, tetrahedron.slot, 1);
  if (is_folded) pool_with_constant(plan, &plan->steps[plan->step_count - 1]);
  raw = shape->combiner_skip == NET_SKIP_NONE ? nothing : add_pair_view(plan, n);
  width = shape->combiner.width[shape->combiner.count - 1];
  Rows pair = {add_slot(plan, width, 1), 0, width};
  add_block(plan, "combiner", (Rows){pooled, 0, plan->slots[pooled].rows}, &shape->combiner,
            shape->combiner_skip, seen, raw, pair);
  pair = add_layers(plan, "backbone", pair, &shape->backbone, false, nothing);
  add_head(plan, "status_head", pair, &shape->status_head, 0);
  add_head(plan, "volume_head", pair, &shape->volume_head, 1);
}

static void plan_mlp(NetPlan *plan) {
  const NetShape *shape = &plan->shape;
  plan->output_slot = add_slot(plan, shape->output_count, 1);
  Rows input = {add_slot(plan, shape->input_count, 1), 0, shape->input_count};
  add_view(plan, input);
  Rows hidden = add_layers(plan, "layer", input, &shape->hidden, false, (Rows){-1, 0, 0});
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
    plan_tpn(plan, (Seen){0, shape->has_one_tetrahedron ? 1 : 2}, false);
  else
    plan_mlp(plan);
  complete(plan);
  return NET_OK;
}

NetStatus net_plan_create_folded(const NetShape *shape, NetPlan *plan) {
  NET_TRY(net_shape_check(shape));
  if (shape->kind != NET_TPN || shape->has_one_tetrahedron)
    return net_status_fail(NET_BAD_ARGUMENT,
                           "a network to fold must be a tpn of two tetrahedra: others have no first one");
  *plan = (NetPlan){.shape = *shape};
  plan->shape.input_count = 12;
  if (shape->combiner_skip != NET_SKIP_NONE) plan->shape.combiner_skip = NET_SKIP_BIASED;
  plan_tpn(plan, (Seen){1, 1}, true);
  complete(plan);
  return NET_OK;
}

int net_plan_find(const NetPlan *plan, const char *name) {
  for (int k = 0; k < plan->tensor_count; k++)
    if (strcmp(plan->tensors[k].name, name) == 0) return k;
  return -1;
}
