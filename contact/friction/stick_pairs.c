// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick_pairs.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "contact/evaluation.h"
#include "contact/limits.h"
#include "contact/pressure/field.h"
#include "contact/shape/ball.h"
#include "contact/shape/shape.h"

// ---- Which side is the slave.

static double volume_of(const ContactLayout *layout, int body) {
  double sum = 0;
  for (int c = layout->mesh.cell_begin[body]; c < layout->mesh.cell_begin[body + 1]; c++)
    sum += layout->cell_volumes[c];
  return sum;
}

// Whether side 0 is the better slave of two bodies.
static bool is_first_slave(const ContactLayout *layout, const ContactInterfaceDef *interface) {
  const ContactBody *a = &layout->def.bodies[interface->a], *b = &layout->def.bodies[interface->b];
  if (a->is_obstacle != b->is_obstacle) return b->is_obstacle;
  double volumes[2] = {volume_of(layout, interface->a), volume_of(layout, interface->b)};
  if (fabs(volumes[0] - volumes[1]) > CONTACT_ROUNDING * volumes[0]) return volumes[0] < volumes[1];
  return a->vertex_end - a->vertex_begin >= b->vertex_end - b->vertex_begin;
}

void contact_stick_pairs_laws(const ContactSystem *system, ContactStickLaw *laws) {
  const ContactLayout *layout = contact_system_layout(system);
  for (int i = 0; i < layout->interface_count; i++) {
    const ContactInterfaceDef *interface = &layout->interfaces[i];
    laws[i].stiffness = interface->stiffness;
    double first = interface->shape >= 0 || is_first_slave(layout, interface);
    if (interface->shape < 0 && interface->a == interface->b) first = 0.5;
    laws[i].weight[0] = first;
    laws[i].weight[1] = 1 - first;
  }
}

// ---- Pairs.

// Where a ball meets a cell. Its closed form adds up terms of the size R³, so of a sliver the middle and the
// depth are quotients of roundings, and with them the springs: what is left of forces would be no smaller
// than that. So as V goes to nothing x̄ goes to where the cell is deepest, to which it does anyway.
static void meet_ball(const ContactShape *shape, double time, const double tet[12],
                      const ContactFieldPair *field, ContactStickPair *pair) {
  double centre[3], deepest[4], middle[3] = {0, 0, 0};
  double whole = fabs(vec3_det4(vec3_at(tet), vec3_at(tet + 3), vec3_at(tet + 6), vec3_at(tet + 9))) / 6,
         share = field->volume / (field->volume + CONTACT_FLAT * whole);
  vec3_store(centre, contact_shape_point(shape, time));
  contact_ball_nearest(tet, centre, deepest);
  for (int v = 0; v < 4; v++) {
    pair->lambda[0][v] = share * field->weights[0][v] + (1 - share) * deepest[v];
    vec3_accumulate(middle, vec3_scale(pair->lambda[0][v], vec3_at(tet + 3 * v)));
  }
  double distance = vec3_length(vec3_sub(vec3_at(middle), vec3_at(centre)));
  double depth = (shape->radius - distance) * (shape->radius + distance) / (2 * shape->radius);
  pair->area = depth > 0 ? field->volume / (2 * depth) : 0;
  vec3_store(pair->before, vec3_at(middle));
}

static void hand_over(const ContactLayout *layout, const ContactEvaluation *evaluation, int k, double before,
                      ContactStickPair *pair) {
  const ContactPair *cells = &evaluation->pairs[k];
  const ContactFieldPair *field = &evaluation->fields[k];
  int shape = layout->interfaces[cells->interface].shape;
  *pair = (ContactStickPair){.interface = cells->interface, .area = contact_field_area(field)};
  for (int side = 0; side < 2; side++) {
    pair->tets[side] = cells->cells[side] < 0 ? -1 : contact_mesh_tet(&layout->mesh, cells->cells[side]);
    memcpy(pair->lambda[side], field->weights[side], sizeof pair->lambda[side]);
  }
  memcpy(pair->force, field->force, sizeof pair->force);
  if (shape < 0) return;
  double tet[12];
  const ContactShape *obstacle = &layout->def.shapes[shape];
  contact_layout_gather_whole(layout, cells->cells[0], evaluation->positions, tet);
  memcpy(pair->before, field->centroid, sizeof pair->before);
  if (obstacle->kind == CONTACT_SHAPE_BALL) meet_ball(obstacle, evaluation->time, tet, field, pair);
  vec3_store(pair->before,
             contact_shape_place_before(obstacle, evaluation->time, before, vec3_at(pair->before)));
}

