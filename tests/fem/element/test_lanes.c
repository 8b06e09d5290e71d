// SPDX-License-Identifier: GPL-3.0-or-later
// fem/lanes on every instruction set that this processor has, against the formulas for one element;
// and fem/effect/elements/packs, the order in which elements come to them.
#include "suite.h"

#include <string.h>

#include "base/memory.h"
#include "base/random.h"
#include "fem/effect/elements/assembly.h"
#include "fem/effect/elements/packs.h"
#include "fem/lanes/lanes.h"
#include "fem/model/build.h"
#include "reference/element.h"

enum { ROUNDS = 40 };

// Eight elements of an edge about 1 and their state; nodes 4 l … 4 l + 3 are those of lane l.
typedef struct Eight {
  FemElement element[FEM_LANES];
  FemLanesElements lanes;
  double x[12 * FEM_LANES], v[12 * FEM_LANES];
} Eight;

// Deformed by `amount`: 0.1 is large, 2 turns some elements inside out.
static Eight eight_random(Random *random, double amount) {
  static const double corner[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  Eight eight = {.lanes = {.count = FEM_LANES}};
  for (int l = 0; l < FEM_LANES; l++) {
    double rest[12];
    for (int k = 0; k < 12; k++) rest[k] = corner[k] + random_between(random, -0.1, 0.1);
    fem_element_create(&eight.element[l], rest);
    for (int k = 0; k < 12; k++) {
      eight.x[12 * l + k] = rest[k] + amount * random_between(random, -1, 1);
      eight.v[12 * l + k] = random_between(random, -1, 1);
    }
    for (int a = 0; a < 4; a++) eight.lanes.node[a][l] = 4 * l + a;
    for (int a = 0; a < 3; a++)
      for (int j = 0; j < 3; j++) eight.lanes.gradient[3 * a + j][l] = eight.element[l].gradient[a + 1][j];
    eight.lanes.volume[l] = eight.element[l].volume;
  }
  return eight;
}

// Elements turned inside out have a J near zero, whose logarithm and powers make more of its rounding.
static const double amounts[] = {1e-6, 0.05, 0.3, 2}, allowed[] = {1e-14, 1e-14, 1e-14, 1e-12};

static double largest(const double *values, int count) {
  double most = 0;
  for (int k = 0; k < count; k++) most = fmax(most, fabs(values[k]));
  return most;
}

static void check_forces(FemLanesRow force[12], int lane, const double expected[12], double tolerance,
                         const char *what) {
  double scale = fmax(largest(expected, 12), 1);
  for (int r = 0; r < 12; r++)
    ck_assert_msg(fabs(force[r][lane] - expected[r]) <= tolerance * scale, "%s: %.17g for %.17g", what,
                  force[r][lane], expected[r]);
}

static void check_matrix(FemLanesRow matrix[FEM_LANES_ENTRIES], int lane, const double expected[144],
                         double tolerance, const char *what) {
  double dense[144], scale = fmax(largest(expected, 144), 1);
  fem_lanes_unpack(matrix, lane, dense);
  for (int k = 0; k < 144; k++)
    ck_assert_msg(fabs(dense[k] - expected[k]) <= tolerance * scale, "%s: %.17g for %.17g", what, dense[k],
                  expected[k]);
}

// Of second order in the deformation, from terms of first: 1e-16 of those may be lost.
static void check_scalar(double value, double expected, int round, const char *what) {
  double tolerance = allowed[round % 4] * fabs(expected) + 2e-15 * amounts[round % 4];
  ck_assert_msg(fabs(value - expected) <= tolerance, "%s: %.17g for %.17g", what, value, expected);
}

// A law; beyond them laws with fibres: those that buckle, and such that do not.
enum { MATERIALS = 3 * FEM_MATERIAL_LAW_COUNT };

static FemMaterial material_of(int number) {
  int fibres = number / FEM_MATERIAL_LAW_COUNT;
  return (FemMaterial){.law = (FemMaterialLaw)(number % FEM_MATERIAL_LAW_COUNT),
                       .young = 1,
                       .poisson = 0.3,
                       .density = 1,
                       .mooney = 0.3,
                       .exponents = {1.3, 5, -2},
                       .shares = {0.9, 0.02, 0.08},
                       .fibre_stiffness = fibres > 0 ? 2 : 0,
                       .fibre_direction = {1, 0.5, -2},
                       .fibres_buckle = fibres > 1,
                       .viscosity = 0.1,
                       .bulk_viscosity = 0.2};
}

START_TEST(elastic_forces_and_matrices_are_those_of_single_elements) {
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(71, 0);
  for (int round = 0; round < ROUNDS; round++) {
    Eight eight = eight_random(&random, amounts[round % 4]);
    for (int k = 0; k < count; k++) {
      FemLanesRow force[12], matrix[FEM_LANES_ENTRIES], energy;
      all[k]->force(&material, &eight.lanes, eight.x, force);
      all[k]->matrix(&material, &eight.lanes, eight.x, 2, matrix);
      all[k]->energy(&material, &eight.lanes, eight.x, energy);
      for (int l = 0; l < FEM_LANES; l++) {
        check_scalar(energy[l], reference_element_energy(&eight.element[l], &material, eight.x + 12 * l),
                     round, all[k]->name);
        double expected[144];
        reference_element_force(&eight.element[l], &material, eight.x + 12 * l, expected);
        check_forces(force, l, expected, allowed[round % 4], all[k]->name);
        reference_element_stiffness(&eight.element[l], &material, eight.x + 12 * l, expected);
        for (int r = 0; r < 144; r++) expected[r] *= 2;
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
  Random random = random_seeded(72, 0);
  for (int round = 0; round < ROUNDS; round++) {
    Eight eight = eight_random(&random, amounts[round % 4]);
    for (int k = 0; k < count; k++) {
      FemLanesRow force[12], matrix[FEM_LANES_ENTRIES], power;
      all[k]->damping_force(&material, 0.1, &eight.lanes, eight.x, eight.v, force);
      all[k]->damping_matrix(&material, 0.1, &eight.lanes, eight.x, eight.v, 3, 2, matrix);
      all[k]->damping_power(&material, 0.1, &eight.lanes, eight.x, eight.v, power);
      for (int l = 0; l < FEM_LANES; l++) {
        const double *x = eight.x + 12 * l, *v = eight.v + 12 * l;
        double expected[144], part[144], taken = 0;
        reference_element_damping_force(&eight.element[l], &material, 0.1, x, v, expected);
        for (int r = 0; r < 12; r++) taken -= expected[r] * v[r];
        check_scalar(power[l], taken, round, all[k]->name);
        check_forces(force, l, expected, allowed[round % 4], all[k]->name);
        reference_element_damping_stiffness(&eight.element[l], &material, 0.1, eight.x + 12 * l,
                                            eight.v + 12 * l, expected);
        reference_element_damping_matrix(&eight.element[l], &material, 0.1, eight.x + 12 * l, part);
        for (int r = 0; r < 144; r++) expected[r] = 3 * expected[r] + 2 * part[r];
        check_matrix(matrix, l, expected, allowed[round % 4], all[k]->name);
      }
    }
  }
}
END_TEST

// Lanes in the reverse order give the reverse of the numbers, to the bit.
START_TEST(a_lane_hangs_on_its_element_alone) {
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(73, 0);
  Eight eight = eight_random(&random, 0.3), turned = eight;
  for (int l = 0; l < FEM_LANES; l++) {
    int from = FEM_LANES - 1 - l;
    for (int a = 0; a < 4; a++) turned.lanes.node[a][l] = eight.lanes.node[a][from];
    for (int g = 0; g < 9; g++) turned.lanes.gradient[g][l] = eight.lanes.gradient[g][from];
    turned.lanes.volume[l] = eight.lanes.volume[from];
  }
  for (int k = 0; k < count; k++) {
    FemLanesRow here[2][FEM_LANES_ENTRIES], there[2][FEM_LANES_ENTRIES];
    all[k]->matrix(&material, &eight.lanes, eight.x, 1, here[0]);
    all[k]->matrix(&material, &turned.lanes, eight.x, 1, there[0]);
    all[k]->damping_matrix(&material, 0.1, &eight.lanes, eight.x, eight.v, 1, 1, here[1]);
    all[k]->damping_matrix(&material, 0.1, &turned.lanes, eight.x, eight.v, 1, 1, there[1]);
    for (int kind = 0; kind < 2; kind++)
      for (int n = 0; n < FEM_LANES_ENTRIES; n++)
        for (int l = 0; l < FEM_LANES; l++) ck_assert(here[kind][n][l] == there[kind][n][FEM_LANES - 1 - l]);
  }
}
END_TEST

// All lanes of an element whose nodes 1, 2, 3 are unit vectors at rest: its F, by columns, is what they are.
static void eight_deform(Eight *eight, const double F[9]) {
  static const double rest[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int l = 0; l < FEM_LANES; l++) {
    fem_element_create(&eight->element[l], rest);
    for (int a = 0; a < 4; a++)
      for (int i = 0; i < 3; i++) eight->x[12 * l + 3 * a + i] = a == 0 ? 0 : F[3 * i + a - 1];
    for (int a = 0; a < 3; a++)
      for (int j = 0; j < 3; j++) eight->lanes.gradient[3 * a + j][l] = eight->element[l].gradient[a + 1][j];
    eight->lanes.volume[l] = eight->element[l].volume;
  }
}

// At rest, turned, equal stretches, beyond the edges of powers and logarithms, tiny, huge, flat, mirrored.
START_TEST(deformations_of_every_kind_are_those_of_single_elements) {
  static const double kinds[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                    {0, -1, 0, 1, 0, 0, 0, 0, 1},
                                    {1.5, 0, 0, 0, 1.5, 0, 0, 0, 1.5},
                                    {0.05, 0, 0, 0, 2, 0, 0, 0, 1},
                                    {0.05, 0, 0, 0, 0.07, 0, 0, 0, 1},
                                    {1e-3, 0, 0, 0, 0.02, 0, 0, 0, 3},
                                    {1, 0, 0, 0, 1 + 1e-9, 0, 0, 0, 2},
                                    {1, 1, 0, 0, 1, 0, 0, 0, 0},
                                    {0.9, 0, 0, 0, 1.3, 0, 0, 0, -0.4},
                                    {30, 0, 0, 0, 20, 1, 0, 0, 50},
                                    {2e-11, 0, 0, 0, 1e-11, 0, 0, 0, 3e-11}};
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(75, 0);
  Eight eight = eight_random(&random, 0);
  for (size_t n = 0; n < sizeof kinds / sizeof *kinds; n++) {
    eight_deform(&eight, kinds[n]);
    for (int k = 0; k < count; k++) {
      FemLanesRow force[12], matrix[FEM_LANES_ENTRIES];
      double expected[144];
      all[k]->force(&material, &eight.lanes, eight.x, force);
      all[k]->matrix(&material, &eight.lanes, eight.x, 1, matrix);
      reference_element_force(&eight.element[3], &material, eight.x + 36, expected);
      check_forces(force, 3, expected, 1e-14, all[k]->name);
      reference_element_stiffness(&eight.element[3], &material, eight.x + 36, expected);
      check_matrix(matrix, 3, expected, 1e-14, all[k]->name);
    }
  }
}
END_TEST

START_TEST(what_is_not_finite_stays_in_its_lane) {
  FemMaterial material = material_of(_i);
  int count;
  const FemLanes *const *all = fem_lanes_list(&count);
  Random random = random_seeded(76, 0);
  Eight eight = eight_random(&random, 0.1), bad = eight;
  bad.x[12 * 2 + 7] = NAN;
  for (int k = 0; k < count; k++) {
    FemLanesRow force[2][12];
    all[k]->force(&material, &eight.lanes, eight.x, force[0]);
    all[k]->force(&material, &eight.lanes, bad.x, force[1]);
    bool is_finite = true;
    for (int r = 0; r < 12; r++)
      for (int l = 0; l < FEM_LANES; l++) {
        if (l == 2)
          is_finite = is_finite && isfinite(force[1][r][l]);
        else
          ck_assert(force[0][r][l] == force[1][r][l]);
      }
    ck_assert(!is_finite);
  }
}
END_TEST

static bool has_density_two(const FemModelPart *part) {
  return part->material.density == 2;
}

// Two boxes and an obstacle with a mesh; the second box is taken by has_density_two.
typedef struct Scene {
  FemSceneDef def;
  FemBodyDef bodies[2];
  FemObstacleDef obstacle;
  FemModel model;
} Scene;

static void build(Scene *scene) {
  static char names[2][8] = {"one", "two"};
  *scene = (Scene){0};
  for (int b = 0; b < 2; b++) {
    scene->bodies[b] = (FemBodyDef){
        .name = names[b],
        .box_size = {1, 1, 1},
        .box_cells = {7, 6, 5},
        .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
        .material = {.law = FEM_MATERIAL_STVK, .young = 1, .poisson = 0.3, .density = b + 1, .damping = -1}};
    scene->bodies[b].placement.translate[0] = 2 * b;
  }
  scene->obstacle = (FemObstacleDef){.name = "wall",
                                     .box_size = {1, 1, 1},
                                     .box_cells = {1, 1, 1},
                                     .placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}},
                                     .motion = {.components = {true, true, true}, .until = INFINITY}};
  scene->obstacle.placement.translate[0] = 4;
  scene->def = (FemSceneDef){
      .bodies = scene->bodies, .body_count = 2, .obstacles = &scene->obstacle, .obstacle_count = 1};
  ck_assert_ok(fem_model_create(&scene->model, &scene->def));
}

// Every element of the bodies once, in chunks that share no vertex within a colour.
static void check_packs(const FemPacks *packs, const FemModel *model, int begin, int end) {
  int *seen = memory_zeroed((size_t)model->tet_count, sizeof *seen), total = 0;
  int *chunk_of = memory_zeroed((size_t)model->vertex_count, sizeof *chunk_of);
  for (int colour = 0; colour < packs->colour_count; colour++) {
    for (int v = 0; v < model->vertex_count; v++) chunk_of[v] = -1;
    for (int c = packs->colour_begin[colour]; c < packs->colour_begin[colour + 1]; c++)
      for (int p = packs->chunk_begin[c]; p < packs->chunk_begin[c + 1]; p++)
        for (int l = 0; l < packs->packs[p].count; l++, total++) {
          const FemLanesElements *pack = &packs->packs[p];
          ck_assert_int_eq(seen[pack->tet[l]]++, 0);
          ck_assert_int_eq(model->tet_part[pack->tet[l]], packs->chunk_part[c]);
          for (int a = 0; a < 4; a++) {
            int v = pack->node[a][l];
            ck_assert(a == 0 || v > pack->node[a - 1][l]);
            ck_assert(chunk_of[v] < 0 || chunk_of[v] == c);
            chunk_of[v] = c;
          }
        }
  }
  ck_assert_int_eq(total, packs->element_count);
  for (int tet = 0; tet < model->tet_count; tet++) ck_assert_int_eq(seen[tet], tet >= begin && tet < end);
  memory_free(seen), memory_free(chunk_of);
}

START_TEST(packs_hold_each_element_of_bodies_once_and_colours_share_no_vertex) {
  Scene scene;
  FemPacks packs;
  build(&scene);
  ck_assert_ok(fem_packs_create(&packs, &scene.model, false, NULL));
  ck_assert_int_gt(packs.chunk_count, 2);
  check_packs(&packs, &scene.model, 0, scene.model.bodies[1].tet_end);
  fem_packs_destroy(&packs);
  ck_assert_ok(fem_packs_create(&packs, &scene.model, false, has_density_two));
  check_packs(&packs, &scene.model, scene.model.bodies[1].tet_begin, scene.model.bodies[1].tet_end);
  fem_packs_destroy(&packs);
  fem_model_destroy(&scene.model);
}
END_TEST

START_TEST(packs_of_the_same_elements_are_held_once) {
  Scene scene;
  FemAssembly all, same, fewer;
  build(&scene);
  ck_assert_ok(fem_assembly_create(&all, &scene.model, NULL));
  ck_assert_ok(fem_assembly_create(&same, &scene.model, NULL));
  ck_assert_ok(fem_assembly_create(&fewer, &scene.model, has_density_two));
  size_t before = fem_assembly_bytes(&same);
  fem_assembly_borrow(&same, &all);
  fem_assembly_borrow(&fewer, &all);
  ck_assert_ptr_eq(same.packs, all.packs);
  ck_assert_uint_lt(4 * fem_assembly_bytes(&same), before);
  ck_assert_ptr_eq(fewer.packs, fewer.own);
  ck_assert_int_lt(fewer.packs[0].element_count, all.packs[0].element_count);
  fem_assembly_destroy(&fewer), fem_assembly_destroy(&same), fem_assembly_destroy(&all);
  fem_model_destroy(&scene.model);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("lanes");
  tcase_add_loop_test(cases, elastic_forces_and_matrices_are_those_of_single_elements, 0, MATERIALS);
  tcase_add_loop_test(cases, damping_forces_and_matrices_are_those_of_single_elements, 0, MATERIALS);
  tcase_add_loop_test(cases, a_lane_hangs_on_its_element_alone, 0, MATERIALS);
  tcase_add_loop_test(cases, deformations_of_every_kind_are_those_of_single_elements, 0, MATERIALS);
  tcase_add_loop_test(cases, what_is_not_finite_stays_in_its_lane, 0, MATERIALS);
  tcase_add_test(cases, packs_hold_each_element_of_bodies_once_and_colours_share_no_vertex);
  tcase_add_test(cases, packs_of_the_same_elements_are_held_once);
  return suite_run("lanes", cases, 20);
}
