// SPDX-License-Identifier: GPL-3.0-or-later
// Two flat slabs of regular meshes that do not match, pressed together and slid by a tenth of an element at a
// time, without friction: the pressure must be even and must not push sideways, although each mesh cuts the
// other into ever different pieces. TETLAP_TABLE=1 prints the table of all potentials.
//
//         ┌──┬──┬──┬──┬──┐  ──► slides
//      ┌──┼──┼──┼──┼──┼──┼──┐
//      └──┴──┴──┴──┴──┴──┴──┘
//
// Inside: three elements from the border, so that no vertex that its force depends on reaches the border. A
// slide starts where the meshes are in general position, or where all of their planes coincide.
#include "blocks.h"
#include "evaluated.h"

#include <stdio.h>

#include "overlap/models.h"

static const double KAPPA = 1000;
enum { LOWER_CELLS = 12, UPPER_WIDTH = 9, LAYERS = 2, SLIDES = 10 };

typedef struct Slabs {
  Blocks blocks;
  double *rest, *velocities;
  double ratio, centre[2]; // of the upper slab
  OverlapModel model;
  ContactSystem *system;
} Slabs;

// Lower slab: cubes of edge 1, its surface at z = 0. Upper: cubes of edge `ratio`, its surface at −depth.
static void make(Slabs *slabs, ContactPotential potential, double ratio, double depth, bool is_aligned) {
  int upper = (int)lround(UPPER_WIDTH / ratio);
  double low = -LOWER_CELLS / 2.0, width = upper * ratio,
         corner = is_aligned ? floor(-width / 2) : -width / 2;
  *slabs = (Slabs){.ratio = ratio, .centre = {corner + width / 2, corner + width / 2}};
  if (!is_aligned) slabs->centre[0] += 0.03, slabs->centre[1] += 0.31;
  blocks_add(&slabs->blocks, &(BlockDef){.corner = {low, low, -LAYERS},
                                         .cell = {1, 1, 1},
                                         .cells = {LOWER_CELLS, LOWER_CELLS, LAYERS}});
  blocks_add(&slabs->blocks,
             &(BlockDef){.corner = {slabs->centre[0] - width / 2, slabs->centre[1] - width / 2, -depth},
                         .cell = {ratio, ratio, ratio},
                         .cells = {upper, upper, LAYERS}});
  slabs->rest = blocks_copy(&slabs->blocks);
  slabs->velocities = calloc(3 * (size_t)slabs->blocks.vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(slabs->velocities);
  ck_assert_ok(overlap_models_create(&slabs->model, "clip"));
  ContactSystemDef def = blocks_def(&slabs->blocks, slabs->rest, &slabs->model);
  def.stiffness = KAPPA;
  def.potential = potential;
  ck_assert_ok(contact_system_create(&slabs->system, &def));
}

static void destroy(Slabs *slabs) {
  contact_system_destroy(slabs->system);
  overlap_model_destroy(&slabs->model);
  blocks_destroy(&slabs->blocks);
  free(slabs->rest), free(slabs->velocities);
}

// Of the forces on one slab, inside of the patch: `evenness` is the standard deviation of the normal force
// over the surface vertices by its mean, the others are shares of the normal force.
typedef struct Quality {
  double evenness;   // cv
  double tangential; // Σ |f_t| / Σ f_n
  double inner;      // what lands below the surface
  double pressure;   // mean over the surface
} Quality;

static Quality inspect(const Slabs *slabs, const double *force, int body) {
  double sum = 0, first = 0, squares = 0, tangential = 0, inner = 0, outwards = body == 0 ? -1 : 1;
  double surface = body == 0 ? 0 : slabs->rest[3 * slabs->blocks.bodies[1].vertex_begin + 2];
  double reach = UPPER_WIDTH / 2.0 - 3, edge = body == 0 ? 1 : slabs->ratio;
  int count = 0;
  for (int v = slabs->blocks.bodies[body].vertex_begin; v < slabs->blocks.bodies[body].vertex_end; v++) {
    const double *x = slabs->blocks.x + 3 * v, *f = force + 3 * v;
    if (fabs(x[0] - slabs->centre[0]) > reach || fabs(x[1] - slabs->centre[1]) > reach) continue;
    double normal = outwards * f[2];
    tangential += hypot(f[0], f[1]);
    if (fabs(x[2] - surface) > edge / 2)
      inner += fabs(normal);
    else {
      first = count ? first : normal;
      sum += normal, squares += (normal - first) * (normal - first), count++;
    }
  }
  ck_assert_int_ge(count, 4);
  double mean = sum / count, variance = suite_larger(0, squares / count - (mean - first) * (mean - first));
  return (Quality){sqrt(variance) / mean, tangential / (sum + inner), inner / (sum + inner),
                   (sum + inner) / count / (edge * edge)};
}

// Σ|f_t| / Σ|f_n| over all vertices of the lower slab, and the sideways force on all of it by the normal one.
static void inspect_all(const Slabs *slabs, const double *force, double *scattered, double *net) {
  double total[3] = {0}, tangential = 0, normal = 0;
  for (int v = 0; v < slabs->blocks.bodies[0].vertex_end; v++) {
    for (int c = 0; c < 3; c++) total[c] += force[3 * v + c];
    tangential += hypot(force[3 * v], force[3 * v + 1]);
    normal += fabs(force[3 * v + 2]);
  }
  *scattered = tangential / normal;
  *net = hypot(total[0], total[1]) / fabs(total[2]);
}

typedef struct Worst {
  Quality of[2]; // the lower, the upper slab; pressure: the mean of all slides
  double scattered, net;
} Worst;

static Worst slide(ContactPotential potential, double ratio, double depth, bool is_aligned) {
  Slabs slabs;
  make(&slabs, potential, ratio, depth, is_aligned);
  Worst worst = {0};
  for (int k = 0; k < SLIDES; k++) {
    double scattered, net;
    ck_assert_ok(contact_system_update(slabs.system, 0, slabs.blocks.x, slabs.velocities, 0.01));
    const ContactEvaluation *evaluation = evaluated_at(slabs.system, 0, slabs.blocks.x);
    ck_assert_int_gt(contact_evaluation_active_count(evaluation), 100);
    for (int body = 0; body < 2; body++) {
      Quality q = inspect(&slabs, evaluation->given_forces, body), *w = &worst.of[body];
      w->evenness = suite_larger(w->evenness, q.evenness);
      w->tangential = suite_larger(w->tangential, q.tangential);
      w->inner = suite_larger(w->inner, q.inner);
      w->pressure += q.pressure / SLIDES;
    }
    inspect_all(&slabs, evaluation->given_forces, &scattered, &net);
    worst.scattered = suite_larger(worst.scattered, scattered), worst.net = suite_larger(worst.net, net);
    blocks_shift(&slabs.blocks, slabs.blocks.x, 1, (double[]){0.1, 0, 0});
    slabs.centre[0] += 0.1;
  }
  destroy(&slabs);
  return worst;
}

static const double RATIOS[] = {1, 0.5, 0.77};
static const double DEPTHS[] = {0.05, 0.3, 0.6};
enum { CASES = 9 };

static void print_row(ContactPotential potential, double ratio, double depth, bool is_aligned) {
  Worst worst = slide(potential, ratio, depth, is_aligned);
  printf("%-8s %4.2f %4.2f %-8s|", contact_def_potential_name(potential), ratio, depth,
         is_aligned ? "aligned" : "");
  for (int body = 0; body < 2; body++)
    printf(" %6.4f %8.1e %6.4f %6.3f |", worst.of[body].evenness, worst.of[body].tangential,
           worst.of[body].inner, worst.of[body].pressure / KAPPA);
  printf(" %6.4f %8.1e\n", worst.scattered, worst.net);
}

START_TEST(table) {
  printf(
      "potential, edge ratio, depth | lower slab: cv, tangential, inner, p/kappa | upper slab | whole lower "
      "slab: tangential, net\n");
  for (int k = 0; k < CASES; k++)
    for (int p = 0; p < CONTACT_POTENTIAL_COUNT; p++)
      for (int is_aligned = 0; is_aligned < 2; is_aligned++)
        print_row((ContactPotential)p, RATIOS[k / 3], DEPTHS[k % 3], is_aligned);
}
END_TEST

// _i < CASES: in general position; from there on, aligned, at the middle depth.
START_TEST(nodal_is_even_and_without_friction) {
  bool is_aligned = _i >= CASES;
  double ratio = RATIOS[is_aligned ? _i - CASES : _i / 3], depth = DEPTHS[is_aligned ? 1 : _i % 3];
  Worst worst = slide(CONTACT_POTENTIAL_NODAL, ratio, depth, is_aligned);
  // The finer slab is pressed deeper in its own elements: at ratio ½ it is even to 3 % only.
  ck_assert(worst.of[0].evenness <= 0.01);
  ck_assert(worst.of[1].evenness <= (ratio == 0.5 ? 0.03 : 0.01));
  for (int body = 0; body < 2; body++) ck_assert(worst.of[body].tangential <= 1e-6);
  ck_assert(worst.of[0].inner <= 0.05);
  // With the border, where the upper slab's sides are pushed as well.
  ck_assert(worst.net <= 0.05);
  ck_assert(worst.scattered <= (depth > 0.5 ? 0.08 : 0.05));
  // Near κ depth over the element's edge.
  ck_assert(worst.of[0].pressure > 0.8 * KAPPA * depth && worst.of[0].pressure < 1.7 * KAPPA * depth);
}
END_TEST

START_TEST(models_agree_where_meshes_are_aligned) {
  Slabs slabs;
  make(&slabs, CONTACT_POTENTIAL_NODAL, 1, 0.3, true);
  OverlapModel exact;
  ContactAudit audit;
  ck_assert_ok(overlap_models_create(&exact, "exact"));
  ck_assert_ok(contact_system_update(slabs.system, 0, slabs.blocks.x, slabs.velocities, 0.01));
  ck_assert_ok(contact_system_audit(slabs.system, 0, slabs.blocks.x, &slabs.model, &exact, &audit));
  ck_assert_int_gt(audit.pair_count, 1000);
  ck_assert(contact_audit_error(audit.volume) <= 1e-12);
  ck_assert(contact_audit_error(audit.force) <= 1e-12);
  overlap_model_destroy(&exact);
  destroy(&slabs);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("contact_slabs");
  if (getenv("TETLAP_TABLE")) tcase_add_test(cases, table);
  tcase_add_loop_test(cases, nodal_is_even_and_without_friction, 0, CASES + 3);
  tcase_add_test(cases, models_agree_where_meshes_are_aligned);
  return suite_run("contact_slabs", cases, 300);
}
