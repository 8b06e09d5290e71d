// SPDX-License-Identifier: GPL-3.0-or-later
// The potential `field`: energies, forces and stiffness, pair by pair and summed; slabs, onset, sheets.
#include "pressing.h"

#include "contact/friction/viscosity.h"
#include "contact/pressure/field.h"

enum { FOLDED = KINDS }; // after the kinds: a body that is folded on another

static void press_or_fold(Scene *scene, int kind) {
  press_on(scene, kind == FOLDED ? ON_BODY : kind);
  start(scene, "clip");
  if (kind == FOLDED) ck_assert_int_gt(fold(scene), 10);
}

START_TEST(forces_are_minus_the_gradient_of_the_energy) {
  Scene scene;
  press_or_fold(&scene, _i);
  int n = 3 * scene.blocks.vertex_count;
  double *x = blocks_copy(&scene.blocks), *force = forces_at(&scene, scene.blocks.x);
  double size = sqrt(product_dot(force, force, n));
  ck_assert_int_gt(contact_evaluation_active_count(evaluated_at(scene.system, 0, scene.blocks.x)), 10);
  ck_assert(size > 0);
  for (uint64_t k = 0; k < 10; k++) {
    double *d = random_motion(&scene, k, true), length = sqrt(product_dot(d, d, n));
    ck_assert_near(slope_along(&scene, d, 1e-5, x), -product_dot(force, d, n), 1e-8 * size * length);
    free(d);
  }
  free(x), free(force), destroy(&scene);
}
END_TEST

// No more than half of a cell's surface: what a polyhedron shows to any side.
static double half_surface(const double x[12]) {
  static const int faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  double sum = 0;
  for (int f = 0; f < 4; f++) {
    Vec3 a = vec3_at(x + 3 * faces[f][0]), b = vec3_sub(vec3_at(x + 3 * faces[f][1]), a),
         c = vec3_sub(vec3_at(x + 3 * faces[f][2]), a);
    sum += vec3_length(vec3_cross(b, c)) / 4;
  }
  return sum;
}

START_TEST(a_pair_of_a_folded_body_covers_an_area_that_cells_have) {
  Scene scene;
  press_or_fold(&scene, FOLDED);
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.blocks.x);
  for (int k = 0; k < evaluation->pair_count; k++) {
    const double *x = evaluation->coordinates + 24 * (size_t)k;
    double area = contact_field_area(&evaluation->fields[k]),
           most = fmin(half_surface(x), half_surface(x + 12));
    ck_assert_double_le(area, most);
    if (vec3_length(vec3_at(evaluation->fields[k].force)) > 0) ck_assert_double_gt(area, 0);
  }
  destroy(&scene);
}
END_TEST

START_TEST(stiffness_is_minus_the_derivative_of_the_forces) {
  Scene scene;
  press_or_fold(&scene, _i);
  int n = 3 * scene.blocks.vertex_count;
  double *x = blocks_copy(&scene.blocks), h = 1e-6;
  for (uint64_t k = 0; k < 5; k++) {
    double *d = random_motion(&scene, k, false);
    double *expected = stiffness_along(&scene, d, h, x);
    Product product = product_of(d, scene.blocks.vertex_count);
    ContactStiffnessSink sink = product_sink(&product);
    ck_assert_ok(
        contact_system_stiffness(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), &sink));
    double size = sqrt(product_dot(product.y, product.y, n));
    ck_assert(size > 0);
    for (int v = 0; v < scene.blocks.vertex_count; v++)
      for (int c = 0; c < 3; c++)
        if (v < scene.blocks.bodies[0].vertex_begin || v >= scene.blocks.bodies[0].vertex_end ||
            _i != ON_MESH)
          ck_assert_near(expected[3 * v + c], product.y[3 * v + c], 1e-6 * size);
    free(d), free(expected), free(product.y);
  }
  free(x), destroy(&scene);
}
END_TEST

// V and x̄ of a pair where it is moved along a way.
static void answers_at(const Scene *scene, const double coordinates[24], const double way[24], double share,
                       double answers[4]) {
  double there[24];
  for (int i = 0; i < 24; i++) there[i] = coordinates[i] + share * way[i];
  ck_assert_ok(overlap_model_eval(
      &scene->model,
      &(OverlapBatch){.pair_count = 1, .pairs = there, .volume = answers, .centroid = answers + 1}));
}