Status contact_stick_pairs_eval(ContactStick *stick, const ContactSystem *system,
                                const ContactEvaluation *evaluation, const ContactStickLast *last,
                                double last_time, bool *is_resting) {
  const ContactLayout *layout = contact_system_layout(system);
  int count = evaluation->pair_count;
  TRY(contact_stick_reserve(stick, count));
  for (int i = 0; i < layout->interface_count; i++) is_resting[i] = contact_system_is_resting(system, i);
#pragma omp parallel for schedule(static) if (count > CONTACT_STICK_MANY)
  for (int k = 0; k < count; k++) hand_over(layout, evaluation, k, last_time, &stick->pairs[k]);
  return contact_stick_eval(stick, last, count, evaluation->positions, is_resting);
}

double contact_stick_pairs_shape_power(const ContactStick *stick, const ContactLayout *layout,
                                       const ContactEvaluation *evaluation) {
  double power = 0;
  for (int k = 0; k < stick->pair_count; k++) {
    int shape = layout->interfaces[stick->pairs[k].interface].shape;
    if (shape < 0) continue;
    Vec3 x = vec3_at(evaluation->fields[k].centroid);
    Vec3 velocity = contact_shape_velocity(&layout->def.shapes[shape], evaluation->time, x);
    power += vec3_dot(vec3_at(stick->pulls[k]), velocity);
  }
  return power;
}

// Whether a vertex of the pair slips by its motion. One that moves back and slips as its limit falls is drawn
// by its spring: that friction drives it is no mistake.
static bool slips(const ContactStick *stick, int k) {
  for (int side = 0; side < 2; side++)
    for (int v = 0; v < 4; v++) {
      int node = stick->touches[k][side][v].node;
      if (node >= 0 && stick->nodes[node].slips && stick->nodes[node].advances) return true;
    }
  return false;
}

static Vec3 velocity_at(const ContactStick *stick, const ContactStickPair *pair, int side,
                        const double *velocities) {
  Vec3 velocity = {0, 0, 0};
  for (int v = 0; v < 4; v++)
    velocity =
        vec3_add(velocity, vec3_scale(pair->lambda[side][v],
                                      vec3_at(velocities + 3 * (size_t)stick->tets[pair->tets[side]][v])));
  return velocity;
}

// Pull times the velocity of side 0 against side 1 [W].
static double power_of(const ContactStick *stick, const ContactLayout *layout,
                       const ContactEvaluation *evaluation, int k, const double *velocities) {
  const ContactStickPair *pair = &stick->pairs[k];
  int shape = layout->interfaces[pair->interface].shape;
  Vec3 x = vec3_at(evaluation->fields[k].centroid);
  Vec3 other = shape >= 0 ? contact_shape_velocity(&layout->def.shapes[shape], evaluation->time, x)
                          : velocity_at(stick, pair, 1, velocities);
  return vec3_dot(vec3_at(stick->pulls[k]), vec3_sub(velocity_at(stick, pair, 0, velocities), other));
}

double contact_stick_pairs_turned_power(const ContactStick *stick, ContactSystem *system,
                                        const ContactEvaluation *evaluation, const double *velocities) {
  const ContactLayout *layout = contact_system_layout(system);
  const double *v = contact_system_spread(system, velocities);
  double sum = 0, power = 0;
  for (int k = 0; k < stick->pair_count; k++) {
    if (slips(stick, k)) power += power_of(stick, layout, evaluation, k, v);
    bool is_last = k + 1 == stick->pair_count || stick->pairs[k + 1].interface != stick->pairs[k].interface;
    if (is_last) sum += fmax(power, 0), power = 0;
  }
  return sum;
}
