// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/stick.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "contact/friction/deformation.h"
#include "contact/limits.h"

// A vertex counts as sliding from this share of its limit.
static const double SLIDES_FROM = 0.98;
// The stretch that μ_s − μ is of the spring, so often: no less is the way over which that is lost. At 1 the
// force would jump.
static const double WEAKENS_OVER = 2;

// ---- What is kept for a run.

static Status check_law(const ContactStickLaw *law) {
  if (!(law->friction >= 0 && isfinite(law->friction)))
    return status_fail(STATUS_INPUT, "friction: the coefficient is %g; it must not be negative",
                       law->friction);
  if (!(isfinite(law->at_rest) && law->length >= 0 && isfinite(law->length)))
    return status_fail(STATUS_INPUT, "friction: the coefficient at rest is %g, over %g m", law->at_rest,
                       law->length);
  if (!(law->stiffness > 0 && isfinite(law->stiffness)))
    return status_fail(STATUS_INPUT, "friction: the stiffness is %g Pa/m; it must be positive",
                       law->stiffness);
  if (!(law->weight[0] >= 0 && law->weight[1] >= 0 &&
        fabs(law->weight[0] + law->weight[1] - 1) <= CONTACT_ROUNDING))
    return status_fail(STATUS_INPUT, "friction: the weights of the two sides are %g and %g, not 1 together",
                       law->weight[0], law->weight[1]);
  return STATUS_OK;
}

Status contact_stick_create(ContactStick *stick, int vertex_count, const double *rest, const int (*tets)[4],
                            int interface_count, const ContactStickLaw *laws) {
  *stick = (ContactStick){
      .vertex_count = vertex_count, .interface_count = interface_count, .rest = rest, .tets = tets};
  for (int i = 0; i < interface_count; i++) TRY(check_law(&laws[i]));
  size_t vertices = (size_t)vertex_count, interfaces = (size_t)interface_count;
  stick->laws = memory_copy(laws, interfaces, sizeof *laws);
  stick->forces = memory_zeroed(interfaces, sizeof *stick->forces);
  stick->areas = memory_zeroed(interfaces, sizeof *stick->areas);
  stick->node_of_vertex = memory_zeroed(vertices, sizeof *stick->node_of_vertex);
  stick->place = memory_zeroed(vertices, sizeof *stick->place);
  if (!stick->laws || !stick->forces || !stick->areas || !stick->node_of_vertex || !stick->place)
    return status_no_memory("friction");
  for (size_t v = 0; v < vertices; v++) stick->node_of_vertex[v] = -1;
  return STATUS_OK;
}

void contact_stick_destroy(ContactStick *stick) {
  void *arrays[] = {stick->laws,   stick->pairs,  stick->nodes,          stick->touches,  stick->order,
                    stick->pulls,  stick->forces, stick->place,          stick->clique,   stick->outer,
                    stick->shares, stick->areas,  stick->node_of_vertex, stick->has_left, stick->motions};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  *stick = (ContactStick){0};
}

size_t contact_stick_bytes(const ContactStick *stick) {
  const void *const arrays[] = {stick->laws,           stick->pairs,    stick->nodes,  stick->touches,
                                stick->order,          stick->pulls,    stick->forces, stick->place,
                                stick->clique,         stick->outer,    stick->shares, stick->areas,
                                stick->node_of_vertex, stick->has_left, stick->motions};
  return memory_held_by(sizeof arrays / sizeof *arrays, arrays);
}

Status contact_stick_reserve(ContactStick *stick, int pair_count) {
  size_t n = (size_t)pair_count;
  bool fits = memory_reserve((void **)&stick->pairs, &stick->pair_capacity, n, sizeof *stick->pairs) &&
              memory_reserve((void **)&stick->touches, &stick->touch_capacity, n, sizeof *stick->touches) &&
              memory_reserve((void **)&stick->pulls, &stick->pull_capacity, n, sizeof *stick->pulls) &&
              memory_reserve((void **)&stick->motions, &stick->motion_capacity, n, sizeof *stick->motions) &&
              memory_reserve((void **)&stick->order, &stick->order_capacity, 8 * n, sizeof *stick->order) &&
              memory_reserve((void **)&stick->nodes, &stick->node_capacity, 8 * n, sizeof *stick->nodes);
  return fits ? STATUS_OK : status_no_memory("friction");
}