START_TEST(volumes_and_centroids_change_by_their_slopes) {
  static const double STEP = 1e-6, LEAST = 1e-4;
  Scene scene;
  const double *slopes;
  int count = 0;
  press_or_fold(&scene, _i ? FOLDED : ON_BODY);
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.blocks.x);
  ck_assert_ok(contact_system_slopes(scene.system, evaluation, &slopes));
  Random random = random_seeded(3, 0);
  for (int k = 0; k < evaluation->mesh_pair_count; k++) {
    double way[24], above[4], below[4];
    if (evaluation->fields[k].volume < LEAST) continue; // it is thin beside the step
    count++;
    for (int i = 0; i < 24; i++) way[i] = random_between(&random, -1, 1);
    answers_at(&scene, evaluation->coordinates + 24 * k, way, STEP, above);
    answers_at(&scene, evaluation->coordinates + 24 * k, way, -STEP, below);
    for (int a = 0; a < 4; a++) {
      double slope = product_dot(slopes + 96 * k + 24 * a, way, 24);
      ck_assert_near((above[a] - below[a]) / (2 * STEP), slope, 1e-5);
    }
  }
  ck_assert_int_gt(count, 10);
  destroy(&scene);
}
END_TEST

// ---- Balance.

static const char *const MODELS[] = {"clip", "clip32", "clip-scalar", "exact", "cgal"};
enum { MODEL_COUNT = 5 };

START_TEST(every_pair_balances_with_every_model) {
  if (suite_leaves_out(MODELS[_i])) return;
  Scene scene = {.system = NULL};
  press_blocks(&scene, false);
  start(&scene, MODELS[_i]);
  const ContactLayout *layout = contact_system_layout(scene.system);
  const ContactEvaluation *evaluation = evaluated_at(scene.system, 0, scene.blocks.x);
  ck_assert_int_gt(evaluation->pair_count, 50);
  double worst_force = 0, worst_torque = 0, largest = 0;
  for (int k = 0; k < evaluation->pair_count; k++) {
    Vec3 sum = {0, 0, 0}, torque = {0, 0, 0};
    double norms = 0;
    // Nothing is folded, wherever a model has x̄.
    for (int t = 0; t < 2; t++) ck_assert_double_eq(evaluation->fields[k].signs[t], 1);
    for (int v = 0; v < 8; v++) {
      int vertex = contact_layout_vertices(layout, evaluation->pairs[k].cells[v / 4])[v % 4];
      Vec3 force = vec3_at(evaluation->pair_forces + 24 * k + 3 * v),
           x = vec3_at(scene.blocks.x + 3 * vertex);
      sum = vec3_add(sum, force), torque = vec3_add(torque, vec3_cross(x, force));
      norms += vec3_length(force);
    }
    largest = suite_larger(largest, norms);
    worst_force = suite_larger(worst_force, vec3_length(sum));
    worst_torque = suite_larger(worst_torque, vec3_length(torque)); // lengths are of the order of 1
  }
  ck_assert(largest > 0);
  ck_assert(worst_force <= 1e-14 * largest);
  ck_assert(worst_torque <= 1e-14 * largest);
  destroy(&scene);
}
END_TEST

// V and the centroid that follows from ∇V: of a network too every pair balances, and so do the bodies.
START_TEST(a_model_without_its_own_centroid_presses_and_balances) {
  Scene scene = {.system = NULL};
  press_blocks(&scene, false);
  start(&scene, "tpn-scene");
  double *force = forces_at(&scene, scene.blocks.x), total[3] = {0}, largest = 0;
  for (int i = 0; i < 3 * scene.blocks.vertex_count; i++) {
    total[i % 3] += force[i];
    largest = fmax(largest, fabs(force[i]));
  }
  free(force);
  ck_assert(largest > 0);
  for (int c = 0; c < 3; c++) ck_assert_double_le(fabs(total[c]), 1e-13 * largest);
  destroy(&scene);
}
END_TEST

// ---- The contact mesh.

