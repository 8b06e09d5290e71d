// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth surfaces of linear bodies: where the points lie, what carries them, cells without cracks, forces and
// stiffness between them.
#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "contact/surface/smooth/fit.h"
#include "contact/surface/smooth/smooth.h"
#include "contact/surface/smooth/smooth_row.h"
#include "contact/surface/stars.h"
#include "contact/surface/surface.h"
#include "contact/system.h"
#include "evaluated.h"
#include "fem/mesh/mesh.h"
#include "overlap/models.h"
#include "product.h"
#include "suite.h"

static const double CREASE = M_PI / 6, INNER = 0.7;

typedef enum Form {
  TUBE, // half a tube along z, radii .7 and 1
  DOME, // a part of a spherical shell of these radii about the z axis
} Form;

// A box whose vertices within each surface are moved along it, bent.
static Vec3 bend(Form form, Vec3 x) {
  double r = INNER + (1 - INNER) * x.z;
  if (form == TUBE) return (Vec3){r * cos(M_PI * x.x), r * sin(M_PI * x.x), 1.4 * x.y};
  Vec3 ray = {1.2 * (x.x - 0.5), 1.2 * (x.y - 0.5), 1};
  return vec3_scale(r / vec3_length(ray), ray);
}

static void make_mesh(FemMesh *mesh, Form form, int cells) {
  ck_assert_ok(fem_mesh_box(mesh, (double[]){1, 1, 1}, (int[]){form == TUBE ? 3 * cells : cells, cells, 2}));
  Random random = random_seeded(7, (uint64_t)cells);
  for (int v = 0; v < mesh->vertex_count; v++) {
    double *x = mesh->rest + 3 * v;
    for (int c = 0; c < 2; c++) {
      double by = 0.15 / (form == TUBE && c == 0 ? 3 * cells : cells) * random_between(&random, -1, 1);
      if (x[c] > 1e-9 && x[c] < 1 - 1e-9) x[c] += by;
    }
    vec3_store(x, bend(form, vec3_at(x)));
  }
}

static ContactBody body_of(const FemMesh *mesh, int level) {
  return (ContactBody){
      .name = "body", .vertex_end = mesh->vertex_count, .tet_end = mesh->tet_count, .smooth = level};
}

static ContactSystemDef def_of(const FemMesh *mesh, const ContactBody *body) {
  return (ContactSystemDef){.vertex_count = mesh->vertex_count,
                            .rest = mesh->rest,
                            .tets = (const int(*)[4])mesh->tets,
                            .tet_count = mesh->tet_count,
                            .bodies = body,
                            .body_count = 1,
                            .crease = CREASE,
                            .potential = CONTACT_POTENTIAL_FIELD,
                            .stiffness = 1};
}

// How far a point is off the nearer of the two round surfaces; those on flat sides count as well.
static double off_surface(Form form, Vec3 x) {
  double r = form == TUBE ? hypot(x.x, x.y) : vec3_length(x);
  return fmin(fabs(r - 1), fabs(r - INNER));
}

static Vec3 point_of(const ContactSmooth *smooth, int p) {
  const int *nodes;
  double weights[CONTACT_FIT_MOST_COUNT];
  Vec3 sum = {0, 0, 0};
  int count = contact_smooth_points_carry(smooth, p, &nodes, weights);
  for (int k = 0; k < count; k++)
    sum = vec3_add(sum, vec3_scale(weights[k], vec3_at(smooth->def->rest + 3 * nodes[k])));
  return sum;
}

static Vec3 chord_of(const ContactSmooth *smooth, int p) {
  Vec3 sum = {0, 0, 0};
  for (int k = 0; k < smooth->owns[p]; k++)
    sum = vec3_add(sum, vec3_scale(smooth->priors[p][k],
                                   vec3_at(smooth->def->rest + 3 * smooth->nodes[smooth->begin[p] + k])));
  return sum;
}

