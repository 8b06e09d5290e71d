// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic J2 plasticity with linear hardening, with the law stvk: S = C : (E − E_p) in the Green strain,
// so that rotations may be large; strains should stay within some percent. Elasticity gives C : E; here is
// the rest,
//
//   S_p = −2μ E_p
//
// by radial return from the history at the last accepted state (fem/material/plastic.h). It is the gradient
// of an incremental energy, ½ (E − E_p):C:(E − E_p) + ½ H α² + σ_y α, whose last part is dissipated. E_p has
// no trace, so `nodal` volume changes are not concerned, nor mean ones. Each quadrature point has a history
// of its own.
#include "fem/effect/elements/plasticity.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/vec3.h"
#include "fem/effect/system.h"

// A quadrature point of a plastic part.
typedef struct Site {
  FemPoint point;
  const int *nodes; // of its element, borrowed from the model       (point.node_count)
  int tet;          // where its stress is reported: of a quadratic element the part at its corner
} Site;

typedef struct Plasticity {
  const FemModel *model; // borrowed
  FemElement *elements;  // the linear ones that are plastic          (element_count)
  int element_count;
  Site *sites; //                                          (site_count)
  int site_count;
  int history; // place of its history, one FemPlastic after the other        (site_count)
  int *place;  // of a tetrahedron's first site, −1: not plastic   (model->tet_count)
} Plasticity;

static bool yields(const FemMaterial *material) {
  return material->yield_stress > 0;
}

static bool is_wanted(const FemSceneDef *scene) {
  return fem_scene_has_material(scene, yields);
}

static void destroy(void *self) {
  Plasticity *plasticity = self;
  memory_free(plasticity->elements);
  memory_free(plasticity->sites);
  memory_free(plasticity->place);
  memory_free(plasticity);
}

static void add_site(Plasticity *plasticity, FemPoint point, const int *nodes, int tet) {
  plasticity->sites[plasticity->site_count++] = (Site){point, nodes, tet};
}

static void add_tet(Plasticity *plasticity, int e) {
  plasticity->elements[plasticity->element_count] = fem_model_element(plasticity->model, e);
  const FemElement *element = &plasticity->elements[plasticity->element_count++];
  plasticity->place[e] = plasticity->site_count;
  add_site(plasticity, (FemPoint){4, element->gradient, element->volume}, plasticity->model->tets[e], e);
}

static void add_quadratic(Plasticity *plasticity, int e, int tet) {
  const FemModel *model = plasticity->model;
  for (int part = 0; part < FEM_QUADRATIC_PARTS; part++)
    plasticity->place[tet + part] = plasticity->site_count;
  for (int p = 0; p < FEM_QUADRATIC_POINTS; p++)
    add_site(plasticity, fem_quadratic_point(&model->quadratics[e], p), model->quadratic_nodes[e], tet + p);
}

static bool is_plastic(const FemModel *model, int part) {
  return part >= 0 && yields(&model->parts[part].material);
}

static void list_sites(Plasticity *plasticity) {
  const FemModel *model = plasticity->model;
  for (int e = 0; e < model->tet_count; e++) plasticity->place[e] = -1;
  for (int b = 0; b < model->body_count; b++) {
    const FemModelBody *body = &model->bodies[b];
    bool is_quadratic = body->element == FEM_ELEMENT_QUADRATIC;
    for (int e = body->tet_begin; e < body->tet_end && !is_quadratic; e++)
      if (is_plastic(model, model->tet_part[e])) add_tet(plasticity, e);
    for (int e = body->quadratic_begin; e < body->quadratic_end; e++)
      if (is_plastic(model, model->quadratic_part[e]))
        add_quadratic(plasticity, e, body->tet_begin + FEM_QUADRATIC_PARTS * (e - body->quadratic_begin));
  }
}