START_TEST(cells_fill_the_bodies_and_slope_by_one_on_every_outer_face) {
  Scene scene = {.system = NULL};
  press_blocks(&scene, false);
  start(&scene, "clip");
  const ContactLayout *layout = contact_system_layout(scene.system);
  const ContactMesh *mesh = &layout->mesh;
  int outer = 0;
  double *volumes = calloc((size_t)scene.blocks.tet_count, sizeof *volumes);
  ck_assert_int_gt(mesh->cell_count, scene.blocks.tet_count);
  for (int cell = 0; cell < mesh->cell_count; cell++) {
    volumes[contact_mesh_tet(mesh, cell)] += layout->cell_volumes[cell];
    Vec3 x[4], slope = {0, 0, 0};
    double phi[4];
    for (int v = 0; v < 4; v++) {
      x[v] = vec3_at(layout->rest + 3 * mesh->cells[cell][v]), phi[v] = mesh->depths[mesh->cells[cell][v]];
      ck_assert(phi[v] >= 0);
    }
    double det = vec3_det4(x[0], x[1], x[2], x[3]);
    for (int v = 0; v < 4; v++) {
      Vec3 a = x[(v + 1) % 4], b = x[(v + 2) % 4], c = x[(v + 3) % 4];
      double sign = v % 2 ? 1 : -1;
      slope = vec3_add(slope, vec3_scale(sign * phi[v] / det, vec3_cross(vec3_sub(b, a), vec3_sub(c, a))));
    }
    for (int f = 0; f < 4; f++) {
      if (!(mesh->outer[cell] >> f & 1)) continue;
      outer++;
      ck_assert_near(vec3_length(slope), 1, 0.0201);
    }
  }
  ck_assert_int_eq(outer, 2 * 2 * (3 * 3 + 3 + 3) + 2 * 2 * (2 * 2 + 2 * 3 * 2)); // two triangles a square
  for (int i = 0; i < scene.blocks.tet_count; i++)
    ck_assert_near(volumes[i], layout->tet_volumes[i], 1e-13 * layout->tet_volumes[i]);
  free(volumes), destroy(&scene);
}
END_TEST

// ---- Flat slabs of meshes that coincide or do not match, as in test_contact_slabs.c.

typedef struct Quality {
  double evenness, tangential, pressure;
} Quality;

// Lower slab of cells of edge h, upper of edge ratio · h, `depth` into it.
static Quality press_slabs(double h, double ratio, double depth, const double shift[2]) {
  Scene scene = {.system = NULL};
  int lower = (int)lround(8 / h), upper = (int)lround(6 / (h * ratio));
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-4, -4, -2 * h}, .cell = {h, h, h}, .cells = {lower, lower, 2}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-3 + shift[0], -3 + shift[1], -depth},
                                        .cell = {h * ratio, h * ratio, h * ratio},
                                        .cells = {upper, upper, 2}});
  start(&scene, "clip");
  double *force = forces_at(&scene, scene.blocks.x), sum = 0, squares = 0, tangential = 0, first = 0;
  int count = 0;
  for (int v = 0; v < scene.blocks.bodies[0].vertex_end; v++) {
    const double *x = scene.blocks.x + 3 * v, *f = force + 3 * v;
    if (fabs(x[0]) > 1.6 || fabs(x[1]) > 1.6) continue;
    tangential += hypot(f[0], f[1]);
    if (fabs(x[2]) > h / 2) {
      first += -f[2]; // what lands below the surface
      continue;
    }
    sum -= f[2], squares += f[2] * f[2], count++;
  }
  ck_assert_int_gt(count, 8);
  double mean = sum / count, pressure = (sum + first) / count / (h * h);
  free(force), destroy(&scene);
  return (Quality){sqrt(suite_larger(squares / count - mean * mean, 0)) / mean, tangential / (sum + first),
                   pressure};
}

START_TEST(flat_slabs_press_evenly_whatever_the_meshes) {
  static const double RATIOS[] = {1, 0.5, 0.77};
  static const double SHIFTS[][2] = {{0, 0}, {0.031, 0.117}, {0.5, 0.25}};
  for (int r = 0; r < 3; r++)
    for (int s = 0; s < 3; s++)
      for (int halvings = 0; halvings < 2; halvings++) {
        double depth = 0.1;
        Quality q = press_slabs(halvings ? 0.5 : 1, RATIOS[r], depth, SHIFTS[s]);
        ck_assert(q.evenness <= 1e-6); // the root of what is left of a difference of squares
        ck_assert(q.tangential <= 1e-10);
        ck_assert_near(q.pressure / (2 * STIFFNESS * depth), 1, 1e-3);
      }
}
END_TEST

