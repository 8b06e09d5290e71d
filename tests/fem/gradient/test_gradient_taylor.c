// SPDX-License-Identifier: GPL-3.0-or-later
// Every term of the residual by itself: what its derivatives leave of a symmetric difference along a way in
// positions, velocities, the last accepted state and a parameter falls with the third power of the way
// (Taylor's remainder).
#include "app/gradient/parameter.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/gradient/change.h"
#include "scene.h"

enum { MOST = 10, HALVINGS = 2 };

typedef struct Term {
  const char *name, *scene, *settings[3]; // ended by NULL
  const FemEffectOps *effects[4];         // what acts; none: inertia
  const char *by[MOST];                   // ended by NULL
  double time;                            // [s]
  double slide;                           // of the second body before that, once friction remembers [m]
  double way;                             // as a share of edges and parameters; 0: 1e-3
} Term;

#define BODY "bodies.slab.material."
#define MATERIALS &fem_effect_elasticity, &fem_effect_volume
#define DEEP "bodies.upper.place.translate[2]=0.47"
static const Term terms[] = {
    {"neo_hookean and stvk", "gradient_blocks", .effects = {MATERIALS},
     .by = {"bodies.lower.material.young", "bodies.lower.material.poisson", "bodies.upper.material.poisson"}},
    {"linear", "gradient_roll", {BODY "law=linear"}, {MATERIALS}, .by = {BODY "young", BODY "poisson"}},
    {"corotational",
     "gradient_roll",
     {BODY "law=corotational"},
     {MATERIALS},
     .by = {BODY "young", BODY "poisson"}},
    {"neo_hookean_log",
     "gradient_roll",
     {BODY "law=neo_hookean_log"},
     {MATERIALS},
     .by = {BODY "young", BODY "poisson"}},
    {"neo_hookean_isochoric",
     "gradient_roll",
     {BODY "law=neo_hookean_isochoric"},
     {MATERIALS},
     .by = {BODY "young", BODY "poisson"}},
    {"mooney_rivlin, fibres, nodal elements", "gradient_obstacles", .effects = {MATERIALS},
     .by = {BODY "young", BODY "poisson", BODY "mooney", BODY "fibre.modulus", BODY "fibre.direction[1]"}},
    {"ogden, quadratic elements", "gradient_shapes", .effects = {MATERIALS},
     .by = {BODY "poisson", BODY "ogden.exponents[0]", BODY "ogden.exponents[1]", BODY "ogden.shares[0]"}},
    {"driven vertices", "gradient_obstacles", .effects = {MATERIALS}, .time = 0.7,
     .by = {"bodies.slab.driven[0].velocity[2]", "bodies.slab.driven[0].amplitude[0]",
            "bodies.slab.driven[0].frequency", "bodies.slab.driven[0].spin"}},
    {"damping and viscosity", "gradient_damped", .effects = {&fem_effect_damping}, .time = 0.01,
     .by = {"effects.damping", "bodies.upper.material.damping", "bodies.upper.material.viscosity",
            "bodies.upper.material.bulk_viscosity", "bodies.lower.driven[0].spin"}},
    {"plasticity",
     "gradient_yield",
     {"contact=null"},
     {MATERIALS, &fem_effect_plasticity},
     .slide = 7e-3,
     .time = 0.01,
     .way = 3e-4,
     .by = {"bodies.lower.material.young", "bodies.lower.material.poisson",
            "bodies.lower.material.plasticity.yield", "bodies.lower.material.plasticity.hardening",
            "bodies.upper.material.plasticity.yield", "bodies.upper.driven[0].table[1][1]"}},
    {"inertia", "gradient_motion", .by = {"bodies.upper.material.density"}},
    {"gravity", "gradient_blocks", .effects = {&fem_effect_gravity}, .time = 0.7,
     .by = {"effects.gravity[2]", "bodies.upper.material.density"}},
    {"loads", "gradient_motion", .effects = {&fem_effect_loads}, .time = 0.01,
     .by = {"bodies.upper.loads[0].force[1]"}},
    {"following pressures", "gradient_inflate", .effects = {&fem_effect_loads}, .time = 0.7,
     .by = {"bodies.block.loads[1].pressure", "bodies.plate.loads[0].pressure"}},
    {"contact by clip", "gradient_blocks", {DEEP}, {&fem_effect_contact}, .by = {"contact.stiffness"}},
    {"contact by geo",
     "gradient_blocks",
     {DEEP, "contact.overlap=geo"},
     {&fem_effect_contact},
     .by = {"contact.stiffness"}},
    {"contact by hybrid",
     "gradient_blocks",
     {DEEP, "contact.overlap=hybrid"},
     {&fem_effect_contact},
     .by = {"contact.stiffness"}},
    {"contact by a law",
     "gradient_blocks",
     {DEEP, "contact={law: {power: {pressure: 1e4, depth: 0.005, exponent: 2.5}}}"},
     {&fem_effect_contact},
     .by = {"contact.law.power.pressure", "contact.law.power.depth", "contact.law.power.exponent"}},
    {"a smooth surface",
     "gradient_ball",
     {"contact.smooth=1"},
     {&fem_effect_contact},
     .time = 0.7,
     .by = {"contact.stiffness"}},
    {"obstacles", "gradient_obstacles", .effects = {&fem_effect_contact}, .time = 0.7,
     .by = {"obstacles.ball.sphere.centre[0]", "obstacles.ball.motion.velocity[1]",
            "obstacles.floor.halfspace.point[2]", "contact.pairs[0].stiffness", "contact.stiffness"}},
    {"obstacles that turn", "gradient_shapes", .effects = {&fem_effect_contact}, .time = 0.7,
     .by = {"obstacles.bar.motion.spin", "obstacles.bar.box.centre[0]", "obstacles.roll.cylinder.centre[2]",
            "obstacles.plate.motion.spin", "obstacles.plate.place.translate[2]"}},
    {"friction",
     "gradient_rub",
     {DEEP},
     {&fem_effect_stick},
     .slide = 7e-3,
     .time = 0.01,
     .by = {"contact.friction", "contact.stiffness"}},
    {"friction by geo",
     "gradient_rub",
     {DEEP, "contact.overlap=geo"},
     {&fem_effect_stick},
     .slide = 7e-3,
     .time = 0.01,
     .by = {"contact.friction", "contact.stiffness"}},
    {"friction on obstacles", "gradient_drag", .effects = {&fem_effect_stick}, .slide = 4e-3, .time = 0.5,
     .way = 3e-4,
     .by = {"contact.friction", "contact.pairs[0].friction", "obstacles.floor.halfspace.point[2]"}},
};

