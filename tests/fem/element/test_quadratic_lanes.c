// SPDX-License-Identifier: GPL-3.0-or-later
// Quadratic elements of fem/lanes on every instruction set that this processor has, against the formulas for
// one element; and the packs of a model of both kinds of elements.
#include "suite.h"

#include "base/memory.h"
#include "base/random.h"
#include "fem/effect/elements/packs.h"
#include "fem/lanes/lanes.h"
#include "fem/model/build.h"
#include "reference/element.h"

enum { ROUNDS = 24, NODES = FEM_QUADRATIC_NODES, DOFS = 3 * NODES };

// Eight curved elements of an edge about 1 and their state; nodes 10 l … 10 l + 9 are those of lane l.
typedef struct Eight {
  FemQuadratic element[FEM_LANES];
  FemLanesQuadratics lanes;
  double x[DOFS * FEM_LANES], v[DOFS * FEM_LANES];
} Eight;

static void fill_lane(FemLanesQuadratics *lanes, const FemQuadratic *element, int l, const int nodes[NODES]) {
  for (int a = 0; a < NODES; a++) lanes->node[a][l] = nodes[a];
  for (int p = 0; p < FEM_QUADRATIC_POINTS; p++) {
    lanes->weight[p][l] = element->weight[p];
    for (int a = 1; a < NODES; a++)
      for (int j = 0; j < 3; j++) lanes->gradient[p][3 * (a - 1) + j][l] = element->gradient[p][a][j];
  }
  lanes->volume[l] = element->volume;
}

static Eight eight_random(Random *random, double amount) {
  static const double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Eight eight = {.lanes = {.count = FEM_LANES}};
  for (int l = 0; l < FEM_LANES; l++) {
    double rest[DOFS];
    int nodes[NODES];
    for (int a = 0; a < NODES; a++) {
      nodes[a] = NODES * l + a;
      for (int i = 0; i < 3; i++) {
        const int *edge = a < 4 ? NULL : fem_quadratic_edges[a - 4];
        double at = edge ? 0.5 * (corner[edge[0]][i] + corner[edge[1]][i]) : corner[a][i];
        rest[3 * a + i] = at + random_between(random, -0.03, 0.03);
      }
    }
    ck_assert(fem_quadratic_min_jacobian(rest) > 0);
    fem_quadratic_create_curved(&eight.element[l], rest);
    for (int k = 0; k < DOFS; k++) {
      eight.x[DOFS * l + k] = rest[k] + amount * random_between(random, -1, 1);
      eight.v[DOFS * l + k] = random_between(random, -1, 1);
    }
    fill_lane(&eight.lanes, &eight.element[l], l, nodes);
  }
  return eight;
}

static const double amounts[] = {1e-6, 0.02, 0.1, 1}, allowed[] = {1e-14, 1e-14, 1e-14, 1e-12};

static double largest(const double *values, int count) {
  double most = 1;
  for (int k = 0; k < count; k++) most = fmax(most, fabs(values[k]));
  return most;
}

static void check_forces(FemLanesRow force[DOFS], int lane, const double expected[DOFS], double tolerance,
                         const char *what) {
  double scale = largest(expected, DOFS);
  for (int r = 0; r < DOFS; r++)
    ck_assert_msg(fabs(force[r][lane] - expected[r]) <= tolerance * scale, "%s: %.17g for %.17g", what,
                  force[r][lane], expected[r]);
}

static void check_matrix(FemLanesRow matrix[FEM_LANES_HALF], int lane, const double *expected,
                         double tolerance, const char *what) {
  double scale = largest(expected, DOFS * DOFS);
  for (int r = 0, k = 0; r < DOFS; r++)
    for (int c = 0; c <= r; c++, k++)
      ck_assert_msg(fabs(matrix[k][lane] - expected[DOFS * r + c]) <= tolerance * scale,
                    "%s, %d %d: %.17g for %.17g", what, r, c, matrix[k][lane], expected[DOFS * r + c]);
}

// Of second order in the deformation, from terms of first: 1e-16 of those may be lost.
static void check_scalar(double value, double expected, int round, const char *what) {
  double tolerance = allowed[round % 4] * fabs(expected) + 2e-15 * amounts[round % 4];
  ck_assert_msg(fabs(value - expected) <= tolerance, "%s: %.17g for %.17g", what, value, expected);
}

