// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field` between quadratic elements: what an even pressure puts on nodes, energies, forces and
// stiffness between curved meshes, balance.
#include <string.h>

#include "base/vec3.h"
#include "contact/friction/viscosity.h"
#include "contact/pressure/field.h"
#include "contact/surface/stars.h"
#include "contact/system.h"
#include "curved.h"
#include "evaluated.h"
#include "overlap/models.h"
#include "product.h"

static const double STIFFNESS = 1000;
static const int LEVELS[] = {0, 2};

// Two boxes of curved elements, or one above a half-space.
typedef struct Scene {
  int vertex_count, tet_count, quadratic_count, body_count;
  double *rest, *x, *still; // (vertex_count, 3)
  int (*tets)[4];
  int (*quadratics)[10];
  ContactBody bodies[2];
  ContactShape floor;
  OverlapModel model;
  ContactSystem *system;
} Scene;

static void *grown(void *array, size_t size) {
  void *larger = realloc(array, size);
  ck_assert_ptr_nonnull(larger);
  return larger;
}

static void add_box(Scene *scene, const double size[3], const int cells[3], double jitter,
                    const double corner[3]) {
  FemMesh mesh;
  int v = scene->vertex_count, t = scene->tet_count, q = scene->quadratic_count;
  curved_box(&mesh, size, cells, jitter, (uint64_t)scene->body_count);
  ck_assert_ok(fem_mesh_make_quadratic(&mesh));
  scene->rest = grown(scene->rest, sizeof(double) * 3 * (size_t)(v + mesh.vertex_count));
  scene->tets = grown(scene->tets, sizeof *scene->tets * (size_t)(t + mesh.tet_count));
  scene->quadratics =
      grown(scene->quadratics, sizeof *scene->quadratics * (size_t)(q + mesh.quadratic_count));
  for (int k = 0; k < 3 * mesh.vertex_count; k++) scene->rest[3 * v + k] = mesh.rest[k] + corner[k % 3];
  for (int e = 0; e < mesh.tet_count; e++)
    for (int k = 0; k < 4; k++) scene->tets[t + e][k] = mesh.tets[e][k] + v;
  for (int e = 0; e < mesh.quadratic_count; e++)
    for (int k = 0; k < 10; k++) scene->quadratics[q + e][k] = mesh.quadratic[e][k] + v;
  scene->vertex_count += mesh.vertex_count, scene->tet_count += mesh.tet_count;
  scene->quadratic_count += mesh.quadratic_count;
  scene->bodies[scene->body_count++] = (ContactBody){.name = "box",
                                                     .vertex_begin = v,
                                                     .vertex_end = scene->vertex_count,
                                                     .tet_begin = t,
                                                     .tet_end = scene->tet_count,
                                                     .quadratic_begin = q,
                                                     .quadratic_end = scene->quadratic_count};
  fem_mesh_destroy(&mesh);
}

static void start(Scene *scene, const char *model, bool has_floor) {
  size_t n = 3 * (size_t)scene->vertex_count;
  scene->x = memcpy(grown(NULL, n * sizeof(double)), scene->rest, n * sizeof(double));
  scene->still = calloc(n, sizeof(double));
  ck_assert_ptr_nonnull(scene->still);
  ck_assert_ok(overlap_models_create(&scene->model, model));
  scene->floor = (ContactShape){.name = "floor", .normal = {0, 0, 1}};
  ContactSystemDef def = {.vertex_count = scene->vertex_count,
                          .rest = scene->rest,
                          .tets = (const int(*)[4])scene->tets,
                          .tet_count = scene->tet_count,
                          .quadratics = (const int(*)[10])scene->quadratics,
                          .bodies = scene->bodies,
                          .body_count = scene->body_count,
                          .shapes = &scene->floor,
                          .shape_count = has_floor,
                          .potential = CONTACT_POTENTIAL_FIELD,
                          .stiffness = STIFFNESS,
                          .crease = M_PI / 6,
                          .model = &scene->model};
  ck_assert_ok(contact_system_create(&scene->system, &def));
}