// A scene with a value of the parameter.
typedef struct Side {
  SceneRun scene;
  FemSystem system;
  FemState state;
} Side;

static void open_side(Side *side, const Term *term, const char *override) {
  const char *settings[4] = {term->settings[0], term->settings[1]};
  int count = 0;
  while (settings[count]) count++;
  settings[count] = override;
  scene_open(&side->scene, term->scene, settings);
  ck_assert_ok(fem_system_create(&side->system, &side->scene.model));
  ck_assert_ok(fem_system_create_state(&side->system, &side->state));
}

static void close_side(Side *side) {
  fem_state_destroy(&side->state);
  fem_system_destroy(&side->system);
  scene_close(&side->scene);
}

// Where the derivatives are taken, and along which way.
typedef struct Place {
  const Term *term;
  Side side; // of the scene as it is; its accepted state is the last one
  FemState before;
  int n, values, entries;
  double *u, *v, *u_way, *v_way; // of unknowns                                      (n)
  double *last_way, *lambda;     // of all coordinates                               (values)
  double *rate, *rate_way;       // accelerations                                    (values)
  double (*history_way)[3];      // of q, contact/friction/stick_pull.h              (entries)
  double *plastic_way;           // of what plasticity remembers                     (numbers)
  int numbers;
  double step; // of the parameter
} Place;

static double *draw(Random *random, int count, double size) {
  double *values = memory_zeroed((size_t)count, sizeof *values);
  for (int i = 0; i < count; i++) values[i] = random_between(random, -size, size);
  return values;
}

static void *stick_of(const Place *place) {
  return place->term->slide > 0 ? fem_system_effect(&place->side.system, &fem_effect_stick) : NULL;
}

static ContactStickHistory history_of(const Place *place, const FemState *state) {
  void *stick = stick_of(place);
  return fem_effect_stick_history(stick, &state->histories[fem_effect_stick_place(stick)]);
}