// Of linear ones.
static size_t count_elements(const FemModel *model) {
  size_t count = 0;
  for (int e = 0; e < model->tet_count; e++)
    count += is_plastic(model, model->tet_part[e]) &&
             model->bodies[model->tet_body[e]].element != FEM_ELEMENT_QUADRATIC;
  return count;
}

static Status create(void **self, const FemModel *model) {
  Plasticity *plasticity = memory_zeroed(1, sizeof *plasticity);
  if (!plasticity) return status_no_memory("plasticity");
  size_t tets = (size_t)model->tet_count; // a quadratic element has four points and eight tetrahedra
  plasticity->model = model;
  plasticity->elements = memory_zeroed(count_elements(model), sizeof *plasticity->elements);
  plasticity->sites = memory_zeroed(tets, sizeof *plasticity->sites);
  plasticity->place = memory_zeroed(tets, sizeof *plasticity->place);
  if (!plasticity->elements || !plasticity->sites || !plasticity->place) {
    destroy(plasticity);
    return status_no_memory("plasticity");
  }
  list_sites(plasticity);
  *self = plasticity;
  return STATUS_OK;
}

static const FemMaterial *material_of(const Plasticity *plasticity, int site) {
  const FemModel *model = plasticity->model;
  return &model->parts[model->tet_part[plasticity->sites[site].tet]].material;
}

// F and E = ½ (G + Gᵀ + Gᵀ G), G = F − I.
static void find_strain(const Site *site, const double *positions, double F[9], double E[9]) {
  double x[3 * FEM_QUADRATIC_NODES], G[9];
  for (int k = 0; k < site->point.node_count; k++)
    memcpy(x + 3 * k, positions + 3 * (size_t)site->nodes[k], 3 * sizeof *x);
  fem_point_deformation(&site->point, x, F);
  for (int r = 0; r < 9; r++) G[r] = F[r] - (r % 4 == 0);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double product = G[i] * G[j] + G[3 + i] * G[3 + j] + G[6 + i] * G[6 + j];
      E[3 * i + j] = 0.5 * (G[3 * i + j] + G[3 * j + i] + product);
    }
}

static const FemPlastic *history_of(const Plasticity *plasticity, const FemState *accepted) {
  return (const FemPlastic *)accepted->histories[plasticity->history].values;
}

static FemPlasticReturn evaluate(const Plasticity *plasticity, int i, const FemState *state, double F[9],
                                 double E[9]) {
  find_strain(&plasticity->sites[i], state->positions, F, E);
  return fem_plastic_return(material_of(plasticity, i), &history_of(plasticity, state->last)[i], E);
}

enum { PLASTIC_SIZE = sizeof(FemPlastic) / sizeof(double) };

static Status connect(void *self, const FemSystem *system) {
  ((Plasticity *)self)->history = fem_system_place(system, &fem_effect_plasticity);
  return STATUS_OK;
}

static Status start(void *self, const FemState *state, FemEffectHistory *history) {
  (void)state;
  size_t count = PLASTIC_SIZE * (size_t)((Plasticity *)self)->site_count;
  TRY(fem_effect_history_resize(history, count));
  for (size_t i = 0; i < count; i++) history->values[i] = 0;
  return STATUS_OK;
}

static Status advance(void *self, const FemState *state, FemEffectHistory *next) {
  const Plasticity *plasticity = self;
  TRY(fem_effect_history_resize(next, PLASTIC_SIZE * (size_t)plasticity->site_count));
  for (int i = 0; i < plasticity->site_count; i++) {
    double F[9], E[9];
    ((FemPlastic *)next->values)[i] = evaluate(plasticity, i, state, F, E).plastic;
  }
  return STATUS_OK;
}

// P_p = −2μ F E_p.
static void find_stress(double mu, const double F[9], const FemPlastic *plastic, double P[9]) {
  const double *S = plastic->strain;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      P[3 * i + j] = -2 * mu * (F[3 * i] * S[j] + F[3 * i + 1] * S[3 + j] + F[3 * i + 2] * S[6 + j]);
}