static void destroy(Scene *scene) {
  contact_system_destroy(scene->system);
  overlap_model_destroy(&scene->model);
  free(scene->rest), free(scene->x), free(scene->still), free(scene->tets), free(scene->quadratics);
}

static void move(const Scene *scene) {
  ck_assert_ok(contact_system_update(scene->system, 0, scene->x, scene->still, 0.01));
}

// Curved boxes, the upper one pressed into the lower one, both bent: every node moves by itself. With a level
// of smoothness their tops and bottoms are arched at rest, and divided.
static void press_boxes(Scene *scene, const char *model, int smooth) {
  *scene = (Scene){.system = NULL};
  add_box(scene, (double[]){3, 3, 1.5}, (int[]){2, 2, 1}, 0.06, (double[]){0, 0, 0});
  add_box(scene, (double[]){1.7, 1.8, 1.6}, (int[]){1, 2, 1}, 0.06, (double[]){0.63, 0.41, 1.33});
  for (int v = 0; v < scene->vertex_count && smooth > 0; v++)
    scene->rest[3 * v + 2] += 0.03 * scene->rest[3 * v] * scene->rest[3 * v];
  scene->bodies[0].smooth = scene->bodies[1].smooth = smooth;
  start(scene, model, false);
  for (int v = 0; v < scene->vertex_count; v++) {
    double *x = scene->x + 3 * v;
    x[0] += 0.05 * sin(x[1]), x[1] += 0.04 * x[2], x[2] += 0.03 * sin(2 * x[0]);
  }
  move(scene);
}

static double energy_at(const Scene *scene, const double *x) {
  return evaluated_at(scene->system, 0, x)->energy;
}

