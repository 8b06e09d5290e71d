// SPDX-License-Identifier: Apache-2.0
#include "device/network/geo.h"

#include "device/kernels/geo/rows.h"
#include "overlap/geo/model.h"
#include "overlap/models.h"

static Status refuse(const char *what) {
  return status_fail(STATUS_INPUT, "the device kernels cannot evaluate this network: %s", what);
}

// The layers of a plan: matrices, an activation after each but the last. Rows of the group's memory: the
// features, then values and slopes of each hidden layer.
static Status fill_layers(const NetPlan *plan, int *layers, int *count) {
  int used = plan->shape.input_count, input = 0;
  *count = 0;
  for (int k = 0; k < plan->step_count; k++) {
    const NetStep *step = &plan->steps[k];
    if (step->kind == NET_STEP_ACTIVATE) continue;
    if (*count == GEO_MOST_LAYERS) return refuse("it has too many layers");
    const bool is_last = step->output == plan->output_slot;
    int *layer = layers + GEO_LAYER * (*count)++;
    layer[LAYER_INPUT] = input;
    layer[LAYER_INPUT_ROWS] = step->input_rows;
    layer[LAYER_OUTPUT] = is_last ? -1 : used;
    layer[LAYER_OUTPUT_ROWS] = step->output_rows;
    layer[LAYER_SLOPE] = is_last ? -1 : used + step->output_rows;
    layer[LAYER_WEIGHT] = (int)plan->tensors[step->weight].offset;
    layer[LAYER_BIAS] = (int)plan->tensors[step->bias].offset;
    input = used;
    used += is_last ? 0 : 2 * step->output_rows;
  }
  return used <= GEO_ROOM ? STATUS_OK : refuse("it is too wide for the memory of a work group");
}

static double flops_of(const int *layers, int count) {
  double flops = 0;
  for (int k = 0; k < count - 1; k++)
    flops += 2.0 * layers[GEO_LAYER * k + LAYER_OUTPUT_ROWS] * layers[GEO_LAYER * k + LAYER_INPUT_ROWS];
  return flops;
}

static Status send(DeviceGeo *geo, const Device *device, const OverlapGeoOverlap *overlap,
                   int feature_count) {
  const NetModel_f64 *model = overlap_geo_network_model(overlap->net);
  const NetPlan *plan = model->plan;
  int layers[GEO_LAYER * GEO_MOST_LAYERS];
  if (plan->shape.input_count != feature_count) return refuse("its number of features is not supported");
  TRY(fill_layers(plan, layers, &geo->layer_count));
  geo->feature_count = plan->shape.input_count;
  geo->output_count = plan->shape.output_count;
  geo->offset = overlap->model.offset;
  geo->flops = flops_of(layers, geo->layer_count);
  TRY(device_take(device, (size_t)(GEO_LAYER * geo->layer_count), sizeof *layers, layers, &geo->layers));
  return device_take(device, plan->parameter_count, sizeof(double), model->parameters, &geo->parameters);
}

static Status take_memory(DeviceGeo *geo, const Device *device) {
  const size_t room = DEVICE_GEO_ROOM,
               rows = (size_t)(GEO_ROW_FEATURES + geo->feature_count + geo->output_count);
  TRY(device_take(device, rows * room, sizeof(double), NULL, &geo->table));
  TRY(device_take(device, room, sizeof(int), NULL, &geo->slots));
  TRY(device_take(device, 2 * room, sizeof(int), NULL, &geo->close));
  TRY(device_take(device, 2 * room, sizeof(int), NULL, &geo->left));
  TRY(device_take(device, 1, sizeof(int), NULL, &geo->slot_count));
  TRY(device_take(device, 1, sizeof(int), NULL, &geo->close_count));
  return device_take(device, 1, sizeof(int), NULL, &geo->left_count);
}

Status device_geo_create(DeviceGeo *geo, const Device *device, const char *name, int feature_count) {
  *geo = (DeviceGeo){0};
  TRY(overlap_models_create(&geo->host, name));
  TRY(send(geo, device, geo->host.self, feature_count));
  return take_memory(geo, device);
}

void device_geo_destroy(DeviceGeo *geo, const Device *device) {
  DeviceMemory *const all[] = {&geo->layers,     &geo->parameters, &geo->table,        &geo->slots,
                               &geo->slot_count, &geo->close,      &geo->close_count,  &geo->left,
                               &geo->left_count, &geo->clipped,    &geo->clipped_more, &geo->clipped_flags};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) device->ops->release(device->self, all[k]);
  overlap_model_destroy(&geo->host);
  *geo = (DeviceGeo){0};
}

static Status make_larger(const Device *device, size_t bytes, DeviceMemory *memory) {
  if (memory->bytes >= bytes) return STATUS_OK;
  device->ops->release(device->self, memory);
  return device_take(device, bytes, 1, NULL, memory);
}

Status device_geo_make_room(DeviceGeo *geo, const Device *device, int count, int width) {
  const size_t n = (size_t)count;
  TRY(make_larger(device, n * sizeof(double), &geo->clipped));
  TRY(make_larger(device, n, &geo->clipped_flags));
  return width > 0 ? make_larger(device, n * (size_t)width * sizeof(double), &geo->clipped_more) : STATUS_OK;
}