static Status add_force(void *self, const FemState *state, double *force) {
  const Plasticity *plasticity = self;
  for (int i = 0; i < plasticity->site_count; i++) {
    const Site *site = &plasticity->sites[i];
    double F[9], E[9], P[9], own[3 * FEM_QUADRATIC_NODES] = {0};
    FemPlasticReturn r = evaluate(plasticity, i, state, F, E);
    find_stress(fem_material_lame(material_of(plasticity, i)).mu, F, &r.plastic, P);
    fem_point_add_force(&site->point, P, own);
    for (int a = 0; a < site->point.node_count; a++)
      vec3_accumulate(force + 3 * (size_t)site->nodes[a], vec3_at(own + 3 * a));
  }
  return STATUS_OK;
}

// ∂P_p,ij/∂F_kl = δ_ik S_p,jl + F_im A_mjnl F_kn, A = −2μ ∂E_p/∂E.
static void find_tangent(double mu, const double F[9], const FemPlasticReturn *r, double dP[81]) {
  double A[81], half[81];
  for (int p = 0; p < 9; p++)
    for (int q = 0; q < 9; q++) {
      int m = p / 3, j = p % 3, k = q / 3, l = q % 3;
      double symmetric = 0.5 * ((m == k && j == l) + (m == l && j == k)),
             deviatoric = (m == j && k == l) / 3.0;
      double outer = r->n[p] * r->n[q];
      A[9 * p + q] = -2 * mu * (r->along * outer + r->across * (symmetric - deviatoric - outer));
    }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int q = 0; q < 9; q++)
        half[9 * (3 * i + j) + q] =
            F[3 * i] * A[9 * j + q] + F[3 * i + 1] * A[9 * (3 + j) + q] + F[3 * i + 2] * A[9 * (6 + j) + q];
  for (int p = 0; p < 9; p++)
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++) {
        const double *row = half + 9 * p;
        dP[9 * p + 3 * k + l] = F[3 * k] * row[l] + F[3 * k + 1] * row[3 + l] + F[3 * k + 2] * row[6 + l] -
                                (p / 3 == k ? 2 * mu * r->plastic.strain[3 * (p % 3) + l] : 0);
      }
}

static Status add_jacobian(void *self, const FemState *state, double stiffness_scale, double damping_scale,
                           FemMatrix *matrix) {
  (void)damping_scale;
  const Plasticity *plasticity = self;
  for (int i = 0; i < plasticity->site_count && stiffness_scale != 0; i++) {
    const Site *site = &plasticity->sites[i];
    int nodes = site->point.node_count;
    double F[9], E[9], dP[81], dense[9 * FEM_QUADRATIC_NODES * FEM_QUADRATIC_NODES] = {0};
    FemPlasticReturn r = evaluate(plasticity, i, state, F, E);
    find_tangent(fem_material_lame(material_of(plasticity, i)).mu, F, &r, dP);
    fem_point_add_tangent(&site->point, dP, dense);
    fem_point_mirror(nodes, dense);
    fem_matrix_add(matrix, nodes, site->nodes, dense, stiffness_scale);
  }
  return STATUS_OK;
}

// Elasticity has counted ½ E:C:E: −2μ E:E_p + μ E_p:E_p + ½ H α² is missing.
static Status add_energy(void *self, const FemState *state, FemEnergy *energy) {
  const Plasticity *plasticity = self;
  for (int i = 0; i < plasticity->site_count; i++) {
    const FemMaterial *material = material_of(plasticity, i);
    double F[9], E[9], product = 0, volume = plasticity->sites[i].point.weight;
    FemPlastic plastic = evaluate(plasticity, i, state, F, E).plastic;
    for (int k = 0; k < 9; k++) product += plastic.strain[k] * (plastic.strain[k] - 2 * E[k]);
    energy->elastic += volume * (fem_material_lame(material).mu * product +
                                 0.5 * material->hardening * plastic.alpha * plastic.alpha);
    energy->plastic_work += volume * material->yield_stress * plastic.alpha;
  }
  return STATUS_OK;
}