static Vec3 project(Vec3 normal, Vec3 x) {
  return vec3_sub(x, vec3_scale(vec3_dot(normal, x), normal));
}

// ---- Gathering.

// Where what is at x̄ now was at the last accepted state.
static Vec3 place_before(const ContactStick *stick, const ContactStickLast *last,
                         const ContactStickPair *pair, int side) {
  if (pair->tets[side] < 0) return vec3_at(pair->before);
  Vec3 x = {0, 0, 0};
  for (int v = 0; v < 4; v++)
    x = vec3_add(x, vec3_scale(pair->lambda[side][v],
                               vec3_at(last->positions + 3 * (size_t)stick->tets[pair->tets[side]][v])));
  return x;
}

static bool is_slave(const ContactStick *stick, const ContactStickPair *pair, int side) {
  return pair->tets[side] >= 0 && stick->laws[pair->interface].weight[side] > 0;
}

// The node of a slave's vertex, made where it is met for the first time in its interface.
static int node_at(ContactStick *stick, int interface, int vertex) {
  int *node = &stick->node_of_vertex[vertex];
  if (*node >= 0) return *node;
  stick->nodes[stick->node_count] = (ContactStickNode){.interface = interface, .vertex = vertex};
  return *node = stick->node_count++;
}

// The touches of a slave in a pair, each with w = λ |F_ij|.
static void meet(ContactStick *stick, int k, int side, double pressed) {
  const ContactStickPair *pair = &stick->pairs[k];
  for (int v = 0; v < 4; v++) {
    double w = fmax(pair->lambda[side][v], 0) * pressed;
    if (!(w > 0)) continue;
    ContactStickTouch *touch = &stick->touches[k][side][v];
    touch->node = node_at(stick, pair->interface, stick->tets[pair->tets[side]][v]);
    touch->share = w;
    stick->nodes[touch->node].end++;
  }
}

// A vertex has one node in each interface.
static void forget_vertices(ContactStick *stick, int node_begin) {
  for (int n = node_begin; n < stick->node_count; n++) stick->node_of_vertex[stick->nodes[n].vertex] = -1;
}

// Makes the nodes, with the numbers of their touches in `end`.
static void find_nodes(ContactStick *stick) {
  int first = 0;
  stick->node_count = 0;
  for (int k = 0; k < stick->pair_count; k++) {
    if (k > 0 && stick->pairs[k].interface != stick->pairs[k - 1].interface) {
      forget_vertices(stick, first);
      first = stick->node_count;
    }
    double pressed = vec3_length(vec3_at(stick->pairs[k].force));
    for (int side = 0; side < 2; side++) {
      for (int v = 0; v < 4; v++) stick->touches[k][side][v] = (ContactStickTouch){.node = -1};
      if (is_slave(stick, &stick->pairs[k], side)) meet(stick, k, side, pressed);
    }
  }
  forget_vertices(stick, first);
}

// Lists the touches node by node, in the order of the pairs.
static void order_touches(ContactStick *stick) {
  int begin = 0;
  for (int n = 0; n < stick->node_count; n++) {
    int count = stick->nodes[n].end;
    stick->nodes[n].begin = stick->nodes[n].end = begin;
    begin += count;
  }
  const ContactStickTouch *touches = stick->pair_count ? &stick->touches[0][0][0] : NULL;
  for (int t = 0; t < 8 * stick->pair_count; t++)
    if (touches[t].node >= 0) stick->order[stick->nodes[touches[t].node].end++] = t;
}