START_TEST(the_pressure_does_not_depend_on_the_mesh) {
  Quality q = press_slabs(0.25, 1, 0.05, (double[]){0.01, 0.02});
  ck_assert_near(q.pressure / (2 * STIFFNESS * 0.05), 1, 1e-3);
}
END_TEST

// Up to the rim: what is not covered does not count.
START_TEST(traces_tell_pressure_and_depth_at_the_surface) {
  Scene scene = {.system = NULL};
  double depth = 0.07, pressure = 2 * STIFFNESS * depth;
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {0.5, 0.5, 1}, .cells = {16, 16, 2}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-1.93, -1.81, -depth}, .cell = {0.77, 0.77, 0.77}, .cells = {5, 5, 2}});
  start(&scene, "clip");
  size_t count = (size_t)scene.blocks.vertex_count;
  double *p = calloc(count, sizeof *p), *d = calloc(count, sizeof *d);
  ck_assert(p && d);
  ck_assert_ok(contact_system_trace(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), NULL,
                                    &(ContactTraceResult){.pressures = p, .depths = d}));
  int inside = 0, pressed = 0;
  for (int v = 0; v < scene.blocks.vertex_count; v++) {
    const double *x = scene.blocks.x + 3 * v;
    bool is_facing = v < scene.blocks.bodies[0].vertex_end ? x[2] == 0 : fabs(x[2] + depth) < 1e-12;
    pressed += p[v] > 0;
    if (!is_facing) continue;
    if (fabs(x[0]) > 0.9 || fabs(x[1]) > 0.9) continue; // away from its sides, which are near as well
    ck_assert_near(p[v], pressure, 1e-9 * pressure);
    ck_assert_near(d[v], depth, 1e-9 * depth);
    inside++;
  }
  ck_assert_int_gt(inside, 8);
  ck_assert_int_lt(pressed, scene.blocks.vertex_count / 2);
  free(p), free(d), destroy(&scene);
}
END_TEST

// Of the pressures p at the vertices that face the other block: within a share of what `exact` says of x, and
// nothing where it says 0; how many press.
static int expect_pressures(const Scene *scene, const double *p, double height, double share,
                            double (*exact)(const double x[3], bool is_upper)) {
  int pressed = 0;
  for (int v = 0; v < scene->blocks.vertex_count; v++) {
    const double *x = scene->blocks.x + 3 * v;
    bool is_upper = v >= scene->blocks.bodies[0].vertex_end;
    if (is_upper ? x[2] != height : x[2] != 0) continue;
    double wanted = exact(x, is_upper);
    ck_assert_msg(fabs(p[v] - wanted) <= share * wanted, "(%g, %g, %g): %g, not %g", x[0], x[1], x[2], p[v],
                  wanted);
    pressed += p[v] > 0;
  }
  return pressed;
}

enum { UPPER_SIDE = 5, MOST_VERTICES = 1500 };
static const double DEPTH = 1e-3, SLOPE = 1e-3;

static double under_a_punch(const double x[3], bool is_upper) {
  const double low = -1.93, high = -1.93 + UPPER_SIDE * 0.77;
  bool is_under = is_upper || (x[0] > low && x[0] < high && x[1] > low && x[1] < high);
  return is_under ? 2 * STIFFNESS * DEPTH : 0;
}

