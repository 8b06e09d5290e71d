// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/volume/volume.h"

#include "base/vec3.h"

// c_a W_a of the nodes, W_a from the elements that they belong to [Pa].
static void press_nodes(const ContactLayout *layout, const ContactPatches *patches, double *pressures) {
  for (int n = 0; n < patches->node_count; n++) pressures[n] = 0;
  for (int e = 0; e < patches->element_count; e++)
    for (int v = 0; v < 4; v++)
      pressures[patches->elements[e].nodes[v]] += 0.25 * patches->elements[e].covered;
  for (int p = 0; p < patches->patch_count; p++) {
    const ContactPatch *patch = &patches->patches[p];
    const ContactInterfaceDef *interface = &layout->interfaces[patch->interface];
    for (int n = patch->node_begin; n < patch->node_end; n++) {
      const ContactNode *node = &patches->nodes[n];
      pressures[n] *=
          interface->weight[node->side] * interface->stiffness / layout->vertex_volumes[node->vertex];
    }
  }
}

static double pressure_of(const ContactPatches *patches, const double *nodes, int k) {
  double pressure = 0;
  for (int side = 0; side < 2; side++) {
    int e = patches->pair_elements[k][side];
    for (int v = 0; e >= 0 && v < 4; v++) pressure += 0.25 * nodes[patches->elements[e].nodes[v]];
  }
  return pressure;
}

// Shares of the force on a side by its vertices; a quarter each where there is none.
static void weigh(const double forces[12], Vec3 force, double weights[4]) {
  double square = vec3_dot(force, force);
  for (int v = 0; v < 4; v++)
    weights[v] = square > 0 ? vec3_dot(vec3_at(forces + 3 * v), force) / square : 0.25;
}

static ContactFieldPair describe(double volume, double pressure, bool is_of_shape, const double x[24],
                                 const double forces[24]) {
  Vec3 force = {0, 0, 0}, middle = {0, 0, 0};
  for (int v = 0; v < 4; v++) force = vec3_add(force, vec3_at(forces + 3 * v));
  double length = vec3_length(force), share = is_of_shape ? 1 : 0.5;
  ContactFieldPair pair = {.energy = 0.5 * pressure * volume,
                           .volume = volume,
                           .signs = {1, 1},
                           .weighed = {volume, is_of_shape ? 0 : volume}};
  weigh(forces, force, pair.weights[0]);
  if (!is_of_shape) weigh(forces + 12, vec3_scale(-1, force), pair.weights[1]);
  for (int v = 0; v < (is_of_shape ? 4 : 8); v++)
    middle = vec3_add(middle, vec3_scale(share * pair.weights[v / 4][v % 4], vec3_at(x + 3 * v)));
  vec3_store(pair.centroid, middle);
  vec3_store(pair.force, force);
  if (!(length > 0)) return pair;
  pair.depths[0] = pair.depths[1] = pressure * volume / length;
  vec3_store(pair.slopes[0], vec3_scale(1 / length, force));
  vec3_store(pair.slopes[1], vec3_scale(-1 / length, force));
  return pair;
}

void contact_volume_press(const ContactLayout *layout, const ContactVolumePairs *pairs) {
  const ContactPatches *patches = pairs->patches;
  press_nodes(layout, patches, pairs->nodes);
  for (size_t k = 0; k < (size_t)patches->pair_count; k++) {
    double pressure = pressure_of(patches, pairs->nodes, (int)k), *forces = pairs->forces + 24 * k;
    for (size_t c = 0; c < 24; c++) forces[c] = -pressure * pairs->gradients[24 * k + c];
    pairs->fields[k] = describe(pairs->volumes[k], pressure, patches->pair_elements[k][1] < 0,
                                pairs->coordinates + 24 * k, forces);
  }
}

void contact_volume_bend(double energy, const double forces[24], int count, double *matrix) {
  int width = 3 * count;
  double scale = energy > 0 ? 0.5 / energy : 0;
  for (int r = 0; r < width; r++)
    for (int c = 0; c < width; c++) matrix[width * r + c] = scale * forces[r] * forces[c];
}