static Status check_history(const void *self, const double *values, size_t count) {
  (void)values;
  int sites = ((const Plasticity *)self)->site_count;
  if (count == PLASTIC_SIZE * (size_t)sites) return STATUS_OK;
  return status_fail(STATUS_INPUT, "plasticity: there are %zu numbers of history for %d plastic points",
                     count, sites);
}

static void report(void *self, const FemState *state, Record *counters) {
  const Plasticity *plasticity = self;
  const FemPlastic *history = history_of(plasticity, state);
  double most = 0;
  int yielded = 0, last = -1;
  for (int i = 0; i < plasticity->site_count; i++) {
    int element = plasticity->place[plasticity->sites[i].tet];
    most = fmax(most, history[i].alpha);
    if (!(history[i].alpha > 0) || element == last) continue;
    yielded++;
    last = element;
  }
  record_number(counters, "plastic_strain_max", most);
  record_integer(counters, "yielded_elements", yielded);
}

void fem_effect_plasticity_add_stress(const void *self, int tet, const FemState *state, double stress[6]) {
  const Plasticity *plasticity = self;
  int begin = plasticity->place[tet], end = begin + 1;
  if (begin < 0) return;
  const Site *first = &plasticity->sites[begin];
  if (first->point.node_count == FEM_QUADRATIC_NODES) {
    int part = tet - first->tet;
    if (part < FEM_QUADRATIC_POINTS)
      begin += part, end = begin + 1;
    else
      end = begin + FEM_QUADRATIC_POINTS;
  }
  for (int i = begin; i < end; i++) {
    double F[9], E[9], P[9], one[6];
    FemPlastic plastic = evaluate(plasticity, i, state, F, E).plastic;
    find_stress(fem_material_lame(material_of(plasticity, i)).mu, F, &plastic, P);
    fem_material_cauchy(FEM_MATERIAL_STVK, F, P, one);
    for (int s = 0; s < 6; s++) stress[s] += one[s] / (end - begin);
  }
}

// ---- Derivatives, backwards.

int fem_effect_plasticity_place(const void *self) {
  return ((const Plasticity *)self)->history;
}

int fem_effect_plasticity_count(const void *self) {
  return ((const Plasticity *)self)->site_count;
}

// A point at a state, and what it gives: g's derivatives by F, and by those of its return.
typedef struct Pull {
  const Site *site;
  const FemMaterial *material;
  double F[9], E[9], mu;
  FemPlasticReturn r;
  FemPlastic by;        // g's, by the new plastic state
  double strain[9];     // by E
  FemPlasticSlope *own; // by the constants of its part
} Pull;

static Pull begin_pull(const Plasticity *plasticity, int i, const FemState *state,
                       const FemPlasticitySlope *slope) {
  Pull pull = {.site = &plasticity->sites[i], .material = material_of(plasticity, i)};
  pull.r = evaluate(plasticity, i, state, pull.F, pull.E);
  pull.mu = fem_material_lame(pull.material).mu;
  pull.own = &slope->parts[plasticity->model->tet_part[pull.site->tet]];
  return pull;
}

// What is by the new plastic state goes on to what it was found from.
static void end_pull(const Plasticity *plasticity, int i, const FemState *state, Pull *pull,
                     const FemPlasticitySlope *slope) {
  FemPlasticSlope own = {0};
  fem_plastic_pull(pull->material, &history_of(plasticity, state->last)[i], &pull->r, &pull->by, &own);
  for (int k = 0; k < 9; k++) {
    pull->strain[k] += own.strain[k];
    slope->before[i].strain[k] += own.history.strain[k];
  }
  slope->before[i].alpha += own.history.alpha;
  pull->own->mu += own.mu;
  pull->own->yield += own.yield;
  pull->own->hardening += own.hardening;
}

