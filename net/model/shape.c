// SPDX-License-Identifier: Apache-2.0
#include "net/model/shape.h"

#include <stdio.h>
#include <string.h>

#include "net/json.h"
#include "net/memory.h"

static const char *const kind_names[] = {"tpn", "mlp", NULL};
static const char *const activation_names[] = {"relu", "silu", NULL};
static const char *const pool_names[] = {"max", "sum", NULL};
static const char *const skip_names[] = {"none", "biased", "unbiased", "per_index", "own", NULL};

NetShape net_shape_tpn_a(void) {
  return (NetShape){
      .kind = NET_TPN,
      .activation = NET_RELU,
      .pool = NET_MAX,
      .has_coordinates = true,
      .vertex = {2, {24, 24}},
      .tetrahedron = {2, {48, 48}},
      .combiner = {2, {96, 96}},
      .status_head = {3, {128, 64, 32}},
      .volume_head = {2, {128, 128}},
      .vertex_skip = NET_SKIP_BIASED,
      .tetrahedron_skip = NET_SKIP_BIASED,
      .combiner_skip = NET_SKIP_BIASED,
      .input_count = 24,
      .output_count = 2,
  };
}

NetShape net_shape_tpn_b(void) {
  NetShape shape = net_shape_tpn_a();
  shape.has_coordinates = false;
  shape.vertex_skip = NET_SKIP_PER_INDEX;
  shape.tetrahedron_skip = NET_SKIP_UNBIASED;
  return shape;
}

NetShape net_shape_tpn_c(void) {
  NetShape shape = net_shape_tpn_a();
  shape.has_coordinates = false;
  shape.has_one_tetrahedron = shape.ends_linear = true;
  shape.vertex_skip = shape.tetrahedron_skip = NET_SKIP_OWN;
  shape.input_count = 12;
  return shape;
}

NetShape net_shape_tpn_backbone(void) {
  NetShape shape = net_shape_tpn_a();
  shape.backbone = (NetWidths){1, {1024}};
  return shape;
}

NetShape net_shape_mlp(int input_count, int width, int depth, int output_count) {
  NetShape shape = {
      .kind = NET_MLP, .activation = NET_SILU, .input_count = input_count, .output_count = output_count};
  shape.hidden.count = depth;
  for (int k = 0; k < depth && k < NET_MAX_DEPTH; k++) shape.hidden.width[k] = width;
  return shape;
}

static NetStatus check_widths(const char *name, const NetWidths *widths, int at_least) {
  if (widths->count < at_least || widths->count > NET_MAX_DEPTH)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: %s has %d layers; %d to %d are possible", name,
                           widths->count, at_least, NET_MAX_DEPTH);
  for (int k = 0; k < widths->count; k++)
    if (widths->width[k] < 1 || widths->width[k] > NET_MAX_WIDTH)
      return net_status_fail(NET_BAD_ARGUMENT, "shape: %s has a layer of width %d; 1 to %d are possible",
                             name, widths->width[k], NET_MAX_WIDTH);
  return NET_OK;
}

static NetStatus check_tpn(const NetShape *shape) {
  NET_TRY(check_widths("vertex", &shape->vertex, 1));
  NET_TRY(check_widths("tetrahedron", &shape->tetrahedron, 1));
  NET_TRY(check_widths("combiner", &shape->combiner, 1));
  NET_TRY(check_widths("backbone", &shape->backbone, 0));
  NET_TRY(check_widths("status_head", &shape->status_head, 0));
  NET_TRY(check_widths("volume_head", &shape->volume_head, 0));
  if (shape->tetrahedron_skip == NET_SKIP_PER_INDEX || shape->combiner_skip == NET_SKIP_PER_INDEX)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: only vertex_skip can be per_index");
  if (shape->combiner_skip == NET_SKIP_OWN)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: only vertex_skip and tetrahedron_skip can be own");
  int inputs = shape->has_one_tetrahedron ? 12 : 24;
  if (shape->input_count != inputs || shape->output_count != 2)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: this tpn has %d inputs and 2 outputs, not %d and %d",
                           inputs, shape->input_count, shape->output_count);
  return NET_OK;
}

NetStatus net_shape_check(const NetShape *shape) {
  if (shape->kind == NET_TPN) return check_tpn(shape);
  NET_TRY(check_widths("hidden", &shape->hidden, 0));
  if (shape->input_count < 1 || shape->input_count > NET_MAX_WIDTH)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: %d inputs; 1 to %d are possible", shape->input_count,
                           NET_MAX_WIDTH);
  if (shape->output_count < 1 || shape->output_count > NET_MAX_OUTPUTS)
    return net_status_fail(NET_BAD_ARGUMENT, "shape: %d outputs; 1 to %d are possible", shape->output_count,
                           NET_MAX_OUTPUTS);
  return NET_OK;
}