// Up to the very edge of a punch, on both bodies, and nothing on the lower one beside it.
START_TEST(the_pressure_is_told_up_to_the_edge_of_a_punch) {
  Scene scene = {.system = NULL};
  double p[MOST_VERTICES], d[MOST_VERTICES];
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {0.5, 0.5, 1}, .cells = {16, 16, 2}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-1.93, -1.93, -DEPTH},
                                        .cell = {0.77, 0.77, 0.77},
                                        .cells = {UPPER_SIDE, UPPER_SIDE, 2}});
  start(&scene, "clip");
  ck_assert_int_le(scene.blocks.vertex_count, MOST_VERTICES);
  energy_at(&scene, scene.blocks.x);
  ck_assert_ok(contact_system_trace(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), NULL,
                                    &(ContactTraceResult){.pressures = p, .depths = d}));
  int pressed = expect_pressures(&scene, p, -DEPTH, 0.02, under_a_punch);
  ck_assert_int_eq(pressed, (UPPER_SIDE + 1) * (UPPER_SIDE + 1) + 7 * 7);
  destroy(&scene);
}
END_TEST

static double under_a_tilted_face(const double x[3], bool is_upper) {
  double depth = is_upper ? -x[2] : DEPTH - SLOPE * x[0];
  return fmax(0, 2 * STIFFNESS * depth);
}

// Up to where it falls to nothing, x = 1 here: the last vertices before have .03 and .07 of the largest.
START_TEST(the_pressure_is_told_up_to_where_it_ends) {
  Scene scene = {.system = NULL};
  double p[MOST_VERTICES], d[MOST_VERTICES], x[3 * MOST_VERTICES];
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {0.5, 0.5, 1}, .cells = {16, 16, 2}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-5, -5, 0}, .cell = {0.77, 0.77, 0.77}, .cells = {13, 13, 2}});
  start(&scene, "clip");
  ck_assert_int_le(scene.blocks.vertex_count, MOST_VERTICES);
  memcpy(x, scene.blocks.x, 3 * (size_t)scene.blocks.vertex_count * sizeof *x);
  for (int v = scene.blocks.bodies[1].vertex_begin; v < scene.blocks.vertex_count; v++)
    x[3 * v + 2] += SLOPE * x[3 * v] - DEPTH;
  energy_at(&scene, x);
  ck_assert_ok(contact_system_trace(scene.system, evaluated_at(scene.system, 0, x), NULL,
                                    &(ContactTraceResult){.pressures = p, .depths = d}));
  int told = 0;
  for (int v = 0; v < scene.blocks.vertex_count; v++) {
    bool is_upper = v >= scene.blocks.bodies[0].vertex_end;
    const double *X = scene.blocks.x + 3 * v;
    if (X[2] != 0 || fabs(X[0]) > 3 || fabs(X[1]) > 3) continue;
    double wanted = under_a_tilted_face(x + 3 * v, is_upper);
    ck_assert_msg(fabs(p[v] - wanted) <= 0.02 * 2 * STIFFNESS * DEPTH, "(%g, %g): %g, not %g", X[0], X[1],
                  p[v], wanted);
    told += wanted > 0 && wanted < 0.6 * 2 * STIFFNESS * DEPTH;
  }
  ck_assert_int_gt(told, 10);
  destroy(&scene);
}
END_TEST

// Under a ball of radius R that is `deep` deep: c (deep − r²/2R) up to r = 2, nothing beyond the cells that
// end there. Its middle is within the face, or at its corner, as where a quarter is computed.
START_TEST(the_pressure_under_a_ball_ends_at_its_rim) {
  const double x0 = _i ? -4 : 0.13, y0 = _i ? -4 : 0.07, deep = 0.05, radius = 2 / deep, cell = 0.5;
  Scene scene = {.system = NULL, .shape_count = 1};
  double p[MOST_VERTICES], d[MOST_VERTICES];
  scene.shape = (ContactShape){
      .name = "ball", .kind = CONTACT_SHAPE_BALL, .point = {x0, y0, radius - deep}, .radius = radius};
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-4, -4, -2}, .cell = {cell, cell, 1}, .cells = {16, 16, 2}});
  start(&scene, "clip");
  ck_assert_int_le(scene.blocks.vertex_count, MOST_VERTICES);
  ck_assert_ok(contact_system_trace(scene.system, evaluated_at(scene.system, 0, scene.blocks.x), NULL,
                                    &(ContactTraceResult){.pressures = p, .depths = d}));
  int pressed = 0;
  for (int v = 0; v < scene.blocks.vertex_count; v++) {
    const double *x = scene.blocks.x + 3 * v;
    if (x[2] != 0) continue;
    double r = hypot(x[0] - x0, x[1] - y0), exact = STIFFNESS * fmax(0, deep - r * r / (2 * radius));
    double most = r > 0 ? 0.06 : 0.1; // of the largest: a cell's own curve, cell²/8R, is .16 of it
    ck_assert_msg(fabs(p[v] - exact) <= most * STIFFNESS * deep, "r = %g: %g, not %g", r, p[v], exact);
    if (r > 2 + 0.5 * cell) ck_assert_double_eq(p[v], 0);
    pressed += p[v] > 0;
  }
  ck_assert_int_gt(pressed, 10);
  destroy(&scene);
}
END_TEST