// How the slaves of all pairs have moved. Pairs of one tetrahedron stand together: its F is found once.
static void find_motions(ContactStick *stick, const ContactStickLast *last, const double *positions) {
#pragma omp parallel if (stick->pair_count > CONTACT_STICK_MANY)
  {
    const ContactStickMotion *former[2] = {NULL, NULL};
    int tets[2] = {-1, -1};
#pragma omp for schedule(static)
    for (int k = 0; k < stick->pair_count; k++)
      for (int side = 0; side < 2; side++) {
        const ContactStickPair *pair = &stick->pairs[k];
        ContactStickMotion *motion = &stick->motions[k][side];
        if (!is_slave(stick, pair, side)) continue;
        vec3_store(motion->gap, vec3_sub(place_before(stick, last, pair, 1 - side),
                                         place_before(stick, last, pair, side)));
        if (pair->tets[side] == tets[side])
          memcpy(motion->deformation, former[side]->deformation, sizeof motion->deformation);
        else
          contact_deformation_find(stick->tets[pair->tets[side]], stick->rest, positions,
                                   motion->deformation);
        tets[side] = pair->tets[side];
        former[side] = motion;
      }
  }
}

// The node's sums over its touches, whose shares go from w to w/W.
static void gather(ContactStick *stick, ContactStickNode *node) {
  const ContactStickLaw *law = &stick->laws[node->interface];
  ContactStickTouch *touches = &stick->touches[0][0][0];
  for (int r = node->begin; r < node->end; r++) {
    int t = stick->order[r], side = t / 4 % 2;
    const ContactStickPair *pair = &stick->pairs[t / 8];
    const ContactStickMotion *motion = &stick->motions[t / 8][side];
    double half = law->weight[side], w = touches[t].share, lambda = pair->lambda[side][t % 4];
    node->weight += w;
    node->stiffness += half * law->stiffness * lambda * pair->area;
    node->limit = half * law->friction; // times N once it is known
    node->excess = half * fmax(law->at_rest - law->friction, 0);
    vec3_accumulate(node->force, vec3_scale(side == 0 ? lambda : -lambda, vec3_at(pair->force)));
    vec3_accumulate(node->gap, vec3_scale(w, vec3_at(motion->gap)));
    for (int i = 0; i < 9; i++) node->deformation[i] += w * motion->deformation[i];
  }
  for (int r = node->begin; r < node->end; r++) touches[stick->order[r]].share /= node->weight;
}

// ---- The law.

// The stretch, of this direction, in which a spring of stiffness k stores that energy.
static Vec3 keep_energy(double energy, double k, Vec3 stretch) {
  double stored = 0.5 * k * vec3_dot(stretch, stretch);
  return stored > 0 ? vec3_scale(sqrt(energy / stored), stretch) : stretch;
}

// `cut`: the way that it slides since then; `spent`: what that dissipates.
static void remember_slip(const ContactStickEntry *entry, Vec3 cut, double spent, ContactStickNode *node) {
  Vec3 kept = entry ? contact_deformation_times(node->deformation, vec3_at(entry->slip)) : (Vec3){0, 0, 0};
  vec3_store(node->slid, vec3_add(kept, cut));
  node->way = (entry ? entry->way : 0) + vec3_length(cut);
  node->work = (entry ? entry->work : 0) + spent;
}

// What is left of the limit once a stretch of that length is cut off where it must be; `weak`: w before.
static void weaken(ContactStickNode *node, double weak, double given, double length) {
  double k = node->stiffness, least = node->limit, held = least + node->excess * (1 - weak);
  double over = node->over = fmax(given, WEAKENS_OVER * node->excess / k);
  node->weak = weak;
  node->limit = held;
  if (!(k * length > held)) return;
  node->weak = fmin(weak + (k * length - held) / (k - node->excess / over) / over, 1);
  node->limit = least + node->excess * (1 - node->weak);
}