// Of plasticity, where it is the term; else NULL.
static FemEffectHistory *plastic_of(const Place *place, FemState *state) {
  if (place->term->effects[2] != &fem_effect_plasticity) return NULL;
  int of = fem_effect_plasticity_place(fem_system_effect(&place->side.system, &fem_effect_plasticity));
  return &state->histories[of];
}

// Two states are accepted, and a third is tried; the last body, or the only one, has slid at each; all, where
// they yield, since a point that stays is at its edge.
static void accept_states(Place *place, Random *random) {
  Side *side = &place->side;
  const FemModel *model = &side->scene.model;
  int begin = plastic_of(place, &side->state) ? 0 : model->bodies[model->body_count - 1].vertex_begin;
  ck_assert_ok(fem_system_begin(&side->system, &side->state, 0));
  for (int k = 1; k < 3; k++) {
    for (int i = 0; i < place->n; i++) {
      int dof = side->system.numbering.dof_of_unknown[i];
      double slide = place->term->slide * random_between(random, 0, 1);
      if (dof / 3 >= begin && dof % 3 < 2) place->u[i] += slide;
    }
    fem_system_scatter(&side->system, place->term->time * (1 + 0.1 * k), place->u, place->v, &side->state);
    ck_assert_ok(fem_system_renew(&side->system, &side->state));
    if (k == 1) ck_assert_ok(fem_system_accept(&side->system, &side->state, 0));
  }
}

// That some vertices stick and some slip.
static void check_friction(Place *place) {
  const ContactStick *law;
  int slips = 0;
  ck_assert_ok(fem_effect_stick_evaluate(stick_of(place), &place->side.state, &law));
  for (int k = 0; k < law->node_count; k++) slips += law->nodes[k].slips;
  ck_assert_int_gt(slips, 0);
  ck_assert_int_lt(slips, law->node_count);
  ContactStickHistory history = history_of(place, &place->side.system.accepted);
  place->entries = history.entry_count;
  ck_assert_int_gt(place->entries, 0);
}

// That some points yield and some do not, of those that had yielded.
static void check_plasticity(Place *place, const FemEffectHistory *history) {
  const FemState *state = &place->side.state;
  FemEffectHistory next = {0};
  void *effect = fem_system_effect(&place->side.system, &fem_effect_plasticity);
  int yields = 0, did = 0, count = fem_effect_plasticity_count(effect);
  ck_assert_ok(fem_effect_plasticity.advance(effect, state, &next));
  const FemPlastic *was = (const FemPlastic *)history->values, *is = (const FemPlastic *)next.values;
  for (int i = 0; i < count; i++) did += was[i].alpha > 0, yields += is[i].alpha > was[i].alpha;
  ck_assert_int_gt(did, 0);
  ck_assert_int_gt(yields, 0);
  ck_assert_int_lt(yields, count);
  fem_effect_history_destroy(&next);
}

static void draw_plastic(Place *place, Random *random) {
  static const double STRAIN = 0.02;
  const FemEffectHistory *history = plastic_of(place, &place->side.system.accepted);
  if (!history) return;
  check_plasticity(place, history);
  place->numbers = (int)history->count;
  place->plastic_way = draw(random, place->numbers, STRAIN);
  FemPlastic *way = (FemPlastic *)place->plastic_way;
  for (size_t i = 0; i < history->count * sizeof(double) / sizeof *way; i++)
    for (int k = 0; k < 9; k++) way[i].strain[k] = way[i].strain[3 * (k % 3) + k / 3];
}

static void draw_history(Place *place, Random *random) {
  draw_plastic(place, random);
  if (!stick_of(place)) return;
  check_friction(place);
  ContactStickHistory history = history_of(place, &place->side.system.accepted);
  place->history_way = memory_zeroed((size_t)place->entries, sizeof *place->history_way);
  for (int e = 0; e < place->entries; e++)
    for (int c = 0; c < 3; c++)
      place->history_way[e][c] = sqrt(history.entries[e].energy) * random_between(random, -1, 1);
}

// The adjoint is 0 on vertices of mesh obstacles.
static void forget_obstacles(Place *place) {
  const FemModel *model = &place->side.scene.model;
  for (int a = model->bodies[model->scene->body_count - 1].vertex_end; a < model->vertex_count; a++)
    for (int c = 0; c < 3; c++) place->lambda[3 * a + c] = 0;
}