START_TEST(sliding_past_faces_that_coincide_costs_nothing) {
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {1, 1, 1}, .cells = {8, 8, 2}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-1, -1, -0.3}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(&scene, "clip");
  double before = energy_at(&scene, scene.blocks.x);
  for (int k = 0; k < 8; k++) {
    double *force = forces_at(&scene, scene.blocks.x), total[3] = {0};
    for (int v = 0; v < 3 * scene.blocks.bodies[0].vertex_end; v++) total[v % 3] += force[v];
    ck_assert(hypot(total[0], total[1]) <= 1e-10 * fabs(total[2]));
    blocks_shift(&scene.blocks, scene.blocks.x, 1, (double[]){0.125, 0, 0});
    move(&scene);
    ck_assert_near(energy_at(&scene, scene.blocks.x), before, 1e-13 * before);
    free(force);
  }
  destroy(&scene);
}
END_TEST

// A block beside a loaded one, tilted by θ and lowered until its face is wet.
START_TEST(a_tilted_face_begins_with_no_leap) {
  double theta = pow(10, -1 - 2 * _i), length = 2, width = 2;
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {1, 1, 1}, .cells = {8, 8, 2}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-3, -1, -0.3}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {0, -1, 0}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  scene.rest = blocks_copy(&scene.blocks);
  for (int v = scene.blocks.bodies[2].vertex_begin; v < scene.blocks.bodies[2].vertex_end; v++) {
    double *x = scene.blocks.x + 3 * v, at[2] = {x[0], x[2]};
    x[0] = cos(theta) * at[0] + sin(theta) * at[1];
    x[2] = cos(theta) * at[1] - sin(theta) * at[0]; // the far edge goes down by θ · length
  }
  start(&scene, "clip");
  double *force = forces_at(&scene, scene.blocks.x), total = 0;
  for (int v = scene.blocks.bodies[2].vertex_begin; v < scene.blocks.bodies[2].vertex_end; v++)
    total += force[3 * v + 2];
  ck_assert(total > 0);
  ck_assert(total <= 4 * STIFFNESS * length * width * theta * length);
  free(force), destroy(&scene);
}
END_TEST

START_TEST(what_is_wholly_inside_is_pushed_out) {
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-5, -5, -10}, .cell = {1, 1, 1}, .cells = {10, 10, 10}});
  blocks_add(
      &scene.blocks,
      &(BlockDef){.corner = {-0.1, -0.13, -1.1 - 0.5 * _i}, .cell = {0.1, 0.1, 0.1}, .cells = {2, 2, 2}});
  start(&scene, "clip");
  double *force = forces_at(&scene, scene.blocks.x), total = 0, volume = 0.2 * 0.2 * 0.2;
  for (int v = scene.blocks.bodies[1].vertex_begin; v < scene.blocks.bodies[1].vertex_end; v++)
    total += force[3 * v + 2];
  ck_assert_near(total / (STIFFNESS * volume), 1, 1e-9);
  free(force), destroy(&scene);
}
END_TEST

START_TEST(a_sheet_of_one_cell_pushes_outwards) {
  static const double DEPTHS[] = {0.1, 0.5, 0.9, 1.0};
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -1}, .cell = {1, 1, 1}, .cells = {8, 8, 1}});
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-1.07, -0.91, 0}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(&scene, "clip");
  for (int k = 0; k < 4; k++) {
    double low = k ? DEPTHS[k - 1] : 0, total = 0;
    blocks_shift(&scene.blocks, scene.blocks.x, 1, (double[]){0, 0, low - DEPTHS[k]});
    move(&scene);
    double *force = forces_at(&scene, scene.blocks.x);
    for (int v = scene.blocks.bodies[1].vertex_begin; v < scene.blocks.bodies[1].vertex_end; v++)
      total += force[3 * v + 2];
    ck_assert(total > 0);
    free(force);
  }
  destroy(&scene);
}
END_TEST