static bool equal_widths(const NetWidths *a, const NetWidths *b) {
  bool equal = a->count == b->count;
  for (int k = 0; equal && k < a->count; k++) equal = a->width[k] == b->width[k];
  return equal;
}

bool net_shape_equal(const NetShape *a, const NetShape *b) {
  bool equal = a->kind == b->kind && a->activation == b->activation && a->input_count == b->input_count &&
               a->output_count == b->output_count;
  if (a->kind == NET_MLP) return equal && equal_widths(&a->hidden, &b->hidden);
  return equal && a->pool == b->pool && a->has_coordinates == b->has_coordinates &&
         a->ends_linear == b->ends_linear && a->vertex_skip == b->vertex_skip &&
         a->tetrahedron_skip == b->tetrahedron_skip && a->combiner_skip == b->combiner_skip &&
         equal_widths(&a->vertex, &b->vertex) && equal_widths(&a->tetrahedron, &b->tetrahedron) &&
         equal_widths(&a->combiner, &b->combiner) && equal_widths(&a->backbone, &b->backbone) &&
         equal_widths(&a->status_head, &b->status_head) && equal_widths(&a->volume_head, &b->volume_head);
}

static bool set_widths(NetJson *json, const char *key, const NetWidths *widths) {
  int64_t integers[NET_MAX_DEPTH];
  for (int k = 0; k < widths->count; k++) integers[k] = widths->width[k];
  return net_json_set_integers(json, key, widths->count, integers);
}

// Keys whose value is false are left out.
static bool set_claim(NetJson *json, const char *key, bool claim) {
  return !claim || net_json_set_bool(json, key, claim);
}

static bool set_tpn(NetJson *json, const NetShape *shape) {
  return net_json_set_text(json, "pool", pool_names[shape->pool]) &&
         net_json_set_bool(json, "coordinates", shape->has_coordinates) &&
         set_claim(json, "one_tetrahedron", shape->has_one_tetrahedron) &&
         set_claim(json, "linear_ends", shape->ends_linear) && set_widths(json, "vertex", &shape->vertex) &&
         net_json_set_text(json, "vertex_skip", skip_names[shape->vertex_skip]) &&
         set_widths(json, "tetrahedron", &shape->tetrahedron) &&
         net_json_set_text(json, "tetrahedron_skip", skip_names[shape->tetrahedron_skip]) &&
         set_widths(json, "combiner", &shape->combiner) &&
         net_json_set_text(json, "combiner_skip", skip_names[shape->combiner_skip]) &&
         set_widths(json, "backbone", &shape->backbone) &&
         set_widths(json, "status_head", &shape->status_head) &&
         set_widths(json, "volume_head", &shape->volume_head);
}

static bool set_mlp(NetJson *json, const NetShape *shape) {
  return net_json_set_integer(json, "inputs", shape->input_count) &&
         set_widths(json, "hidden", &shape->hidden) &&
         net_json_set_integer(json, "outputs", shape->output_count);
}

NetStatus net_shape_print(const NetShape *shape, char text[NET_SHAPE_TEXT]) {
  NET_TRY(net_shape_check(shape));
  NetJson *json = net_json_object();
  bool ok = json && net_json_set_text(json, "kind", kind_names[shape->kind]) &&
            net_json_set_text(json, "activation", activation_names[shape->activation]) &&
            (shape->kind == NET_TPN ? set_tpn(json, shape) : set_mlp(json, shape));
  char *printed = ok ? net_json_print(json) : NULL;
  net_json_destroy(json);
  if (!printed) return net_status_no_memory("the text of a shape");
  snprintf(text, NET_SHAPE_TEXT, "%s", printed);
  net_memory_free(printed);
  return NET_OK;
}

// Reads keys one after another and remembers the first failure; counts them, so that what is left over is
// unknown.
typedef struct Reader {
  const NetJson *json;
  int key_count;
  NetStatus status;
} Reader;

static const NetJson *read_member(Reader *reader, const char *key) {
  if (reader->status != NET_OK) return NULL;
  const NetJson *value = net_json_member(reader->json, key);
  if (!value) reader->status = net_status_fail(NET_BAD_FILE, "shape: key \"%s\" is missing", key);
  reader->key_count++;
  return value;
}