// λ · f = 2μ V (Fᵀ Λ) : E_p with Λ = Σ λ_a ⊗ ∇N_a.
static void add_forces(Pull *pull, const double *forces) {
  double own[3 * FEM_QUADRATIC_NODES], L[9], volume = pull->site->point.weight;
  for (int k = 0; k < pull->site->point.node_count; k++)
    memcpy(own + 3 * k, forces + 3 * (size_t)pull->site->nodes[k], 3 * sizeof *own);
  fem_point_deformation(&pull->site->point, own, L);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double product = 0;
      for (int m = 0; m < 3; m++)
        product += 0.5 * (pull->F[3 * m + i] * L[3 * m + j] + pull->F[3 * m + j] * L[3 * m + i]);
      pull->by.strain[3 * i + j] += 2 * pull->mu * volume * product;
      pull->own->mu += 2 * volume * product * pull->r.plastic.strain[3 * i + j];
    }
}

void fem_effect_plasticity_pull_forces(const void *self, const FemState *state, const double *forces,
                                       const FemPlasticitySlope *slope) {
  const Plasticity *plasticity = self;
  for (int i = 0; i < plasticity->site_count; i++) {
    Pull pull = begin_pull(plasticity, i, state, slope);
    add_forces(&pull, forces);
    end_pull(plasticity, i, state, &pull, slope);
  }
}

// Of V (μ E_p : (E_p − 2 E) + ½ H α²).
static void add_elastic(Pull *pull, double energy) {
  const FemPlastic *plastic = &pull->r.plastic;
  double share = energy * pull->site->point.weight;
  for (int k = 0; k < 9; k++) {
    pull->by.strain[k] += share * 2 * pull->mu * (plastic->strain[k] - pull->E[k]);
    pull->strain[k] -= share * 2 * pull->mu * plastic->strain[k];
    pull->own->mu += share * plastic->strain[k] * (plastic->strain[k] - 2 * pull->E[k]);
  }
  pull->by.alpha += share * pull->material->hardening * plastic->alpha;
  pull->own->hardening += share * 0.5 * plastic->alpha * plastic->alpha;
}

// By positions through E, whose derivative is symmetric: ∂g/∂F = F ∂g/∂E.
static void add_positions(const Pull *pull, double *now) {
  const FemPoint *point = &pull->site->point;
  double P[9], own[3 * FEM_QUADRATIC_NODES] = {0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      P[3 * i + j] = 0;
      for (int m = 0; m < 3; m++)
        P[3 * i + j] -= pull->F[3 * i + m] * pull->strain[3 * m + j] / point->weight;
    }
  fem_point_add_force(point, P, own);
  for (int a = 0; a < point->node_count; a++)
    vec3_accumulate(now + 3 * (size_t)pull->site->nodes[a], vec3_at(own + 3 * a));
}

void fem_effect_plasticity_pull_history(const void *self, const FemState *state, double energy,
                                        const FemPlastic *after, const FemPlasticitySlope *slope) {
  const Plasticity *plasticity = self;
  for (int i = 0; i < plasticity->site_count; i++) {
    Pull pull = begin_pull(plasticity, i, state, slope);
    if (after) pull.by = after[i];
    if (energy != 0) add_elastic(&pull, energy);
    end_pull(plasticity, i, state, &pull, slope);
    add_positions(&pull, slope->now);
  }
}

static size_t bytes(const void *self) {
  const Plasticity *plasticity = self;
  return memory_held(self) + memory_held(plasticity->elements) + memory_held(plasticity->sites) +
         memory_held(plasticity->place);
}

const FemEffectOps fem_effect_plasticity = {
    .name = "plasticity",
    .help = "isotropic J2 plasticity with linear hardening, with the law stvk",
    .is_wanted = is_wanted,
    .create = create,
    .connect = connect,
    .start = start,
    .advance = advance,
    .check_history = check_history,
    .add_force = add_force,
    .add_jacobian = add_jacobian,
    .add_energy = add_energy,
    .report = report,
    .bytes = bytes,
    .destroy = destroy,
};