// A law; beyond them laws with fibres.
enum { MATERIALS = 2 * FEM_MATERIAL_LAW_COUNT };

static FemMaterial material_of(int number) {
  return (FemMaterial){.law = (FemMaterialLaw)(number % FEM_MATERIAL_LAW_COUNT),
                       .young = 1,
                       .poisson = 0.3,
                       .density = 1,
                       .mooney = 0.3,
                       .exponents = {1.3, 5, -2},
                       .shares = {0.9, 0.02, 0.08},
                       .fibre_stiffness = number < FEM_MATERIAL_LAW_COUNT ? 0 : 2,
                       .fibre_direction = {1, 0.5, -2},
                       .fibres_buckle = true,
                       .viscosity = 0.1,
                       .bulk_viscosity = 0.2};
}

// Without and with a share of the mean volume change.
START_TEST(elastic_forces_and_matrices_are_those_of_single_elements) {
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(81, 0);
  static FemLanesRow matrix[FEM_LANES_HALF];
  for (int round = 0; round < ROUNDS; round++) {
    Eight eight = eight_random(&random, amounts[round % 4]);
    FemQuadraticLaw law = {&material, round % 8 < 4 ? 0 : 1.5};
    for (int k = 0; k < count; k++) {
      FemLanesRow force[DOFS], energy;
      all[k]->quadratic_energy(law, &eight.lanes, eight.x, energy);
      all[k]->quadratic_force(law, &eight.lanes, eight.x, force);
      all[k]->quadratic_matrix(law, &eight.lanes, eight.x, 2, matrix);
      for (int l = 0; l < FEM_LANES; l++) {
        double expected[DOFS * DOFS];
        check_scalar(energy[l], reference_quadratic_energy(&eight.element[l], law, eight.x + DOFS * l), round,
                     all[k]->name);
        reference_quadratic_force(&eight.element[l], law, eight.x + DOFS * l, expected);
        check_forces(force, l, expected, allowed[round % 4], all[k]->name);
        reference_quadratic_stiffness(&eight.element[l], law, eight.x + DOFS * l, expected);
        for (int r = 0; r < DOFS * DOFS; r++) expected[r] *= 2;
        check_matrix(matrix, l, expected, allowed[round % 4], all[k]->name);
      }
    }
  }
}
END_TEST

START_TEST(damping_forces_and_matrices_are_those_of_single_elements) {
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(82, 0);
  static FemLanesRow matrix[FEM_LANES_HALF];
  for (int round = 0; round < ROUNDS; round++) {
    Eight eight = eight_random(&random, amounts[round % 4]);
    for (int k = 0; k < count; k++) {
      FemLanesRow force[DOFS], power;
      all[k]->quadratic_damping_power(&material, 0.1, &eight.lanes, eight.x, eight.v, power);
      all[k]->quadratic_damping_force(&material, 0.1, &eight.lanes, eight.x, eight.v, force);
      all[k]->quadratic_damping_matrix(&material, 0.1, &eight.lanes, eight.x, eight.v, 3, 2, matrix);
      for (int l = 0; l < FEM_LANES; l++) {
        double expected[DOFS * DOFS], taken = 0;
        const double *x = eight.x + DOFS * l, *v = eight.v + DOFS * l;
        reference_quadratic_damping_force(&eight.element[l], &material, 0.1, x, v, expected);
        for (int r = 0; r < DOFS; r++) taken -= expected[r] * v[r];
        check_scalar(power[l], taken, round, all[k]->name);
        check_forces(force, l, expected, allowed[round % 4], all[k]->name);
        reference_quadratic_damping_matrix(&eight.element[l], &material, 0.1, x, v, 3, 2, expected);
        check_matrix(matrix, l, expected, allowed[round % 4], all[k]->name);
      }
    }
  }
}
END_TEST

