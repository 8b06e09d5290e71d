// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick_pull.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "contact/evaluation.h"
#include "contact/friction/deformation.h"
#include "contact/pressure/field_pull.h"
#include "contact/shape/shape.h"

// ∂g/∂ of what a pair hands over.
typedef struct PairSlopes {
  ContactFieldSlopes field;
  double gap[3];            // by Δ of side 0 as slave
  double deformation[2][9]; // by F of either tetrahedron
} PairSlopes;

typedef struct Work {
  const ContactStick *stick;
  const ContactLayout *layout;
  const ContactEvaluation *evaluation;
  const ContactStickLast *last;
  double last_time;
  const ContactStickPull *pull;
  const double *forces;         // ∂g/∂f by the vertices of the contact mesh; NULL: 0
  const double *slopes;         // of V and x̄
  PairSlopes *pairs;            //                                                  (pair_count)
  double (*deformations)[2][9]; // F of either tetrahedron              (pair_count)
  double *shares;               // ∂g/∂ of a touch's share, by its place in stick->order
} Work;

static bool is_wanted(const Work *work, int interface) {
  return work->pull->interface == CONTACT_ALL_INTERFACES || work->pull->interface == interface;
}

static const int *tet_of(const Work *work, int pair, int side) {
  return work->stick->tets[work->stick->pairs[pair].tets[side]];
}

static bool is_carried(const Work *work, int pair, int side) {
  return work->stick->pairs[pair].tets[side] >= 0;
}

// Σ λ x of a side.
static Vec3 mean_of(const Work *work, int pair, int side, const double *values) {
  Vec3 sum = {0, 0, 0};
  const double *lambda = work->stick->pairs[pair].lambda[side];
  for (int v = 0; v < 4; v++)
    sum = vec3_add(sum, vec3_scale(lambda[v], vec3_at(values + 3 * (size_t)tet_of(work, pair, side)[v])));
  return sum;
}

// Adds to ∂g/∂x, or to ∂g/∂xⁿ, of a vertex on a side of an interface.
static void add_place(const Work *work, int interface, int side, bool is_now, int vertex, Vec3 slope) {
  contact_stars_push(work->stick->stars, vertex, slope, is_now ? work->pull->now : work->pull->then);
  if (side == 0) vec3_accumulate(work->pull->moves[interface][is_now ? 0 : 1], slope);
}

// ---- From the forces on vertices to the pulls of pairs.

// ∂g/∂ of a pair's pull.
static Vec3 slope_of_pull(const Work *work, int pair) {
  Vec3 sum = {0, 0, 0};
  if (!work->forces) return sum;
  for (int side = 0; side < 2; side++)
    if (is_carried(work, pair, side))
      sum = vec3_add(sum, vec3_scale(side == 0 ? 1 : -1, mean_of(work, pair, side, work->forces)));
  return sum;
}

static void pull_shared_forces(const Work *work, int pair) {
  Vec3 own = vec3_at(work->stick->pulls[pair]);
  for (int side = 0; side < 2; side++)
    for (int v = 0; v < 4 && is_carried(work, pair, side); v++) {
      double along = vec3_dot(own, vec3_at(work->forces + 3 * (size_t)tet_of(work, pair, side)[v]));
      work->pairs[pair].field.weights[side][v] += side == 0 ? along : -along;
    }
}

// ---- The law of a node.

// What a node's law is a function of, and ∂g/∂ of it.
typedef struct Law {
  const ContactStickNode *node;
  double root; // √k
  Vec3 normal, pressed, way, carried, q;
  double press;             // N
  Vec3 by_force, by_normal; // ∂g/∂ of f_a, n
  Vec3 by_way, by_q;
  double by_stiffness, by_limit;
  double by_deformation[9];
} Law;

static void add_outer(double matrix[9], Vec3 column, Vec3 row) {
  const double x[3] = {column.x, column.y, column.z};
  for (int r = 0; r < 3; r++) vec3_accumulate(matrix + 3 * r, vec3_scale(x[r], row));
}

// x without its part along the unit vector.
static Vec3 without(Vec3 unit, Vec3 x) {
  return vec3_sub(x, vec3_scale(vec3_dot(unit, x), unit));
}