static void open_place(Place *place, const Term *term) {
  static const double BENT = 0.02, SPEED = 0.1;
  Random random = random_seeded(11, 0);
  *place = (Place){.term = term};
  open_side(&place->side, term, NULL);
  FemSystem *system = &place->side.system;
  double edge = place->side.scene.model.edge;
  int n = place->n = system->numbering.count, values = place->values = 3 * system->model->vertex_count;
  place->u = draw(&random, n, BENT * edge);
  place->v = draw(&random, n, SPEED);
  place->u_way = draw(&random, n, edge);
  place->v_way = draw(&random, n, SPEED);
  place->last_way = draw(&random, values, edge);
  place->lambda = draw(&random, values, 1);
  forget_obstacles(place);
  place->rate = draw(&random, values, 1);
  place->rate_way = draw(&random, values, 1);
  fem_system_scatter(system, term->time, place->u, place->v, &place->side.state);
  ck_assert_ok(fem_system_renew(system, &place->side.state));
  accept_states(place, &random);
  draw_history(place, &random);
  ck_assert_ok(
      fem_state_create(&place->before, values / 3, system->accepted.positions, system->accepted.velocities));
  for (int e = 0; e < system->effect_count; e++) {
    const FemEffectHistory *history = &system->accepted.histories[e];
    ck_assert_ok(fem_effect_history_set(&place->before.histories[e], history->values, history->count));
  }
  place->before.time = system->accepted.time;
}

static void close_place(Place *place) {
  void *arrays[] = {place->u,      place->v,    place->u_way,    place->v_way,       place->last_way,
                    place->lambda, place->rate, place->rate_way, place->history_way, place->plastic_way};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i]);
  fem_state_destroy(&place->before);
  close_side(&place->side);
}

static double dot(int count, const double *x, const double *y) {
  double sum = 0;
  for (int i = 0; i < count; i++) sum += x[i] * y[i];
  return sum;
}

// ---- λ · term, somewhere on the way.

static void move_last(Place *place, double share) {
  FemState *accepted = &place->side.system.accepted;
  for (int i = 0; i < place->values; i++)
    place->before.positions[i] = accepted->positions[i] + share * place->last_way[i];
  place->before.version = fem_state_new_version();
  for (int i = 0; i < place->numbers; i++)
    plastic_of(place, &place->before)->values[i] =
        plastic_of(place, &place->side.system.accepted)->values[i] + share * place->plastic_way[i];
  if (!stick_of(place)) return;
  ContactStickHistory from = history_of(place, accepted), to = history_of(place, &place->before);
  for (int e = 0; e < place->entries; e++) {
    Vec3 stretch = vec3_at(from.entries[e].stretch);
    double length = vec3_length(stretch), size = sqrt(2 * from.entries[e].energy);
    if (!(size > 0)) continue;
    Vec3 q = vec3_add(vec3_scale(size / length, stretch), vec3_scale(share, vec3_at(place->history_way[e])));
    vec3_store(to.entries[e].stretch, q);
    to.entries[e].energy = 0.5 * vec3_dot(q, q);
  }
}

// At `share` of the way; the largest that it could be in *size.
static double work_at(Place *place, Side *side, double share, double *size) {
  int n = place->n;
  const Term *term = place->term;
  double *u = memory_copy(place->u, (size_t)n, sizeof *u), *v = memory_copy(place->v, (size_t)n, sizeof *v);
  double *force = memory_zeroed((size_t)place->values, sizeof *force);
  for (int i = 0; i < n; i++) u[i] += share * place->u_way[i], v[i] += share * place->v_way[i];
  fem_system_scatter(&side->system, place->side.state.time, u, v, &side->state);
  side->state.version = fem_state_new_version();
  move_last(place, share);
  side->state.last = &place->before;
  ck_assert_ok(fem_system_renew(&side->system, &side->state));
  for (const FemEffectOps *const *ops = term->effects; *ops; ops++) {
    void *effect = fem_system_effect(&side->system, *ops);
    if (effect) ck_assert_ok((*ops)->add_force(effect, &side->state, force));
  }
  for (int i = 0; i < place->values && !term->effects[0]; i++)
    force[i] = -side->scene.model.mass[i / 3] * (place->rate[i] + share * place->rate_way[i]);
  *size = 0;
  for (int i = 0; i < place->values; i++) *size += fabs(place->lambda[i] * force[i]);
  double work = dot(place->values, place->lambda, force);
  memory_free(u);
  memory_free(v);
  memory_free(force);
  return work;
}