static double det_of(const Scene *scene, int tet, const double *x) {
  const int *v = scene->blocks.tets[tet];
  return vec3_det4(vec3_at(x + 3 * v[0]), vec3_at(x + 3 * v[1]), vec3_at(x + 3 * v[2]),
                   vec3_at(x + 3 * v[3]));
}

// A corner is pushed into its block, through tetrahedra of which every vertex is on the surface.
START_TEST(a_corner_that_is_turned_inside_out_makes_no_leap) {
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {1, 1, 1}, .cells = {8, 8, 2}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-1.07, -0.91, -0.6}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(&scene, "clip");
  const ContactBody *upper = &scene.blocks.bodies[1];
  int corner = upper->vertex_begin + 2, turned = 0, n = 3 * scene.blocks.vertex_count;
  double *d = calloc((size_t)n, sizeof(double)), *x = blocks_copy(&scene.blocks);
  ck_assert_ptr_nonnull(d);
  memcpy(d + 3 * corner, (double[]){-0.7, 0.6, 0.5}, 3 * sizeof(double));
  for (int i = upper->tet_begin; i < upper->tet_end; i++) {
    double low = 0, high = 1, deepest = 0, before = det_of(&scene, i, scene.blocks.x);
    for (int v = 0; v < 4; v++)
      deepest = fmax(deepest, contact_system_layout(scene.system)->mesh.depths[scene.blocks.tets[i][v]]);
    step_to(&scene, high, d, x);
    if (deepest > 0 || !(before * det_of(&scene, i, x) < 0)) continue;
    for (int k = 0; k < 40; k++) {
      double middle = (low + high) / 2;
      step_to(&scene, middle, d, x);
      *(before * det_of(&scene, i, x) > 0 ? &low : &high) = middle;
    }
    step_to(&scene, low - 1e-6, d, x);
    ck_assert_ok(contact_system_update(scene.system, 0, x, scene.still, 0.01));
    double *above = forces_at(&scene, x);
    step_to(&scene, high + 1e-6, d, x);
    double *below = forces_at(&scene, x), size = sqrt(product_dot(above, above, n));
    for (int k = 0; k < n; k++) below[k] -= above[k];
    ck_assert_double_le(sqrt(product_dot(below, below, n)), 1e-4 * size);
    turned++;
    free(above), free(below);
  }
  ck_assert_int_ge(turned, 2);
  free(d), free(x), destroy(&scene);
}
END_TEST

// ---- Faces that are no surface.

// The force between them, over 2 c d times their area.
static double share_of_force(bool has_inner, double *sideways) {
  double depth = 0.1, total[3] = {0};
  Scene scene = {.system = NULL};
  blocks_add(&scene.blocks, &(BlockDef){.corner = {0, 0, -2}, .cell = {1, 1, 1}, .cells = {4, 4, 2}});
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {0, 0, -depth}, .cell = {0.8, 0.8, 0.7}, .cells = {5, 5, 3}});
  unsigned char *inner = blocks_mark_sides(&scene.blocks, 4);
  scene.inner = has_inner ? inner : NULL;
  start(&scene, "clip");
  double *force = forces_at(&scene, scene.blocks.x);
  for (int k = 3 * scene.blocks.bodies[1].vertex_begin; k < 3 * scene.blocks.vertex_count; k++)
    total[k % 3] += force[k];
  *sideways = hypot(total[0], total[1]) / total[2];
  free(force), free(inner), destroy(&scene);
  return total[2] / (2 * STIFFNESS * depth * 16);
}

START_TEST(faces_of_symmetry_are_no_surface) {
  double sideways;
  ck_assert_near(share_of_force(true, &sideways), 1, 1e-12);
  ck_assert(sideways <= 1e-12);
  ck_assert(share_of_force(false, &sideways) < 0.99); // near a rim the field looks sideways
}
END_TEST

// ---- Viscosity: a pressure η d ḋ of each of the two terms, of a shape one.