START_TEST(points_lie_on_the_surface_that_the_vertices_are_on) {
  Form form = _i % 2 ? DOME : TUBE;
  FemMesh mesh;
  ContactSmooth smooth;
  make_mesh(&mesh, form, 8);
  ContactBody body = body_of(&mesh, 1 + _i / 2);
  ContactSystemDef def = def_of(&mesh, &body);
  ck_assert_ok(contact_smooth_create(&smooth, &def, &body, body.smooth, CREASE));
  double left = 0, sagitta = 0;
  ck_assert_int_gt(smooth.point_count, 200);
  for (int p = 0; p < smooth.point_count; p++) {
    double now = off_surface(form, point_of(&smooth, p)), before = off_surface(form, chord_of(&smooth, p));
    left += now * now, sagitta += before * before;
  }
  ck_assert(sqrt(left) <= 0.03 * sqrt(sagitta)); // what is left is of third order: 3 % at h/R = .1
  contact_smooth_points_destroy(&smooth);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Vertices in a plane at random, values a quadratic function of the place.
START_TEST(weights_are_exact_for_quadratics) {
  Random random = random_seeded(5, (uint64_t)_i);
  enum { COUNT = 11 };
  double q[6], weights[COUNT];
  const double prior[2] = {0.5 + 0.25 * (_i % 2), 0.5 - 0.25 * (_i % 2)};
  Vec3 x[COUNT], at = {0, 0, 0};
  for (int k = 0; k < 6; k++) q[k] = random_between(&random, -1, 1);
  for (int k = 0; k < COUNT; k++) {
    double u = 2 * cos(2.4 * k) + random_between(&random, -0.3, 0.3), v = 2 * sin(2.4 * k);
    x[k] = k < 2 ? (Vec3){k - 0.5, 0.1 * k, 0} : (Vec3){u, v, 0};
  }
  contact_fit_surface(COUNT, x, 2, prior, (Vec3){0, 0, 3}, weights);
  double sum = 0, value = 0, expected;
  for (int k = 0; k < 2; k++) at = vec3_add(at, vec3_scale(prior[k], x[k]));
  for (int k = 0; k < COUNT; k++) {
    double u = x[k].x, v = x[k].y;
    sum += weights[k];
    value += weights[k] * (q[0] + q[1] * u + q[2] * v + q[3] * u * u + q[4] * u * v + q[5] * v * v);
  }
  expected = q[0] + q[1] * at.x + q[2] * at.y + q[3] * at.x * at.x + q[4] * at.x * at.y + q[5] * at.y * at.y;
  ck_assert_near(sum, 1, 1e-12);
  ck_assert_near(value, expected, 1e-12);
}
END_TEST

// Two rows of vertices: nothing says how it curves across them, but along them it does.
START_TEST(two_rows_tell_the_curvature_along_them) {
  enum { COUNT = 8 };
  Vec3 x[COUNT];
  double weights[COUNT], sum = 0, height = 0, across = 0, radius = 2;
  for (int k = 0; k < COUNT; k++) {
    static const int COLUMNS[COUNT] = {0, 1, -1, 0, 1, 2, -1, 2}, ROWS[COUNT] = {0, 1, 0, 1, 0, 0, 1, 1};
    double u = COLUMNS[k] - 0.5;
    x[k] = (Vec3){u, ROWS[k] - 0.5, -u * u / (2 * radius)};
  }
  contact_fit_surface(COUNT, x, 2, (double[]){0.5, 0.5}, (Vec3){0, 0, 1}, weights);
  for (int k = 0; k < COUNT; k++) {
    sum += weights[k];
    height += weights[k] * x[k].z;
    across += weights[k] * x[k].y;
  }
  ck_assert_near(sum, 1, 1e-12);
  ck_assert_near(across, 0, 1e-12);
  ck_assert_near(height, 0, 1e-12); // the chord is at −1/16
}
END_TEST

// Inner faces that did not fit would be surface, too.
START_TEST(cells_fill_the_body_without_cracks) {
  Form form = _i % 2 ? DOME : TUBE;
  int level = 1 + _i / 2;
  FemMesh mesh;
  ContactStars stars;
  ContactSurface surface;
  make_mesh(&mesh, form, 6);
  ContactBody body = body_of(&mesh, level);
  ContactSystemDef def = def_of(&mesh, &body);
  ck_assert_ok(contact_stars_create(&stars, &def));
  ck_assert(stars.is_needed);
  double six = 0, sum = 0;
  for (int i = 0; i < stars.def.tet_count; i++) {
    const int *v = stars.def.tets[i];
    double cell = vec3_det4(vec3_at(stars.rest + 3 * v[0]), vec3_at(stars.rest + 3 * v[1]),
                            vec3_at(stars.rest + 3 * v[2]), vec3_at(stars.rest + 3 * v[3]));
    ck_assert(cell > 0);
    six += cell;
  }
  ck_assert_ok(contact_surface_find(&surface, stars.def.tets, 0, stars.def.tet_count));
  for (int f = 0; f < surface.count; f++) {
    const int *v = surface.faces[f].vertices;
    Vec3 a = vec3_at(stars.rest + 3 * v[0]), b = vec3_at(stars.rest + 3 * v[1]),
         c = vec3_at(stars.rest + 3 * v[2]);
    Vec3 middle = vec3_scale(1.0 / 3, vec3_add(a, vec3_add(b, c)));
    sum += vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / 2;
    bool is_round = off_surface(form, middle) < 0.02;
    bool is_side = form == TUBE
                       ? fabs(middle.z) < 1e-9 || fabs(middle.z - 1.4) < 1e-9 || fabs(middle.y) < 1e-9
                       : fabs(fmax(fabs(middle.x), fabs(middle.y)) - 0.6 * middle.z) < 1e-9;
    ck_assert(is_round || is_side);
  }
  // half a tube: round surfaces, ends, and the two strips at its cut; of arcs of π/18 with chords 5e-3 is
  // missing
  if (form == TUBE) {
    double missing = level == 1 ? 2e-3 : 5e-4;
    double area = M_PI * (1 + INNER) * 1.4 + M_PI * (1 - INNER * INNER) + 2 * (1 - INNER) * 1.4;
    ck_assert_near(sum, area, missing * area);
    ck_assert_near(six / 6, M_PI / 2 * (1 - INNER * INNER) * 1.4, missing * six / 6);
  }
  contact_surface_destroy(&surface);
  contact_stars_destroy(&stars);
  fem_mesh_destroy(&mesh);
}
END_TEST

static void add_thirds(const ContactSystemDef *def, const ContactStars *stars, double *loads) {
  ContactSurface surface;
  ck_assert_ok(contact_surface_find(&surface, def->tets, 0, def->tet_count));
  for (int f = 0; f < surface.count; f++) {
    const int *v = surface.faces[f].vertices;
    Vec3 x[3];
    bool is_outer = true;
    for (int k = 0; k < 3; k++) x[k] = vec3_at(def->rest + 3 * v[k]), is_outer &= vec3_length(x[k]) > 0.99;
    double third = vec3_length(vec3_cross(vec3_sub(x[1], x[0]), vec3_sub(x[2], x[0]))) / 6;
    for (int k = 0; k < 3 && is_outer; k++) {
      if (stars)
        contact_stars_push(stars, v[k], (Vec3){third, 0, 0}, loads);
      else
        loads[3 * v[k]] += third;
    }
  }
  contact_surface_destroy(&surface);
}

// As it does without points, whatever the mesh, also at the rim of a surface. What the offset at rest takes
// to the next layer, its share of the height, is all that differs.
START_TEST(an_even_pressure_loads_vertices_by_a_third_of_their_faces) {
  FemMesh mesh;
  ContactStars stars;
  make_mesh(&mesh, DOME, 6);
  ContactBody body = body_of(&mesh, _i);
  ContactSystemDef def = def_of(&mesh, &body);
  ck_assert_ok(contact_stars_create(&stars, &def));
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *loads = calloc(n, sizeof *loads), *expected = calloc(n, sizeof *expected);
  ck_assert(loads && expected);
  add_thirds(&def, NULL, expected);
  add_thirds(&stars.def, &stars, loads);
  int count = 0;
  for (int v = 0; v < mesh.vertex_count; v++) {
    if (!(expected[3 * v] > 0)) continue;
    ck_assert_near(loads[3 * v], expected[3 * v], 0.15 * expected[3 * v]);
    count++;
  }
  ck_assert_int_eq(count, 49);
  free(loads), free(expected);
  contact_stars_destroy(&stars);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_body_of_flat_faces_stays_as_it_is) {
  FemMesh mesh;
  ContactStars stars;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){1, 2, 3}, (int[]){3, 3, 3}));
  ContactBody body = body_of(&mesh, 2);
  ContactSystemDef def = def_of(&mesh, &body);
  ck_assert_ok(contact_stars_create(&stars, &def));
  ck_assert(!stars.is_needed);
  ck_assert_ptr_eq(stars.def.rest, mesh.rest);
  contact_stars_destroy(&stars);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Two domes, one upside down, pressed together and bent: every vertex moves by itself.