static int take_name(Reader *reader, const char *key, const char *const names[]) {
  const NetJson *value = read_member(reader, key);
  if (!value) return 0;
  const char *text = net_json_text(value);
  for (int k = 0; text && names[k]; k++)
    if (strcmp(text, names[k]) == 0) return k;
  reader->status =
      net_status_fail(NET_BAD_FILE, "shape: \"%s\" is %.40s; expected a name such as \"%s\" or \"%s\"", key,
                      text ? text : "no text", names[0], names[1]);
  return 0;
}

static int take_integer(Reader *reader, const char *key) {
  const NetJson *value = read_member(reader, key);
  int64_t integer = 0;
  if (value && (!net_json_integer(value, &integer) || integer < 0 || integer > NET_MAX_WIDTH))
    reader->status =
        net_status_fail(NET_BAD_FILE, "shape: \"%s\" must be an integer from 0 to %d", key, NET_MAX_WIDTH);
  return reader->status == NET_OK ? (int)integer : 0;
}

static bool take_bool(Reader *reader, const char *key) {
  const NetJson *value = read_member(reader, key);
  bool boolean = false;
  if (value && !net_json_bool(value, &boolean))
    reader->status = net_status_fail(NET_BAD_FILE, "shape: \"%s\" must be true or false", key);
  return boolean;
}

// false where the key is absent.
static bool take_claim(Reader *reader, const char *key) {
  return reader->status == NET_OK && net_json_member(reader->json, key) && take_bool(reader, key);
}

static NetWidths take_widths(Reader *reader, const char *key) {
  NetWidths widths = {0};
  const NetJson *value = read_member(reader, key);
  if (!value) return widths;
  int count = net_json_count(value);
  bool ok = net_json_is_array(value) && count <= NET_MAX_DEPTH;
  for (int k = 0; ok && k < count; k++) {
    int64_t integer;
    const NetJson *element = net_json_element(value, k);
    ok = element && net_json_integer(element, &integer) && integer >= 1 && integer <= NET_MAX_WIDTH;
    if (ok) widths.width[widths.count++] = (int)integer;
  }
  if (!ok)
    reader->status =
        net_status_fail(NET_BAD_FILE, "shape: \"%s\" must be a list of at most %d widths from 1 to %d", key,
                        NET_MAX_DEPTH, NET_MAX_WIDTH);
  return widths;
}

static void take_tpn(Reader *reader, NetShape *shape) {
  shape->pool = (NetPool)take_name(reader, "pool", pool_names);
  shape->has_coordinates = take_bool(reader, "coordinates");
  shape->has_one_tetrahedron = take_claim(reader, "one_tetrahedron");
  shape->ends_linear = take_claim(reader, "linear_ends");
  shape->vertex = take_widths(reader, "vertex");
  shape->vertex_skip = (NetSkip)take_name(reader, "vertex_skip", skip_names);
  shape->tetrahedron = take_widths(reader, "tetrahedron");
  shape->tetrahedron_skip = (NetSkip)take_name(reader, "tetrahedron_skip", skip_names);
  shape->combiner = take_widths(reader, "combiner");
  shape->combiner_skip = (NetSkip)take_name(reader, "combiner_skip", skip_names);
  shape->backbone = take_widths(reader, "backbone");
  shape->status_head = take_widths(reader, "status_head");
  shape->volume_head = take_widths(reader, "volume_head");
  shape->input_count = shape->has_one_tetrahedron ? 12 : 24;
  shape->output_count = 2;
}

static void take_mlp(Reader *reader, NetShape *shape) {
  shape->input_count = take_integer(reader, "inputs");
  shape->hidden = take_widths(reader, "hidden");
  shape->output_count = take_integer(reader, "outputs");
}

NetStatus net_shape_parse(const char *text, NetShape *shape) {
  char error[160];
  NetJson *json = net_json_parse(text, strlen(text), error);
  if (!json) return net_status_fail(NET_BAD_FILE, "shape: %s", error);
  *shape = (NetShape){0};
  Reader reader = {.json = json};
  shape->kind = (NetKind)take_name(&reader, "kind", kind_names);
  shape->activation = (NetActivation)take_name(&reader, "activation", activation_names);
  if (shape->kind == NET_TPN)
    take_tpn(&reader, shape);
  else
    take_mlp(&reader, shape);
  if (reader.status == NET_OK && net_json_count(json) != reader.key_count)
    reader.status =
        net_status_fail(NET_BAD_FILE, "shape: %d unknown keys; kind \"%s\" has %d",
                        net_json_count(json) - reader.key_count, kind_names[shape->kind], reader.key_count);
  net_json_destroy(json);
  if (reader.status != NET_OK) return reader.status;
  return net_shape_check(shape) == NET_OK ? NET_OK : NET_BAD_FILE;
}