// The limit where the slip begins: the stretch goes straight from `carried` by `way`, its limit from `before`
// to `now`, which it exceeds in the end. Of a vertex that stuck the limit then says nothing of what is cut
// off.
static double limit_at_onset(double k, Vec3 carried, Vec3 way, double before, double now) {
  double rise = now - before, a = k * k * vec3_dot(way, way) - rise * rise,
         b = 2 * (k * k * vec3_dot(carried, way) - before * rise),
         c = fmin(k * k * vec3_dot(carried, carried) - before * before, 0),
         root = sqrt(fmax(b * b - 4 * a * c, 0));
  double at = b > 0 ? -2 * c / (b + root) : a > 0 ? (root - b) / (2 * a) : 1;
  return before + fmin(at, 1) * rise;
}

// ∫ L over what is cut off, with N halfway between the onset, where the limit was `onset`, and now. L falls
// linearly, and stays at `least`.
static double work_of_cut(const ContactStickNode *node, const ContactStickEntry *entry, double least,
                          double onset, double cut) {
  double weak = entry ? entry->weak : 0, held = least + node->excess * (1 - weak);
  double press = held > 0 ? 0.5 * (1 + onset / held) : 0;
  double over = fmin(cut, (1 - weak) * node->over);
  return press * (0.5 * (held + node->limit) * over + least * (cut - over));
}

// From the history to the force of a node, and to what it dissipates since then.
static void return_radially(ContactStick *stick, const ContactStickHistory *history, ContactStickNode *node) {
  const ContactStickEntry *entry = contact_stick_history_find(history, node->interface, node->vertex);
  Vec3 kept = entry ? vec3_at(entry->stretch) : (Vec3){0, 0, 0};
  double before = entry ? entry->energy : 0, limit = entry ? entry->limit : 0,
         pressed = vec3_length(vec3_at(node->force));
  Vec3 normal = pressed > 0 ? vec3_scale(1 / pressed, vec3_at(node->force)) : (Vec3){0, 0, 0};
  for (int r = 0; r < 9; r++) node->deformation[r] /= node->weight;
  node->limit *= pressed;
  node->excess *= pressed;
  double k = node->stiffness, least = node->limit;
  Vec3 carried = project(normal, keep_energy(before, k, contact_deformation_times(node->deformation, kept)));
  Vec3 way = project(normal, vec3_scale(1 / node->weight, vec3_at(node->gap))),
       trial = vec3_add(carried, way);
  double length = vec3_length(trial), held = least + node->excess * (1 - (entry ? entry->weak : 0));
  if (node->excess > 0) weaken(node, entry ? entry->weak : 0, stick->laws[node->interface].length, length);
  node->slips = k * length > node->limit;
  node->advances = vec3_dot(way, trial) > 0;
  double kept_share = node->slips ? node->limit / (k * length) : 1;
  Vec3 stretch = vec3_scale(kept_share, trial);
  vec3_store(node->normal, normal);
  vec3_store(node->gap, trial);
  node->trial = length;
  vec3_store(node->stretch, stretch);
  vec3_store(node->force, vec3_scale(-k, stretch));
  double onset = node->slips ? limit_at_onset(k, carried, way, limit, held) : 0;
  double cut = node->slips ? 0.5 * (onset + node->limit) * (1 - kept_share) * length : 0;
  if (node->slips && node->excess > 0)
    cut = work_of_cut(node, entry, least, onset, (1 - kept_share) * length);
  node->kept = before;
  node->spent = before - 0.5 * k * vec3_dot(carried, carried) + cut;
  remember_slip(entry, vec3_scale(1 - kept_share, trial), node->spent, node);
  if (entry) stick->has_left[entry - history->entries] = false;
}

static bool rests(const ContactStickEntry *entry, const bool *is_resting) {
  return is_resting && is_resting[(int)entry->interface];
}

// A vertex that nothing presses any more, or no longer so that it is found: what it stored is lost.
static double energy_of_left(const ContactStick *stick, const ContactStickHistory *history,
                             const bool *is_resting) {
  double left = 0;
  for (int i = 0; i < history->entry_count; i++)
    if (!rests(&history->entries[i], is_resting)) left += history->entries[i].energy;
  for (int n = 0; n < stick->node_count; n++) left -= stick->nodes[n].kept;
  return left;
}