typedef struct Scene {
  int vertex_count;
  double *rest, *x, *still; // (vertex_count, 3)
  int (*tets)[4];
  ContactBody bodies[2];
  OverlapModel model;
  ContactSystem *system;
} Scene;

static void press_domes(Scene *scene, const char *model, int level) {
  FemMesh meshes[2];
  int tet_count = 0;
  *scene = (Scene){.system = NULL};
  for (int b = 0; b < 2; b++) make_mesh(&meshes[b], DOME, 3 + b), tet_count += meshes[b].tet_count;
  scene->vertex_count = meshes[0].vertex_count + meshes[1].vertex_count;
  size_t n = 3 * (size_t)scene->vertex_count;
  scene->rest = calloc(n, sizeof(double)), scene->x = calloc(n, sizeof(double));
  scene->still = calloc(n, sizeof(double)), scene->tets = calloc((size_t)tet_count, sizeof *scene->tets);
  ck_assert(scene->rest && scene->x && scene->still && scene->tets);
  for (int b = 0, v = 0, t = 0; b < 2; b++) {
    double sign = b ? -1 : 1;
    for (int k = 0; k < meshes[b].vertex_count; k++) {
      Vec3 x = vec3_at(meshes[b].rest + 3 * k);
      if (b) x = (Vec3){x.x + 0.04, sign * x.y + 0.03, sign * x.z + 1.93};
      vec3_store(scene->rest + 3 * (v + k), x);
    }
    for (int i = 0; i < meshes[b].tet_count; i++)
      for (int k = 0; k < 4; k++) scene->tets[t + i][k] = meshes[b].tets[i][k] + v;
    scene->bodies[b] = (ContactBody){.name = "dome",
                                     .vertex_begin = v,
                                     .vertex_end = v + meshes[b].vertex_count,
                                     .tet_begin = t,
                                     .tet_end = t + meshes[b].tet_count,
                                     .smooth = level};
    v += meshes[b].vertex_count, t += meshes[b].tet_count;
    fem_mesh_destroy(&meshes[b]);
  }
  memcpy(scene->x, scene->rest, n * sizeof(double));
  for (int v = 0; v < scene->vertex_count; v++) {
    double *x = scene->x + 3 * v;
    x[0] += 0.02 * sin(x[1]), x[1] += 0.01 * x[2], x[2] += 0.015 * sin(2 * x[0]);
  }
  ck_assert_ok(overlap_models_create(&scene->model, model));
  ContactSystemDef def = {.vertex_count = scene->vertex_count,
                          .rest = scene->rest,
                          .tets = (const int(*)[4])scene->tets,
                          .tet_count = tet_count,
                          .bodies = scene->bodies,
                          .body_count = 2,
                          .crease = CREASE,
                          .potential = CONTACT_POTENTIAL_FIELD,
                          .stiffness = 1000,
                          .model = &scene->model};
  ck_assert_ok(contact_system_create(&scene->system, &def));
  ck_assert_ok(contact_system_update(scene->system, 0, scene->x, scene->still, 0.01));
}