// Of the next q = √k |s| y/|y|, y = F⁻¹ s; returns ∂g/∂s.
static Vec3 pull_next(Law *law, Vec3 after) {
  const ContactStickNode *node = law->node;
  double transposed[9];
  Vec3 s = vec3_at(node->stretch), y = contact_deformation_divide(node->deformation, s);
  double length = vec3_length(s), size = vec3_length(y);
  contact_deformation_transpose(node->deformation, transposed);
  if (!(length > 0 && size > 0)) return vec3_scale(law->root, contact_deformation_divide(transposed, after));
  Vec3 unit = vec3_scale(1 / size, y);
  law->by_stiffness += length * vec3_dot(unit, after) / (2 * law->root);
  Vec3 back =
      contact_deformation_divide(transposed, vec3_scale(law->root * length / size, without(unit, after)));
  add_outer(law->by_deformation, vec3_scale(-1, back), y);
  return vec3_add(back, vec3_scale(law->root * vec3_dot(unit, after) / length, s));
}

// Of T = −k s; adds to ∂g/∂s.
static Vec3 pull_force(Law *law, Vec3 by_pull) {
  law->by_stiffness -= vec3_dot(by_pull, vec3_at(law->node->stretch));
  return vec3_scale(-law->node->stiffness, by_pull);
}

// Of s = trial, cut at the limit; returns ∂g/∂trial.
static Vec3 pull_return(Law *law, Vec3 by_stretch) {
  const ContactStickNode *node = law->node;
  if (!node->slips) return by_stretch;
  double k = node->stiffness, length = node->trial;
  Vec3 unit = vec3_scale(1 / length, vec3_at(node->gap));
  double along = vec3_dot(by_stretch, unit);
  law->by_limit += along / k;
  law->by_stiffness -= along * node->limit / (k * k);
  return vec3_scale(node->limit / (k * length), without(unit, by_stretch));
}

// Of trial = P (carried + way).
static Vec3 pull_projection(Law *law, Vec3 by_trial) {
  Vec3 whole = vec3_add(law->carried, law->way);
  law->by_normal = vec3_sub(law->by_normal, vec3_scale(vec3_dot(by_trial, law->normal), whole));
  law->by_normal = vec3_sub(law->by_normal, vec3_scale(vec3_dot(law->normal, whole), by_trial));
  return without(law->normal, by_trial);
}

// Of carried = |q| F q / (√k |F q|).
static void pull_carried(Law *law, Vec3 by_carried) {
  const double *F = law->node->deformation;
  double transposed[9], length = vec3_length(law->q);
  Vec3 turned = contact_deformation_times(F, law->q);
  double size = vec3_length(turned);
  contact_deformation_transpose(F, transposed);
  if (!(length > 0 && size > 0)) {
    law->by_q = vec3_scale(1 / law->root, contact_deformation_times(transposed, by_carried));
    return;
  }
  Vec3 unit = vec3_scale(1 / size, turned);
  double along = vec3_dot(by_carried, unit) / law->root;
  Vec3 back = vec3_scale(length / (law->root * size), without(unit, by_carried));
  law->by_stiffness -= along * length / (2 * law->node->stiffness);
  add_outer(law->by_deformation, back, law->q);
  law->by_q = vec3_add(contact_deformation_times(transposed, back), vec3_scale(along / length, law->q));
}

// Of N = |f| and n = f/N, once the limit μ N is gone back through.
static void pull_press(Law *law, double half_friction) {
  if (!(law->press > 0)) return;
  Vec3 across = vec3_scale(1 / law->press, without(law->normal, law->by_normal));
  law->by_force = vec3_add(across, vec3_scale(half_friction * law->by_limit, law->normal));
}

// ---- Touches of a node.

static int pair_of(int touch) {
  return touch / 8;
}

static int side_of(int touch) {
  return touch / 4 % 2;
}

static double sign_of(int touch) {
  return side_of(touch) == 0 ? 1 : -1;
}

static double share_of(const Work *work, int touch) {
  return work->stick->touches[pair_of(touch)][side_of(touch)][touch % 4].share;
}