// ---- Its derivative along the way, by what gradients are found with.

// The matrix is that of these effects alone.
typedef struct Mute {
  FemEffectOps ops[FEM_MAX_EFFECTS];
  const FemEffectOps *kept[FEM_MAX_EFFECTS];
} Mute;

static bool acts(const Term *term, const FemEffectOps *effect) {
  for (const FemEffectOps *const *ops = term->effects; *ops; ops++)
    if (*ops == effect) return true;
  return effect == &fem_effect_contact && acts(term, &fem_effect_stick); // which builds on it
}

static void mute(FemSystem *system, const Term *term, Mute *muted) {
  for (int e = 0; e < system->effect_count; e++) {
    muted->kept[e] = system->effects[e].ops;
    muted->ops[e] = *muted->kept[e];
    muted->ops[e].add_jacobian = NULL;
    if (!acts(term, muted->kept[e])) system->effects[e].ops = &muted->ops[e];
  }
}

static void unmute(FemSystem *system, const Mute *muted) {
  for (int e = 0; e < system->effect_count; e++) system->effects[e].ops = muted->kept[e];
}

// The way of all coordinates and velocities.
static void spread_way(const Place *place, const FemChange *change, double *way, double *speed) {
  const int *dofs = place->side.system.numbering.dof_of_unknown;
  for (int i = 0; i < place->values; i++) {
    way[i] = place->step * change->motion[i];
    speed[i] = place->step * change->speed[i];
  }
  for (int i = 0; i < place->n; i++) way[dofs[i]] = place->u_way[i], speed[dofs[i]] = place->v_way[i];
}

static double slope_of_inertia(const Place *place, const FemChange *change) {
  double sum = 0;
  for (int i = 0; i < place->values; i++)
    sum -= place->lambda[i] * (place->side.scene.model.mass[i / 3] * place->rate_way[i] +
                               place->step * change->masses[i / 3] * place->rate[i]);
  return sum;
}

static double slope_of_forces(const Place *place, const FemTangent *tangent, const FemChange *change,
                              const double *way) {
  double *product = memory_zeroed((size_t)place->values, sizeof *product);
  ck_assert_ok(fem_tangent_pull(tangent, place->lambda, product));
  double slope =
      place->step * dot(place->values, place->lambda, change->force) - dot(place->values, product, way);
  memory_free(product);
  return slope;
}

static double slope_of_damping(Place *place, const double *way, const double *speed) {
  FemDamping damping;
  ck_assert_ok(fem_damping_create(&damping, &place->side.system));
  if (!damping.effect) return 0;
  fem_damping_begin(&damping, &place->side.state);
  ck_assert_ok(fem_damping_pull(&damping, place->lambda, 1));
  double slope = dot(place->values, damping.now, way) + dot(place->values, damping.rate, speed);
  fem_damping_destroy(&damping);
  return slope;
}

static double slope_of_friction(Place *place, const FemTangent *tangent, const FemChange *change,
                                const double *way) {
  FemFriction friction;
  ck_assert_ok(fem_friction_create(&friction, &place->side.system));
  ck_assert_ok(fem_friction_begin(&friction, &place->side.state));
  ck_assert_ok(fem_friction_pull(&friction, CONTACT_ALL_INTERFACES, place->lambda, 1));
  double slope = dot(place->values, friction.now, way) + dot(place->values, friction.then, place->last_way);
  for (int e = 0; e < place->entries; e++) slope += dot(3, friction.before[e], place->history_way[e]);
  for (int i = 0; i < friction.interface_count; i++) {
    slope += place->step * (change->rates[i] * friction.stiffness[i] + change->slips[i] * friction.slip[i]);
    for (int c = 0; c < 3 && fem_change_moves(change, tangent, i); c++)
      slope -= place->step * change->shift[c] * (friction.moves[i][0][c] + friction.moves[i][1][c]);
  }
  fem_friction_destroy(&friction);
  return slope;
}