static void destroy(Scene *scene) {
  contact_system_destroy(scene->system);
  overlap_model_destroy(&scene->model);
  free(scene->rest), free(scene->x), free(scene->still), free(scene->tets);
}

static double *forces_at(const Scene *scene, const double *x, double *energy) {
  double *force = calloc(3 * (size_t)scene->vertex_count, sizeof(double));
  ck_assert_ptr_nonnull(force);
  *energy = evaluated_with_force(scene->system, x, force)->energy;
  return force;
}

static void step_to(const Scene *scene, double h, const double *d, double *x) {
  for (int k = 0; k < 3 * scene->vertex_count; k++) x[k] = scene->x[k] + h * d[k];
}

START_TEST(forces_balance_and_are_minus_the_gradient_of_the_energy) {
  static const char *const MODELS[] = {"clip", "clip32", "exact", "cgal"};
  Scene scene;
  press_domes(&scene, MODELS[_i % 4], 1 + _i / 4);
  int n = 3 * scene.vertex_count;
  double start, *force = forces_at(&scene, scene.x, &start), *d = calloc((size_t)n, sizeof *d);
  double *x = calloc((size_t)n, sizeof *x), h = 1e-5, norms = 0, energy[4], steps[4] = {-2, -1, 1, 2};
  Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
  ck_assert(d && x);
  ck_assert_int_gt(contact_evaluation_active_count(evaluated_at(scene.system, 0, scene.x)), 50);
  for (int v = 0; v < scene.vertex_count; v++) {
    Vec3 f = vec3_at(force + 3 * v);
    sum = vec3_add(sum, f), torque = vec3_add(torque, vec3_cross(vec3_at(scene.x + 3 * v), f));
    norms += vec3_length(f);
  }
  ck_assert(norms > 0);
  ck_assert(vec3_length(sum) <= 1e-13 * norms);
  ck_assert(vec3_length(torque) <= 1e-13 * norms);
  Random random = random_seeded(21, 0);
  for (int k = 0; k < n; k++) d[k] = random_between(&random, -1, 1);
  for (int i = 0; i < 4; i++) {
    step_to(&scene, steps[i] * h, d, x);
    energy[i] = evaluated_at(scene.system, 0, x)->energy;
  }
  double slope = (8 * (energy[2] - energy[1]) - (energy[3] - energy[0])) / (12 * h);
  ck_assert_near(slope, -product_dot(force, d, n),
                 (_i % 4 == 1 ? 1e-3 : 1e-7) * sqrt(product_dot(force, force, n) * product_dot(d, d, n)));
  free(force), free(d), free(x), destroy(&scene);
}
END_TEST