static double energy_at_rest(const ContactStickHistory *history, const bool *is_resting) {
  double sum = 0;
  for (int i = 0; i < history->entry_count; i++)
    if (rests(&history->entries[i], is_resting)) sum += history->entries[i].energy;
  return sum;
}

// Σ (w/W) T_a of each pair, on its side 0, and of each interface.
static void share_forces(ContactStick *stick, const ContactStickHistory *history, const bool *is_resting) {
  for (int i = 0; i < stick->interface_count; i++)
    vec3_store(stick->forces[i], is_resting && is_resting[i] ? vec3_at(history->forces[i]) : (Vec3){0, 0, 0});
#pragma omp parallel for schedule(static) if (stick->pair_count > CONTACT_STICK_MANY)
  for (int k = 0; k < stick->pair_count; k++) {
    Vec3 pull = {0, 0, 0};
    for (int side = 0; side < 2; side++)
      for (int v = 0; v < 4; v++) {
        const ContactStickTouch *touch = &stick->touches[k][side][v];
        if (touch->node < 0) continue;
        double share = side == 0 ? touch->share : -touch->share;
        pull = vec3_add(pull, vec3_scale(share, vec3_at(stick->nodes[touch->node].force)));
      }
    vec3_store(stick->pulls[k], pull);
  }
  for (int k = 0; k < stick->pair_count; k++)
    vec3_accumulate(stick->forces[stick->pairs[k].interface], vec3_at(stick->pulls[k]));
}

// Where the press grows a little, what slides sticks for a step at nearly all of its limit: that counts as
// sliding.
bool contact_stick_slides(const ContactStickNode *node) {
  return vec3_length(vec3_at(node->force)) >= SLIDES_FROM * node->limit;
}

// What sticks and what slides, k_a / c_t of the vertices.
static void share_areas(ContactStick *stick, const ContactStickHistory *history, const bool *is_resting) {
  for (int i = 0; i < stick->interface_count; i++)
    for (int k = 0; k < 2; k++) stick->areas[i][k] = is_resting && is_resting[i] ? history->areas[i][k] : 0;
  for (int n = 0; n < stick->node_count; n++) {
    const ContactStickNode *node = &stick->nodes[n];
    stick->areas[node->interface][contact_stick_slides(node)] +=
        node->stiffness / stick->laws[node->interface].stiffness;
  }
}

// All have left but those that are met.
static Status expect_left(ContactStick *stick, const ContactStickHistory *history) {
  size_t count = (size_t)history->entry_count;
  if (!memory_reserve((void **)&stick->has_left, &stick->left_capacity, count, sizeof *stick->has_left))
    return status_no_memory("friction");
  for (size_t i = 0; i < count; i++) stick->has_left[i] = true;
  return STATUS_OK;
}

Status contact_stick_eval(ContactStick *stick, const ContactStickLast *last, int pair_count,
                          const double *positions, const bool *is_resting) {
  const ContactStickHistory *history = &last->history;
  stick->pair_count = pair_count;
  TRY(contact_stick_reserve(stick, pair_count));
  TRY(expect_left(stick, history));
  find_nodes(stick);
  order_touches(stick);
  find_motions(stick, last, positions);
#pragma omp parallel for schedule(static) if (stick->pair_count > CONTACT_STICK_MANY)
  for (int n = 0; n < stick->node_count; n++) {
    gather(stick, &stick->nodes[n]);
    return_radially(stick, history, &stick->nodes[n]);
  }
  stick->slip_count = 0;
  stick->spent = energy_of_left(stick, history, is_resting);
  stick->stored = energy_at_rest(history, is_resting);
  for (int n = 0; n < stick->node_count; n++) {
    const ContactStickNode *node = &stick->nodes[n];
    stick->spent += node->spent;
    stick->stored += 0.5 * node->stiffness * vec3_dot(vec3_at(node->stretch), vec3_at(node->stretch));
    stick->slip_count += node->slips;
  }
  share_forces(stick, history, is_resting);
  share_areas(stick, history, is_resting);
  return STATUS_OK;
}