// Lanes in the reverse order give the reverse of the numbers, to the bit.
START_TEST(a_lane_hangs_on_its_element_alone) {
  FemMaterial material = material_of(_i);
  FemQuadraticLaw law = {&material, 1.5};
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(83, 0);
  Eight eight = eight_random(&random, 0.1), turned = eight;
  for (int l = 0; l < FEM_LANES; l++) {
    int from = FEM_LANES - 1 - l, nodes[NODES];
    for (int a = 0; a < NODES; a++) nodes[a] = NODES * from + a;
    fill_lane(&turned.lanes, &eight.element[from], l, nodes);
  }
  static FemLanesRow here[FEM_LANES_HALF], there[FEM_LANES_HALF];
  for (int k = 0; k < count; k++) {
    all[k]->quadratic_matrix(law, &eight.lanes, eight.x, 1, here);
    all[k]->quadratic_matrix(law, &turned.lanes, eight.x, 1, there);
    for (int n = 0; n < FEM_LANES_HALF; n++)
      for (int l = 0; l < FEM_LANES; l++) ck_assert(here[n][l] == there[n][FEM_LANES - 1 - l]);
  }
}
END_TEST

START_TEST(scattering_adds_lanes_that_are_there_where_there_is_a_place) {
  Random random = random_seeded(84, 0);
  Eight eight = eight_random(&random, 0);
  eight.lanes.count = 5;
  static FemLanesRow matrix[FEM_LANES_HALF];
  static int slots[FEM_LANES_HALF][FEM_LANES];
  double value[7] = {0}, expected[7] = {0};
  for (int k = 0; k < FEM_LANES_HALF; k++)
    for (int l = 0; l < FEM_LANES; l++) {
      matrix[k][l] = k + 1000 * l; // whole numbers: sums of any order are equal
      slots[k][l] = (k + l) % 8 - 1;
      if (l < 5 && slots[k][l] >= 0) expected[slots[k][l]] += matrix[k][l];
    }
  fem_lanes()->scatter_quadratic_matrix(&eight.lanes, slots, matrix, value);
  for (int s = 0; s < 7; s++) ck_assert(value[s] == expected[s]);
}
END_TEST

// A linear and a quadratic box: each element once, in packs of its kind, nodes as in the model.
START_TEST(packs_hold_the_elements_of_their_kind) {
  static char names[2][8] = {"one", "two"};
  FemBodyDef bodies[2];
  for (int b = 0; b < 2; b++) {
    bodies[b] = (FemBodyDef){
        .name = names[b],
        .box_size = {1, 1, 1},
        .box_cells = {3, 3, 4},
        .element = b == 0 ? FEM_ELEMENT_LINEAR : FEM_ELEMENT_QUADRATIC,
        .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
        .material = {.law = FEM_MATERIAL_STVK, .young = 1, .poisson = 0.3, .density = 1, .damping = -1}};
    bodies[b].placement.translate[0] = 2 * b;
  }
  FemSceneDef def = {.bodies = bodies, .body_count = 2};
  FemModel model;
  FemPacks packs;
  ck_assert_ok(fem_model_create(&model, &def));
  ck_assert_int_gt(model.quadratic_count, 100);
  ck_assert_ok(fem_packs_create(&packs, &model, true, NULL));
  ck_assert_int_eq(packs.element_count, model.quadratic_count);
  int *seen = memory_zeroed((size_t)model.quadratic_count, sizeof *seen);
  for (int p = 0; p < packs.pack_count; p++)
    for (int l = 0; l < packs.quadratics[p].count; l++) {
      int element = packs.quadratics[p].element[l];
      ck_assert_int_eq(seen[element]++, 0);
      for (int a = 0; a < NODES; a++)
        ck_assert_int_eq(packs.quadratics[p].node[a][l], model.quadratic_nodes[element][a]);
    }
  for (int e = 0; e < model.quadratic_count; e++) ck_assert_int_eq(seen[e], 1);
  fem_packs_destroy(&packs);
  ck_assert_ok(fem_packs_create(&packs, &model, false, NULL));
  ck_assert_int_eq(packs.element_count, model.bodies[0].tet_end - model.bodies[0].tet_begin);
  fem_packs_destroy(&packs);
  memory_free(seen);
  fem_model_destroy(&model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("quadratic_lanes");
  tcase_add_loop_test(cases, elastic_forces_and_matrices_are_those_of_single_elements, 0, MATERIALS);
  tcase_add_loop_test(cases, damping_forces_and_matrices_are_those_of_single_elements, 0, MATERIALS);
  tcase_add_loop_test(cases, a_lane_hangs_on_its_element_alone, 0, MATERIALS);
  tcase_add_test(cases, scattering_adds_lanes_that_are_there_where_there_is_a_place);
  tcase_add_test(cases, packs_hold_the_elements_of_their_kind);
  return suite_run("quadratic_lanes", cases, 30);
}