static double *forces_at(const Scene *scene, const double *x) {
  double *force = calloc(3 * (size_t)scene->vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(force);
  evaluated_with_force(scene->system, x, force);
  return force;
}

static double *random_motion(const Scene *scene, uint64_t stream) {
  Random random = random_seeded(21, stream);
  double *d = calloc(3 * (size_t)scene->vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(d);
  for (int k = 0; k < 3 * scene->vertex_count; k++) d[k] = random_between(&random, -1, 1);
  return d;
}

static void step_to(const Scene *scene, double h, const double *d, double *x) {
  for (int k = 0; k < 3 * scene->vertex_count; k++) x[k] = scene->x[k] + h * d[k];
}

START_TEST(an_even_pressure_loads_the_middles_of_edges) {
  enum { CELLS = 4 };
  double depth = 1e-5, size[3] = {CELLS, CELLS, 2};
  Scene scene = {.system = NULL};
  add_box(&scene, size, (int[]){CELLS, CELLS, 2}, 0, (double[]){0, 0, 0});
  start(&scene, "clip", true);
  for (int v = 0; v < scene.vertex_count; v++) scene.x[3 * v + 2] -= depth;
  move(&scene);
  double pressures[500], depths[500];
  double *force = forces_at(&scene, scene.x), face = STIFFNESS * depth / 2; // a triangle's: p times its area
  int corners = 0, middles = 0;
  ck_assert_int_le(scene.vertex_count, 500);
  ck_assert_ok(contact_system_trace(scene.system, evaluated_at(scene.system, 0, scene.x), NULL,
                                    &(ContactTraceResult){.pressures = pressures, .depths = depths}));
  for (int v = 0; v < scene.vertex_count; v++) {
    const double *X = scene.rest + 3 * v;
    bool is_inside =
        fabs(X[0] - CELLS / 2.0) < CELLS / 2.0 - 0.1 && fabs(X[1] - CELLS / 2.0) < CELLS / 2.0 - 0.1;
    if (X[2] != 0 || !is_inside) continue;
    bool is_corner = X[0] == floor(X[0]) && X[1] == floor(X[1]);
    ck_assert_near(force[3 * v + 2], is_corner ? 0 : 2 * face / 3, 1e-3 * face);
    is_corner ? corners++ : middles++;
    ck_assert_near(pressures[v], STIFFNESS * depth, 1e-3 * STIFFNESS * depth);
    ck_assert_near(depths[v], depth, 1e-3 * depth);
  }
  ck_assert_int_eq(corners, (CELLS - 1) * (CELLS - 1));
  ck_assert_int_eq(middles, 3 * CELLS * CELLS - 2 * CELLS);
  free(force), destroy(&scene);
}
END_TEST

// A star has no points between the nodes of its surface but the middle of each face.
START_TEST(an_arched_surface_is_divided) {
  int counts[2];
  for (int k = 0; k < 2; k++) {
    Scene scene;
    press_boxes(&scene, "clip", LEVELS[k]);
    counts[k] = contact_system_layout(scene.system)->mesh.position_count;
    destroy(&scene);
  }
  ck_assert_int_gt(counts[1], 2 * counts[0]);
}
END_TEST

START_TEST(forces_are_minus_the_gradient_of_the_energy) {
  Scene scene;
  press_boxes(&scene, "clip", LEVELS[_i]);
  int n = 3 * scene.vertex_count;
  double *x = calloc((size_t)n, sizeof *x), *force = forces_at(&scene, scene.x), h = 1e-5;
  ck_assert_ptr_nonnull(x);
  double size = sqrt(product_dot(force, force, n));
  ck_assert_int_gt(contact_evaluation_active_count(evaluated_at(scene.system, 0, scene.x)), 50);
  for (uint64_t k = 0; k < 10; k++) {
    double *d = random_motion(&scene, k), length = sqrt(product_dot(d, d, n)), energy[4],
           steps[4] = {-2, -1, 1, 2};
    for (int i = 0; i < 4; i++) {
      step_to(&scene, steps[i] * h, d, x);
      energy[i] = energy_at(&scene, x);
    }
    double slope = (8 * (energy[2] - energy[1]) - (energy[3] - energy[0])) / (12 * h);
    ck_assert_near(slope, -product_dot(force, d, n), 1e-8 * size * length);
    free(d);
  }
  free(x), free(force), destroy(&scene);
}
END_TEST

START_TEST(stiffness_is_minus_the_derivative_of_the_forces) {
  Scene scene;
  press_boxes(&scene, "clip", LEVELS[_i]);
  int n = 3 * scene.vertex_count;
  double *x = calloc((size_t)n, sizeof *x), h = 1e-6;
  ck_assert_ptr_nonnull(x);
  for (uint64_t k = 0; k < 5; k++) {
    double *d = random_motion(&scene, k);
    step_to(&scene, h, d, x);
    double *above = forces_at(&scene, x);
    step_to(&scene, -h, d, x);
    double *below = forces_at(&scene, x);
    Product product = product_of(d, scene.vertex_count);
    ContactStiffnessSink sink = product_sink(&product);
    ck_assert_ok(contact_system_stiffness(scene.system, evaluated_at(scene.system, 0, scene.x), &sink));
    double size = sqrt(product_dot(product.y, product.y, n));
    ck_assert(size > 0);
    for (int i = 0; i < n; i++) ck_assert_near(-(above[i] - below[i]) / (2 * h), product.y[i], 1e-6 * size);
    free(d), free(above), free(below), free(product.y);
  }
  free(x), destroy(&scene);
}
END_TEST

// Of a pair's eight vertices, and of all that they carry onto the nodes.
START_TEST(pairs_and_nodes_balance_with_every_model) {
  static const char *const MODELS[] = {"clip", "clip32", "exact", "cgal"};
  Scene scene;
  press_boxes(&scene, MODELS[_i % 4], LEVELS[_i / 4]);
  double *force = forces_at(&scene, scene.x), norms = 0, worst = 0, largest = 0;
  const ContactLayout *layout = contact_system_layout(scene.system);
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.x);
  ck_assert_int_gt(evaluation->pair_count, 50);
  for (int k = 0; k < evaluation->pair_count; k++) {
    Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
    double own = 0;
    for (int v = 0; v < 8; v++) {
      int vertex = contact_layout_vertices(layout, evaluation->pairs[k].cells[v / 4])[v % 4];
      Vec3 f = vec3_at(evaluation->pair_forces + 24 * k + 3 * v),
           x = vec3_at(evaluation->positions + 3 * vertex);
      sum = vec3_add(sum, f), torque = vec3_add(torque, vec3_cross(x, f)), own += vec3_length(f);
    }
    worst = suite_larger(worst, suite_larger(vec3_length(sum), vec3_length(torque)));
    largest = suite_larger(largest, own);
  }
  ck_assert(largest > 0);
  ck_assert(worst <= 1e-14 * largest);
  Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
  for (int v = 0; v < scene.vertex_count; v++) {
    Vec3 f = vec3_at(force + 3 * v);
    sum = vec3_add(sum, f), torque = vec3_add(torque, vec3_cross(vec3_at(scene.x + 3 * v), f));
    norms += vec3_length(f);
  }
  ck_assert(norms > 0);
  ck_assert(vec3_length(sum) <= 1e-13 * norms);
  ck_assert(vec3_length(torque) <= 1e-13 * norms);
  free(force), destroy(&scene);
}
END_TEST

// Its power is minus what it dissipates, its matrix minus the derivative by velocities.
START_TEST(viscosity_acts_on_the_nodes) {
  Scene scene;
  ContactViscosity law;
  ContactViscosityPower power;
  press_boxes(&scene, "clip", 0);
  ck_assert_ok(contact_viscosity_create(&law, scene.system, 3));
  int n = 3 * scene.vertex_count;
  double *v = random_motion(&scene, 1), *force = calloc((size_t)n, sizeof *force);
  ck_assert_ptr_nonnull(force);
  ContactViscosityMotion motion = {evaluated_at(scene.system, 0, scene.x), v};
  contact_viscosity_add_force(&law, motion, force);
  power = contact_viscosity_power(&law, motion);
  Product product = product_of(v, scene.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  contact_viscosity_add_damping(&law, motion, 1, &sink);
  double size = sqrt(product_dot(force, force, n));
  ck_assert(power.dissipated > 0);
  ck_assert_near(product_dot(force, v, n), -power.dissipated, 1e-12 * power.dissipated);
  for (int i = 0; i < n; i++) ck_assert_near(force[i], -product.y[i], 1e-12 * size);
  free(v), free(force), free(product.y);
}
END_TEST

START_TEST(what_is_covered_adds_up_by_the_given_elements) {
  Scene scene;
  press_boxes(&scene, "clip", 0);
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.x);
  const double *covered = evaluation->given_covered;
  double volume = evaluation->interfaces[0].volume, sums[2] = {0, 0};
  for (int b = 0; b < 2; b++)
    for (int e = scene.bodies[b].tet_begin; e < scene.bodies[b].tet_end; e++) sums[b] += covered[e];
  ck_assert(volume > 0);
  for (int b = 0; b < 2; b++) ck_assert_near(sums[b], volume, 1e-12 * volume);
  destroy(&scene);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("stars");
  tcase_add_test(tests, an_even_pressure_loads_the_middles_of_edges);
  tcase_add_test(tests, an_arched_surface_is_divided);
  tcase_add_loop_test(tests, forces_are_minus_the_gradient_of_the_energy, 0, 2);
  tcase_add_loop_test(tests, stiffness_is_minus_the_derivative_of_the_forces, 0, 2);
  tcase_add_loop_test(tests, pairs_and_nodes_balance_with_every_model, 0, 8);
  tcase_add_test(tests, viscosity_acts_on_the_nodes);
  tcase_add_test(tests, what_is_covered_adds_up_by_the_given_elements);
  return suite_run("stars", tests, 60);
}