static Vec3 place_before(const Work *work, int pair, int side) {
  if (!is_carried(work, pair, side)) return vec3_at(work->stick->pairs[pair].before);
  return mean_of(work, pair, side, work->last->positions);
}

// Δ of side 0 as slave.
static Vec3 gap_of(const Work *work, int pair) {
  return vec3_sub(place_before(work, pair, 1), place_before(work, pair, 0));
}

static Vec3 q_of(const ContactStickEntry *entry) {
  Vec3 stretch = entry ? vec3_at(entry->stretch) : (Vec3){0, 0, 0};
  double length = vec3_length(stretch);
  return length > 0 ? vec3_scale(sqrt(2 * entry->energy) / length, stretch) : stretch;
}

// The law as it was evaluated.
static Law find_law(const Work *work, const ContactStickNode *node, const ContactStickEntry *entry) {
  Law law = {.node = node, .root = sqrt(node->stiffness), .normal = vec3_at(node->normal), .q = q_of(entry)};
  for (int r = node->begin; r < node->end; r++) {
    int t = work->stick->order[r];
    const ContactStickPair *pair = &work->stick->pairs[pair_of(t)];
    double lambda = pair->lambda[side_of(t)][t % 4];
    law.pressed = vec3_add(law.pressed, vec3_scale(sign_of(t) * lambda, vec3_at(pair->force)));
    law.way = vec3_add(law.way, vec3_scale(sign_of(t) * share_of(work, t), gap_of(work, pair_of(t))));
  }
  law.press = vec3_length(law.pressed);
  Vec3 turned = contact_deformation_times(node->deformation, law.q);
  double size = vec3_length(turned);
  if (size > 0) law.carried = vec3_scale(vec3_length(law.q) / (law.root * size), turned);
  return law;
}

// ∂g/∂T of the node.
static Vec3 slope_of_node(const Work *work, const ContactStickNode *node) {
  Vec3 sum = {0, 0, 0};
  for (int r = node->begin; r < node->end; r++) {
    int t = work->stick->order[r];
    Vec3 slope = slope_of_pull(work, pair_of(t));
    sum = vec3_add(sum, vec3_scale(sign_of(t) * share_of(work, t), slope));
    work->shares[r] = sign_of(t) * vec3_dot(slope, vec3_at(node->force));
  }
  return sum;
}

static void find_deformations(const Work *work) {
  for (int i = 0; i < 2 * work->stick->pair_count; i++)
    if (is_carried(work, i / 2, i % 2))
      contact_deformation_find(tet_of(work, i / 2, i % 2), work->stick->rest, work->evaluation->positions,
                               work->deformations[i / 2][i % 2]);
}

// Of F = Σ share F of the touches' tetrahedra; what a touch's share gives.
static double pull_deformation(const Work *work, int t, const double by_deformation[9]) {
  const double *F = work->deformations[pair_of(t)][side_of(t)];
  double *by = work->pairs[pair_of(t)].deformation[side_of(t)], sum = 0, share = share_of(work, t);
  for (int e = 0; e < 9; e++) {
    sum += by_deformation[e] * F[e];
    by[e] += share * by_deformation[e];
  }
  return sum;
}

// From the node's sums to its pairs.
static void pull_touches(const Work *work, const Law *law, double half_stiffness) {
  const ContactStickNode *node = law->node;
  double mean = 0;
  for (int r = node->begin; r < node->end; r++) {
    int t = work->stick->order[r];
    Vec3 gap = vec3_scale(sign_of(t), gap_of(work, pair_of(t)));
    work->shares[r] += vec3_dot(law->by_way, gap) + pull_deformation(work, t, law->by_deformation);
    mean += share_of(work, t) * work->shares[r];
    vec3_accumulate(work->pairs[pair_of(t)].gap, vec3_scale(sign_of(t) * share_of(work, t), law->by_way));
  }
  for (int r = node->begin; r < node->end; r++) {
    int t = work->stick->order[r];
    const ContactStickPair *pair = &work->stick->pairs[pair_of(t)];
    ContactFieldSlopes *slopes = &work->pairs[pair_of(t)].field;
    double lambda = pair->lambda[side_of(t)][t % 4], by_weight = (work->shares[r] - mean) / node->weight;
    Vec3 force = vec3_at(pair->force);
    double size = vec3_length(force);
    slopes->weights[side_of(t)][t % 4] += by_weight * size + sign_of(t) * vec3_dot(law->by_force, force) +
                                          law->by_stiffness * half_stiffness * pair->area;
    slopes->area += law->by_stiffness * half_stiffness * lambda;
    vec3_accumulate(slopes->force, vec3_scale(by_weight * lambda / size, force));
    vec3_accumulate(slopes->force, vec3_scale(sign_of(t) * lambda, law->by_force));
  }
}