START_TEST(stiffness_is_minus_the_derivative_of_the_forces) {
  Scene scene;
  press_domes(&scene, "clip", _i);
  int n = 3 * scene.vertex_count;
  double *x = calloc((size_t)n, sizeof *x), *d = calloc((size_t)n, sizeof *d), h = 1e-6, energy;
  ck_assert(x && d);
  Random random = random_seeded(22, 0);
  for (int k = 0; k < n; k++) d[k] = random_between(&random, -1, 1);
  step_to(&scene, h, d, x);
  double *above = forces_at(&scene, x, &energy);
  step_to(&scene, -h, d, x);
  double *below = forces_at(&scene, x, &energy);
  Product product = product_of(d, scene.vertex_count);
  ContactStiffnessSink sink = product_sink(&product);
  ck_assert_ok(contact_system_stiffness(scene.system, evaluated_at(scene.system, 0, scene.x), &sink));
  double size = sqrt(product_dot(product.y, product.y, n));
  ck_assert(size > 0);
  for (int i = 0; i < n; i++) ck_assert_near(-(above[i] - below[i]) / (2 * h), product.y[i], 1e-6 * size);
  free(x), free(d), free(above), free(below), free(product.y), destroy(&scene);
}
END_TEST

// New points are no shorter edges of the body.
START_TEST(a_step_may_be_as_long_as_without_points) {
  Scene facets, smooth;
  press_domes(&facets, "clip", 0);
  press_domes(&smooth, "clip", 2);
  ck_assert_near(contact_system_layout(smooth.system)->margin, contact_system_layout(facets.system)->margin,
                 0);
  destroy(&facets), destroy(&smooth);
}
END_TEST

START_TEST(a_row_says_that_it_has_no_room) {
  ContactSmoothRow row;
  row.count = 0, row.is_full = false;
  for (int k = 0; k < CONTACT_SMOOTH_ROW_COUNT; k++) contact_smooth_row_add(&row, k, 1);
  contact_smooth_row_add(&row, 0, 1);
  ck_assert(!row.is_full && row.weights[0] == 2);
  contact_smooth_row_add(&row, CONTACT_SMOOTH_ROW_COUNT, 1);
  contact_smooth_row_add(&row, 0, 1);
  ck_assert(row.is_full && row.count == CONTACT_SMOOTH_ROW_COUNT);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("smooth");
  tcase_add_loop_test(tests, points_lie_on_the_surface_that_the_vertices_are_on, 0, 4);
  tcase_add_loop_test(tests, weights_are_exact_for_quadratics, 0, 6);
  tcase_add_test(tests, two_rows_tell_the_curvature_along_them);
  tcase_add_loop_test(tests, cells_fill_the_body_without_cracks, 0, 4);
  tcase_add_loop_test(tests, an_even_pressure_loads_vertices_by_a_third_of_their_faces, 1, 3);
  tcase_add_test(tests, a_body_of_flat_faces_stays_as_it_is);
  tcase_add_test(tests, a_step_may_be_as_long_as_without_points);
  tcase_add_test(tests, a_row_says_that_it_has_no_room);
  tcase_add_loop_test(tests, forces_balance_and_are_minus_the_gradient_of_the_energy, 0, 8);
  tcase_add_loop_test(tests, stiffness_is_minus_the_derivative_of_the_forces, 1, 3);
  return suite_run("smooth", tests, 60);
}