static void push_pair(const ContactStick *stick, int k, double *force) {
  const ContactStickPair *pair = &stick->pairs[k];
  for (int side = 0; side < 2; side++) {
    if (pair->tets[side] < 0) continue;
    for (int v = 0; v < 4; v++) {
      double share = side == 0 ? pair->lambda[0][v] : -pair->lambda[1][v];
      contact_stars_push(stick->stars, stick->tets[pair->tets[side]][v],
                         vec3_scale(share, vec3_at(stick->pulls[k])), force);
    }
  }
}

void contact_stick_add_force(const ContactStick *stick, double *force) {
  for (int k = 0; k < stick->pair_count; k++) push_pair(stick, k, force);
}

void contact_stick_add_force_of(const ContactStick *stick, int interface, double *force) {
  for (int k = 0; k < stick->pair_count; k++)
    if (stick->pairs[k].interface == interface) push_pair(stick, k, force);
}

// ---- The matrix.

// The vertices that a node couples into stick->clique, ω into stick->shares; how many. −1: no memory.
static int collect(ContactStick *stick, const ContactStickNode *node) {
  size_t most = 8 * (size_t)(node->end - node->begin);
  if (!memory_reserve((void **)&stick->clique, &stick->clique_capacity, most, sizeof *stick->clique) ||
      !memory_reserve((void **)&stick->shares, &stick->share_capacity, most, sizeof *stick->shares) ||
      !memory_reserve((void **)&stick->outer, &stick->outer_capacity, 3 * most, sizeof *stick->outer))
    return -1;
  int count = 0;
  for (int r = node->begin; r < node->end; r++) {
    int t = stick->order[r], slave = t / 4 % 2;
    const ContactStickPair *pair = &stick->pairs[t / 8];
    double share = stick->touches[t / 8][slave][t % 4].share;
    for (int side = 0; side < 2; side++)
      for (int v = 0; v < 4 && pair->tets[side] >= 0; v++) {
        int vertex = stick->tets[pair->tets[side]][v], *place = &stick->place[vertex];
        if (*place == 0) {
          stick->clique[count] = vertex;
          stick->shares[count] = 0;
          *place = ++count;
        }
        stick->shares[*place - 1] += (side == slave ? share : -share) * pair->lambda[side][v];
      }
  }
  for (int i = 0; i < count; i++) stick->place[stick->clique[i]] = 0;
  return count;
}

// Two unit vectors that make a right-handed frame with the normal, the first along `along` if that is long
// enough.
static void find_tangents(Vec3 normal, Vec3 along, Vec3 tangent[2]) {
  double length = vec3_length(along);
  if (!(length > 0)) {
    along = vec3_cross(normal, fabs(normal.x) < 0.5 ? (Vec3){1, 0, 0} : (Vec3){0, 1, 0});
    length = vec3_length(along);
  }
  tangent[0] = vec3_scale(1 / length, along);
  tangent[1] = vec3_cross(normal, tangent[0]);
}

Status contact_stick_add_stiffness(ContactStick *stick, const ContactStiffnessSink *sink) {
  for (int n = 0; n < stick->node_count; n++) {
    const ContactStickNode *node = &stick->nodes[n];
    double across = node->slips ? node->limit / node->trial : node->stiffness;
    const double slopes[2] = {node->slips ? 0 : node->stiffness, across};
    Vec3 tangent[2];
    if (!(across > 0)) continue;
    int count = collect(stick, node);
    if (count < 0) return status_no_memory("friction");
    find_tangents(vec3_at(node->normal), vec3_at(node->gap), tangent);
    for (int k = 0; k < 2; k++) {
      if (!(slopes[k] > 0)) continue;
      for (int i = 0; i < count; i++)
        vec3_store(stick->outer + 3 * i, vec3_scale(stick->shares[i], tangent[k]));
      sink->add_outer(sink->self, count, stick->clique, stick->outer, slopes[k]);
    }
  }
  return STATUS_OK;
}