START_TEST(viscosity_presses_by_depth_and_speed) {
  double depth = 0.1, speed = 0.7, coefficient = 3, area = 4;
  bool on_block = _i;
  Scene scene = {.system = NULL};
  if (on_block) {
    blocks_add(&scene.blocks, &(BlockDef){.corner = {-4, -4, -2}, .cell = {1, 1, 1}, .cells = {8, 8, 2}});
  } else {
    scene.shape_count = 1;
    scene.shape = (ContactShape){.name = "floor", .normal = {0, 0, 1}};
  }
  blocks_add(&scene.blocks,
             &(BlockDef){.corner = {-1.1, -0.9, -depth}, .cell = {1, 1, 1}, .cells = {2, 2, 2}});
  start(&scene, "clip");
  ContactViscosity law;
  ContactViscosityPower power;
  ck_assert_ok(contact_viscosity_create(&law, scene.system, coefficient));
  const ContactBody *upper = &scene.blocks.bodies[scene.blocks.body_count - 1];
  double total[3] = {0}, *v = calloc(3 * (size_t)scene.blocks.vertex_count, sizeof *v);
  double *force = calloc(3 * (size_t)scene.blocks.vertex_count, sizeof *force);
  ck_assert(v && force);
  for (int a = upper->vertex_begin; a < upper->vertex_end; a++) v[3 * a + 2] = -speed;
  ContactViscosityMotion motion = {evaluated_at(scene.system, 0, scene.blocks.x), v};
  contact_viscosity_add_force(&law, motion, force);
  power = contact_viscosity_power(&law, motion);
  for (int k = 3 * upper->vertex_begin; k < 3 * upper->vertex_end; k++) total[k % 3] += force[k];
  double expected =
      coefficient * depth * speed * area; // of one term; the lower block's slope is 1 all over it
  if (!on_block) ck_assert_near(total[2], expected, 1e-12 * expected);
  if (on_block)
    ck_assert(total[2] > 1.8 * expected && total[2] <= 2 * expected); // less at the upper one's rim
  ck_assert_near(power.dissipated, total[2] * speed, 1e-12 * power.dissipated);
  free(v), free(force), destroy(&scene);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("field");
  tcase_add_loop_test(tests, forces_are_minus_the_gradient_of_the_energy, 0, FOLDED + 1);
  tcase_add_test(tests, a_pair_of_a_folded_body_covers_an_area_that_cells_have);
  tcase_add_loop_test(tests, stiffness_is_minus_the_derivative_of_the_forces, 0, FOLDED + 1);
  tcase_add_loop_test(tests, volumes_and_centroids_change_by_their_slopes, 0, 2);
  tcase_add_loop_test(tests, every_pair_balances_with_every_model, 0, MODEL_COUNT);
  tcase_add_test(tests, a_model_without_its_own_centroid_presses_and_balances);
  tcase_add_test(tests, cells_fill_the_bodies_and_slope_by_one_on_every_outer_face);
  tcase_add_test(tests, flat_slabs_press_evenly_whatever_the_meshes);
  tcase_add_test(tests, the_pressure_does_not_depend_on_the_mesh);
  tcase_add_test(tests, traces_tell_pressure_and_depth_at_the_surface);
  tcase_add_test(tests, the_pressure_is_told_up_to_the_edge_of_a_punch);
  tcase_add_test(tests, the_pressure_is_told_up_to_where_it_ends);
  tcase_add_loop_test(tests, the_pressure_under_a_ball_ends_at_its_rim, 0, 2);
  tcase_add_test(tests, sliding_past_faces_that_coincide_costs_nothing);
  tcase_add_loop_test(tests, a_tilted_face_begins_with_no_leap, 0, 5);
  tcase_add_loop_test(tests, what_is_wholly_inside_is_pushed_out, 0, 4);
  tcase_add_test(tests, a_sheet_of_one_cell_pushes_outwards);
  tcase_add_test(tests, a_corner_that_is_turned_inside_out_makes_no_leap);
  tcase_add_test(tests, faces_of_symmetry_are_no_surface);
  tcase_add_loop_test(tests, viscosity_presses_by_depth_and_speed, 0, 2);
  return suite_run("field", tests, 60);
}