static Vec3 slope_after(const Work *work, const ContactStickNode *node) {
  const ContactStickPull *pull = work->pull;
  if (!pull->after) return (Vec3){0, 0, 0};
  const ContactStickEntry *entry = contact_stick_history_find(pull->next, node->interface, node->vertex);
  return entry ? vec3_at(pull->after[entry - pull->next->entries]) : (Vec3){0, 0, 0};
}

static void pull_node(const Work *work, const ContactStickNode *node) {
  if (!(node->stiffness > 0)) return;
  const ContactStickHistory *history = &work->last->history;
  const ContactStickEntry *entry = contact_stick_history_find(history, node->interface, node->vertex);
  const ContactStickLaw *constants = &work->stick->laws[node->interface];
  int slave = side_of(work->stick->order[node->begin]);
  double half = constants->weight[slave];
  Law law = find_law(work, node, entry);
  Vec3 by_stretch = pull_force(&law, slope_of_node(work, node));
  by_stretch = vec3_add(by_stretch, pull_next(&law, slope_after(work, node)));
  law.by_way = pull_projection(&law, pull_return(&law, by_stretch));
  pull_carried(&law, law.by_way);
  pull_press(&law, half * constants->friction);
  work->pull->friction[node->interface] += half * law.press * law.by_limit;
  work->pull->stiffness[node->interface] += law.by_stiffness * node->stiffness;
  if (entry) vec3_accumulate(work->pull->before[entry - history->entries], law.by_q);
  pull_touches(work, &law, half * constants->stiffness);
}

// ---- Pairs.

// The transpose of what contact_shape_place_before does to a difference.
static Vec3 turn_back(const Work *work, const ContactShape *shape, Vec3 slope) {
  const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3 origin = vec3_at(shape->point);
  double time = work->evaluation->time, found[3];
  Vec3 from = contact_shape_place_before(shape, time, work->last_time, origin);
  for (int k = 0; k < 3; k++) {
    Vec3 to = contact_shape_place_before(shape, time, work->last_time, vec3_add(origin, axes[k]));
    found[k] = vec3_dot(slope, vec3_sub(to, from));
  }
  return vec3_at(found);
}

// Of x̄ of a shape's pair, as it moved: Σ λ x.
static void pull_centroid(const Work *work, int k, Vec3 slope) {
  const ContactStickPair *pair = &work->stick->pairs[k];
  const int *tet = tet_of(work, k, 0);
  for (int v = 0; v < 4; v++) {
    Vec3 x = vec3_at(work->evaluation->positions + 3 * (size_t)tet[v]);
    work->pairs[k].field.weights[0][v] += vec3_dot(slope, x);
    add_place(work, pair->interface, 0, true, tet[v], vec3_scale(pair->lambda[0][v], slope));
  }
}

static void pull_gap(const Work *work, int k) {
  const ContactStickPair *pair = &work->stick->pairs[k];
  for (int side = 0; side < 2; side++) {
    Vec3 slope = vec3_scale(side == 0 ? -1 : 1, vec3_at(work->pairs[k].gap));
    if (!is_carried(work, k, side)) {
      const ContactShape *shape = &work->layout->def.shapes[work->layout->interfaces[pair->interface].shape];
      pull_centroid(work, k, turn_back(work, shape, slope));
      continue;
    }
    for (int v = 0; v < 4; v++) {
      int vertex = tet_of(work, k, side)[v];
      work->pairs[k].field.weights[side][v] +=
          vec3_dot(slope, vec3_at(work->last->positions + 3 * (size_t)vertex));
      add_place(work, pair->interface, side, false, vertex, vec3_scale(pair->lambda[side][v], slope));
    }
  }
}