Status contact_stick_couple(ContactStick *stick, void *visitor,
                            Status (*visit)(void *visitor, int count, const int *vertices)) {
  for (int n = 0; n < stick->node_count; n++) {
    int count = collect(stick, &stick->nodes[n]);
    if (count < 0) return status_no_memory("friction");
    TRY(visit(visitor, count, stick->clique));
  }
  return STATUS_OK;
}

// ---- Accepting.

static bool is_kept(const ContactStickNode *node) {
  return node->limit > 0 || node->work > 0;
}

// What stays of an entry without a node: all of one at rest; what was done so far of one that has left, which
// loses its spring.
static bool keep_entry(const ContactStickEntry *entry, bool is_resting, ContactStickEntry *kept) {
  *kept = *entry;
  if (is_resting) return true;
  *kept = (ContactStickEntry){.interface = entry->interface,
                              .vertex = entry->vertex,
                              .way = entry->way,
                              .work = entry->work + entry->energy};
  return kept->work > 0;
}

// What slides may stick for a step (contact_stick_slides): only what does not go on, or is far below its
// limit, has come to rest.
static bool sticks_again(const ContactStickNode *node) {
  return !node->slips && (!node->advances || !contact_stick_slides(node));
}

static ContactStickEntry entry_of(const ContactStickNode *node) {
  Vec3 stretch = vec3_at(node->stretch);
  double regained = sticks_again(node) ? node->weak : 0;
  ContactStickEntry entry = {.interface = node->interface,
                             .vertex = node->vertex,
                             .energy = 0.5 * node->stiffness * vec3_dot(stretch, stretch),
                             .limit = node->limit + node->excess * regained,
                             .weak = node->weak - regained,
                             .slides = contact_stick_slides(node),
                             .way = node->way,
                             .work = node->work};
  vec3_store(entry.stretch, contact_deformation_divide(node->deformation, stretch));
  vec3_store(entry.slip, contact_deformation_divide(node->deformation, vec3_at(node->slid)));
  vec3_store(entry.slid, vec3_at(node->slid));
  return entry;
}

// Writes the entries of the next history; how many. NULL: counts them.
static int list_entries(const ContactStick *stick, const ContactStickHistory *history, const bool *is_resting,
                        ContactStickEntry *entries) {
  int count = 0;
  for (int i = 0; i < history->entry_count; i++) {
    ContactStickEntry kept;
    const ContactStickEntry *entry = &history->entries[i];
    if (!stick->has_left[i] || !keep_entry(entry, rests(entry, is_resting), &kept)) continue;
    if (entries) entries[count] = kept;
    count++;
  }
  for (int n = 0; n < stick->node_count; n++) {
    if (!is_kept(&stick->nodes[n])) continue;
    if (entries) entries[count] = entry_of(&stick->nodes[n]);
    count++;
  }
  return count;
}

size_t contact_stick_next_count(const ContactStick *stick, const ContactStickHistory *history,
                                const bool *is_resting) {
  return contact_stick_history_count(stick->interface_count, list_entries(stick, history, is_resting, NULL));
}

void contact_stick_advance(const ContactStick *stick, const ContactStickHistory *history,
                           const bool *is_resting, double *values) {
  size_t count = contact_stick_next_count(stick, history, is_resting);
  ContactStickHistory next = contact_stick_history_view(stick->interface_count, values, count);
  *next.dissipated = *history->dissipated + stick->spent;
  memcpy(next.forces, stick->forces, (size_t)stick->interface_count * sizeof *next.forces);
  memcpy(next.areas, stick->areas, (size_t)stick->interface_count * sizeof *next.areas);
  list_entries(stick, history, is_resting, next.entries);
  contact_stick_history_sort(&next);
}