static double slope_of_yielding(Place *place, const FemParameter *parameter) {
  FemYielding yielding;
  if (place->numbers == 0) return 0;
  ck_assert_ok(fem_yielding_create(&yielding, &place->side.system));
  fem_yielding_begin(&yielding, &place->side.state);
  fem_yielding_pull(&yielding, place->lambda, 1);
  double slope = dot(place->numbers, (const double *)yielding.before, place->plastic_way);
  if (parameter) slope += place->step * fem_yielding_change(&yielding, parameter);
  fem_yielding_destroy(&yielding);
  return slope;
}

static double slope_with(Place *place, const FemTangent *tangent, const FemChange *change) {
  double *way = memory_zeroed((size_t)place->values, sizeof *way), slope;
  double *speed = memory_zeroed((size_t)place->values, sizeof *speed);
  spread_way(place, change, way, speed);
  if (!place->term->effects[0])
    slope = slope_of_inertia(place, change);
  else if (stick_of(place))
    slope = slope_of_friction(place, tangent, change, way);
  else
    slope = slope_of_forces(place, tangent, change, way) + slope_of_damping(place, way, speed);
  memory_free(way);
  memory_free(speed);
  return slope;
}

static double slope_of(Place *place, const FemParameter *parameter) {
  FemSystem *system = &place->side.system;
  FemVaried varied;
  FemTangent tangent;
  FemChange change;
  Mute muted;
  mute(system, place->term, &muted);
  ck_assert_ok(fem_varied_create(&varied, system->model));
  ck_assert_ok(fem_tangent_create(&tangent, system));
  ck_assert_ok(fem_tangent_find(&tangent, &place->side.state));
  ck_assert_ok(fem_change_create(&change, &tangent));
  if (parameter) ck_assert_ok(fem_change_find(&change, &varied, &tangent, parameter, false));
  double slope = slope_with(place, &tangent, &change) + slope_of_yielding(place, parameter);
  fem_change_destroy(&change);
  fem_tangent_destroy(&tangent);
  fem_varied_destroy(&varied);
  unmute(system, &muted);
  return slope;
}

// ---- The remainder.

// At `share` of the way.
static double remainder_at(Place *place, const char *key, double middle, double share, double slope,
                           double *size) {
  double works[2], sizes[2];
  for (int k = 0; k < 2; k++) {
    char override[128];
    double own = k == 0 ? share : -share;
    Side side;
    snprintf(override, sizeof override, "%s=%.17g", key ? key : "", middle + own * place->step);
    open_side(&side, place->term, key ? override : NULL);
    works[k] = work_at(place, &side, own, &sizes[k]);
    close_side(&side);
  }
  *size = fmax(sizes[0], sizes[1]);
  return fabs(works[0] - works[1] - 2 * share * slope);
}

// What forces are rounded to, as a share of their sum.
static const double ROUNDED = 1e-13, ORDER = 2.8;

// Of the whole way, its half, its quarter; with a parameter also that it acts. Returns the slope.
static double check_term(Place *place, const char *key, double still) {
  FemParameter parameter;
  double middle = 0, way = place->term->way > 0 ? place->term->way : 1e-3, left[HALVINGS + 1], size = 0;
  if (key) {
    ck_assert_ok(app_gradient_read_parameter(&place->side.scene.model, key, &parameter));
    middle = fem_parameter_value(&place->side.scene.model, &parameter);
  }
  place->step = middle != 0 ? middle : 1;
  double slope = slope_of(place, key ? &parameter : NULL);
  if (key) ck_assert_double_ne(slope, still);
  for (int k = 0; k <= HALVINGS; k++)
    left[k] = remainder_at(place, key, middle, way / (1 << k), slope, &size);
  double order = log2(left[0] / left[HALVINGS]) / HALVINGS;
  ck_assert_msg(left[HALVINGS] <= ROUNDED * size || order >= ORDER,
                "%s by %s: %.3g, %.3g, %.3g are left of %.3g: order %.3g", place->term->name,
                key ? key : "positions", left[0], left[1], left[2], size, order);
  return slope;
}

START_TEST(derivatives_leave_the_third_order) {
  Place place;
  open_place(&place, &terms[_i]);
  double still = check_term(&place, NULL, 0);
  for (const char *const *by = terms[_i].by; *by; by++) check_term(&place, *by, still);
  close_place(&place);
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("gradient_taylor");
  tcase_add_loop_test(test_case, derivatives_leave_the_third_order, 0, sizeof terms / sizeof *terms);
  return suite_run("gradient_taylor", test_case, 120);
}