static void pull_tet(const Work *work, int k, int side) {
  const int *tet = tet_of(work, k, side), interface = work->stick->pairs[k].interface;
  Vec3 rows[3], first = {0, 0, 0};
  double det = contact_deformation_rows(tet, work->stick->rest, rows);
  for (int v = 0; v < 3; v++) {
    Vec3 slope = vec3_scale(1 / det, contact_deformation_times(work->pairs[k].deformation[side], rows[v]));
    add_place(work, interface, side, true, tet[v + 1], slope);
    first = vec3_sub(first, slope);
  }
  add_place(work, interface, side, true, tet[0], first);
}

// A shape's two ways, at the last state and now, are its x̄ then against its x̄ now.
static void pull_pair(const Work *work, int k) {
  const ContactEvaluation *evaluation = work->evaluation;
  const ContactPair *cells = &evaluation->pairs[k];
  const ContactFieldSlopes *by = &work->pairs[k].field;
  const double *coordinates = evaluation->coordinates + 24 * (size_t)k;
  double slope[24] = {0};
  work->pull->stiffness[cells->interface] +=
      vec3_dot(vec3_at(by->force), vec3_at(work->stick->pairs[k].force));
  if (cells->cells[1] < 0)
    contact_field_pull_shape(work->layout, cells, evaluation->time, coordinates, &evaluation->fields[k],
                             evaluation->pair_forces + 24 * (size_t)k, by, slope);
  else
    contact_field_pull(work->layout, cells, coordinates, &evaluation->fields[k],
                       work->slopes + 96 * (size_t)k, by, slope,
                       work->pull->answers ? work->pull->answers + 4 * (size_t)k : NULL);
  for (int z = 0; z < 8 && is_carried(work, k, z / 4); z++)
    add_place(work, cells->interface, z / 4, true, tet_of(work, k, z / 4)[z % 4], vec3_at(slope + 3 * z));
}

static void pull_all(const Work *work) {
  const ContactStick *stick = work->stick;
  find_deformations(work);
  for (int k = 0; k < stick->pair_count && work->forces; k++)
    if (is_wanted(work, stick->pairs[k].interface)) pull_shared_forces(work, k);
  for (int n = 0; n < stick->node_count; n++)
    if (is_wanted(work, stick->nodes[n].interface)) pull_node(work, &stick->nodes[n]);
  for (int k = 0; k < stick->pair_count; k++) {
    if (!is_wanted(work, stick->pairs[k].interface)) continue;
    pull_gap(work, k);
    pull_pair(work, k);
    for (int side = 0; side < 2; side++)
      if (is_carried(work, k, side)) pull_tet(work, k, side);
  }
}

Status contact_stick_pull(const ContactStick *stick, ContactSystem *system,
                          const ContactEvaluation *evaluation, const ContactStickLast *last, double last_time,
                          const ContactStickPull *pull) {
  size_t pairs = (size_t)stick->pair_count;
  Work work = {.stick = stick,
               .layout = contact_system_layout(system),
               .evaluation = evaluation,
               .last = last,
               .last_time = last_time,
               .pull = pull,
               .forces = pull->forces ? contact_system_spread(system, pull->forces) : NULL,
               .pairs = memory_zeroed(pairs + 1, sizeof(PairSlopes)),
               .deformations = memory_zeroed(pairs + 1, sizeof *work.deformations),
               .shares = memory_zeroed(8 * pairs + 1, sizeof(double))};
  Status status = work.pairs && work.deformations && work.shares
                      ? STATUS_OK
                      : status_no_memory("derivatives of friction");
  if (!status) status = contact_system_slopes(system, evaluation, &work.slopes);
  if (!status) pull_all(&work);
  memory_free(work.pairs);
  memory_free(work.deformations);
  memory_free(work.shares);
  return status;
}
