// SPDX-License-Identifier: GPL-3.0-or-later
// fem/element: the linear tetrahedron against its own energy, rigid motion, and the patch test.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "reference/element.h"

enum { SAMPLES = 50 };

static const double unit_tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static FemMaterial make_material(int law) {
  return (FemMaterial){.law = (FemMaterialLaw)law,
                       .young = 1.3,
                       .poisson = 0.37,
                       .density = 1000,
                       .mooney = 0.3,
                       .exponents = {1.8, 1.3, 4},
                       .shares = {0.6, 0.3, 0.1}};
}

// A tetrahedron that is not too flat, somewhere near the origin.
static void draw_tet(Random *random, double rest[12], FemElement *element) {
  do {
    for (int r = 0; r < 12; r++) rest[r] = random_between(random, -1, 1);
    fem_element_create(element, rest);
  } while (!(element->volume > 0.05));
}

static void move_by(const double rest[12], double size, Random *random, double x[12]) {
  for (int r = 0; r < 12; r++) x[r] = rest[r] + size * suite_normal(random);
}

// x = Q rest + shift.
static void place(const double rest[12], const double Q[9], const double shift[3], double x[12]) {
  for (int a = 0; a < 12; a += 3)
    for (int i = 0; i < 3; i++)
      x[a + i] = Q[3 * i] * rest[a] + Q[3 * i + 1] * rest[a + 1] + Q[3 * i + 2] * rest[a + 2] + shift[i];
}

// v = velocity + spin × x.
static void spin_about(const double x[12], const double velocity[3], const double spin[3], double v[12]) {
  for (int a = 0; a < 12; a += 3)
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      v[a + i] = velocity[i] + spin[j] * x[a + k] - spin[k] * x[a + j];
    }
}

static double dot12(const double a[12], const double b[12]) {
  double sum = 0;
  for (int r = 0; r < 12; r++) sum += a[r] * b[r];
  return sum;
}

static double largest_entry(const double *values, int count) {
  double largest = 0;
  for (int r = 0; r < count; r++) largest = fmax(largest, fabs(values[r]));
  return largest;
}

static void check_balance(const double x[12], const double force[12], double tolerance) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double sum = 0, torque = 0;
    for (int a = 0; a < 12; a += 3) {
      sum += force[a + i];
      torque += x[a + j] * force[a + k] - x[a + k] * force[a + j];
    }
    ck_assert_near(sum, 0, tolerance);
    ck_assert_near(torque, 0, tolerance);
  }
}

static void check_symmetric(const double matrix[144]) {
  for (int r = 0; r < 12; r++)
    for (int c = 0; c < r; c++) ck_assert_double_eq(matrix[12 * r + c], matrix[12 * c + r]);
}

// Fourth-order central difference from values at ±h, ±2h.
static double differentiate(const double values[4], double h) {
  return (8 * (values[0] - values[1]) - (values[2] - values[3])) / (12 * h);
}
static const double steps[4] = {1, -1, 2, -2};
static const double h = 2e-4;

static void check_force(const FemElement *element, const FemMaterial *material, const double x[12],
                        const double force[12]) {
  double moved[12], energy[4];
  for (int r = 0; r < 12; r++) {
    for (int s = 0; s < 4; s++) {
      memcpy(moved, x, sizeof moved);
      moved[r] += steps[s] * h;
      energy[s] = reference_element_energy(element, material, moved);
    }
    ck_assert_near(force[r], -differentiate(energy, h), 1e-8 * fmax(1, 0.1 * fabs(force[r])));
  }
}

START_TEST(the_unit_tetrahedron_has_volume_one_sixth_and_unit_gradients) {
  static const double gradients[4][3] = {{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  FemElement element;
  fem_element_create(&element, unit_tet);
  ck_assert_near(element.volume, 1.0 / 6, 1e-16);
  for (int a = 0; a < 4; a++)
    for (int i = 0; i < 3; i++) ck_assert_double_eq(element.gradient[a][i], gradients[a][i]);
}
END_TEST

START_TEST(a_linear_map_is_its_own_deformation_far_from_the_origin_too) {
  Random random = random_seeded(41, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], F[9], A[9];
    FemElement element;
    draw_tet(&random, rest, &element);
    for (int r = 0; r < 9; r++) A[r] = suite_normal(&random);
    place(rest, A, (const double[3]){3, 4, 5}, x);
    fem_element_deformation(&element, x, F);
    for (int r = 0; r < 9; r++) ck_assert_near(F[r], A[r], 1e-12);
    // 1e6 away positions have lost 1e-10 of their digits, and no more than that may reach F.
    place(rest, A, (const double[3]){1e6, -1e6, 1e6}, x);
    fem_element_deformation(&element, x, F);
    for (int r = 0; r < 9; r++) ck_assert_near(F[r], A[r], 1e-8);
  }
}
END_TEST

START_TEST(a_pulled_unit_tetrahedron_has_the_forces_of_its_faces) {
  FemMaterial material = make_material(FEM_MATERIAL_LINEAR);
  FemElement element;
  fem_element_create(&element, unit_tet);
  double e = 0.01, side = 1 - material.poisson * e, force[12];
  double x[12] = {0, 0, 0, 1 + e, 0, 0, 0, side, 0, 0, 0, side};
  reference_element_force(&element, &material, x, force);
  // Uniaxial stress E e on faces of projected area ½, a third to each vertex: node 1 bears E e / 6.
  ck_assert_near(force[3], -material.young * e / 6, 1e-16);
  ck_assert_near(force[0], material.young * e / 6, 1e-16);
  for (int r = 0; r < 12; r++)
    if (r != 0 && r != 3) ck_assert_near(force[r], 0, 1e-16);
}
END_TEST

START_TEST(force_is_minus_the_derivative_of_energy) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(42, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], force[12];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.1, &random, x);
    reference_element_force(&element, &material, x, force);
    check_force(&element, &material, x, force);
  }
}
END_TEST

START_TEST(stiffness_is_minus_the_derivative_of_force_and_symmetric) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(43, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], moved[12], force[4][12], stiffness[144];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.1, &random, x);
    reference_element_stiffness(&element, &material, x, stiffness);
    check_symmetric(stiffness);
    double scale = fmax(1, largest_entry(stiffness, 144));
    for (int c = 0; c < 12; c++) {
      for (int s = 0; s < 4; s++) {
        memcpy(moved, x, sizeof moved);
        moved[c] += steps[s] * h;
        reference_element_force(&element, &material, moved, force[s]);
      }
      for (int r = 0; r < 12; r++) {
        double values[4] = {force[0][r], force[1][r], force[2][r], force[3][r]};
        ck_assert_near(stiffness[12 * r + c], -differentiate(values, h), 2e-8 * scale);
      }
    }
  }
}
END_TEST

START_TEST(inverted_elements_have_finite_values_and_consistent_derivatives) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(44, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double x[12], force[12], stiffness[144];
    FemElement element;
    fem_element_create(&element, unit_tet);
    move_by(unit_tet, 0.02, &random, x);
    x[11] = -0.3; // the fourth vertex pushed through the opposite face
    reference_element_force(&element, &material, x, force);
    reference_element_stiffness(&element, &material, x, stiffness);
    for (int r = 0; r < 144; r++) ck_assert(isfinite(stiffness[r]));
    check_force(&element, &material, x, force);
  }
}
END_TEST

START_TEST(rigid_motion_gives_no_force_and_no_damping) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(45, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], v[12], Q[9], force[12];
    FemElement element;
    draw_tet(&random, rest, &element);
    random_rotation(&random, Q);
    place(rest, Q, (const double[3]){1, 2, 3}, x);
    reference_element_force(&element, &material, x, force);
    if (_i != FEM_MATERIAL_LINEAR)
      for (int r = 0; r < 12; r++) ck_assert_near(force[r], 0, 1e-13);
    spin_about(x, (const double[3]){3, -1, 2}, (const double[3]){0.4, -2, 1}, v);
    reference_element_damping_force(&element, &material, 0.7, x, v, force);
    for (int r = 0; r < 12; r++) ck_assert_near(force[r], 0, 1e-13);
  }
}
END_TEST

START_TEST(rigid_spin_of_a_deformed_element_is_not_damped) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN);
  Random random = random_seeded(46, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], v[12], force[12];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.3, &random, x);
    spin_about(x, (const double[3]){3, -1, 2}, (const double[3]){0.4, -2, 1}, v);
    reference_element_damping_force(&element, &material, 0.7, x, v, force);
    for (int r = 0; r < 12; r++) ck_assert_near(force[r], 0, 1e-11);
  }
}
END_TEST

START_TEST(forces_and_torques_of_an_element_balance) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(47, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], v[12], force[12];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.3, &random, x);
    for (int r = 0; r < 12; r++) v[r] = suite_normal(&random);
    reference_element_force(&element, &material, x, force);
    check_balance(x, force, 1e-12 * fmax(1, largest_entry(force, 12)));
    reference_element_damping_force(&element, &material, 0.7, x, v, force);
    check_balance(x, force, 1e-12 * fmax(1, largest_entry(force, 12)));
  }
}
END_TEST

START_TEST(at_rest_damping_is_beta_times_stiffness) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(48, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], damping[144], stiffness[144], beta = 0.03;
    FemElement element;
    draw_tet(&random, rest, &element);
    reference_element_damping_matrix(&element, &material, beta, rest, damping);
    reference_element_stiffness(&element, &material, rest, stiffness);
    check_symmetric(damping);
    for (int r = 0; r < 144; r++) ck_assert_near(damping[r], beta * stiffness[r], 1e-12);
  }
}
END_TEST

// The force is linear in v, so the matrix gives it exactly; the power is never negative.
START_TEST(damping_force_and_matrix_agree) {
  FemMaterial material = make_material(_i);
  Random random = random_seeded(49, 0);
  for (int k = 0; k < 20 * SAMPLES; k++) {
    double rest[12], x[12], v[12], force[12], matrix[144];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.5, &random, x);
    for (int r = 0; r < 12; r++) v[r] = suite_normal(&random);
    reference_element_damping_force(&element, &material, 0.7, x, v, force);
    reference_element_damping_matrix(&element, &material, 0.7, x, matrix);
    double scale = fmax(1, largest_entry(matrix, 144));
    for (int r = 0; r < 12; r++) ck_assert_near(force[r], -dot12(matrix + 12 * r, v), 1e-13 * scale);
    ck_assert_double_lt(dot12(force, v), 0);
  }
}
END_TEST

// Left out of −∂(damping force)/∂x is what no turning or moving body's forces answer: with φ such a motion,
// φ · matrix must be φ · derivative.
START_TEST(damping_stiffness_has_the_derivative_of_forces_that_turn_or_move_a_body) {
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  Random random = random_seeded(50, 0);
  for (int k = 0; k < SAMPLES; k++) {
    double rest[12], x[12], v[12], moved[12], force[4][12], matrix[144], turned[6][12];
    FemElement element;
    draw_tet(&random, rest, &element);
    move_by(rest, 0.2, &random, x);
    for (int r = 0; r < 12; r++) v[r] = suite_normal(&random);
    reference_element_damping_stiffness(&element, &material, 0.7, x, v, matrix);
    check_symmetric(matrix);
    memset(turned, 0, sizeof turned);
    for (int a = 0; a < 4; a++)
      for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        turned[axis][3 * a + last] = x[3 * a + next], turned[axis][3 * a + next] = -x[3 * a + last];
        turned[3 + axis][3 * a + axis] = 1;
      }
    double largest = 0;
    for (int c = 0; c < 12; c++) {
      for (int s = 0; s < 4; s++) {
        memcpy(moved, x, sizeof moved);
        moved[c] += steps[s] * h;
        reference_element_damping_force(&element, &material, 0.7, moved, v, force[s]);
      }
      for (int m = 0; m < 6; m++) {
        double values[4];
        for (int s = 0; s < 4; s++) values[s] = dot12(turned[m], force[s]);
        double expected = -differentiate(values, h), found = dot12(turned[m], matrix + 12 * c);
        largest = fmax(largest, fabs(expected));
        ck_assert_near(found, expected, 1e-8 * fmax(1, largest_entry(matrix, 144)));
      }
    }
    ck_assert_double_gt(largest, 1e-3 * largest_entry(matrix, 144));
  }
}
END_TEST

// A cube with its corners moved about and one vertex inside, that is twelve tetrahedra: two on each face's
// triangles, joined to the inner vertex.
enum { PATCH_VERTICES = 9, PATCH_TETS = 12, PATCH_INNER = 8 };
static const double patch_rest[3 * PATCH_VERTICES] = {
    0,    0,    0,     1.1,  0.05, -0.1, 1.0, 1.2,  0.1,  -0.1, 0.9, 0,    0.1,  0,
    0.95, 0.95, -0.05, 1.05, 1.05, 1,    1.1, 0.05, 1.05, 0.9,  0.4, 0.55, 0.62,
};
static const int patch_faces[PATCH_TETS][3] = {
    {0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}, {0, 5, 1}, {0, 4, 5},
    {1, 6, 2}, {1, 5, 6}, {2, 7, 3}, {2, 6, 7}, {3, 4, 0}, {3, 7, 4},
};

static void gather_patch(const double *positions, int tet, int vertices[4], double x[12]) {
  for (int a = 0; a < 3; a++) vertices[a] = patch_faces[tet][a];
  vertices[3] = PATCH_INNER;
  for (int a = 0; a < 4; a++) memcpy(x + 3 * a, positions + 3 * vertices[a], 3 * sizeof *x);
}

// Patch test (Irons): under x = A X the irregular patch carries one and the same stress everywhere, and the
// inner vertex bears no force.
START_TEST(a_patch_of_elements_carries_uniform_stress) {
  FemMaterial material = make_material(_i);
  static const double A[9] = {1.05, 0.02, -0.03, 0.01, 0.97, 0.04, 0.05, -0.02, 1.02};
  double positions[3 * PATCH_VERTICES], forces[3 * PATCH_VERTICES] = {0}, P[9], volume = 0;
  for (int v = 0; v < 3 * PATCH_VERTICES; v += 3)
    for (int i = 0; i < 3; i++)
      positions[v + i] =
          A[3 * i] * patch_rest[v] + A[3 * i + 1] * patch_rest[v + 1] + A[3 * i + 2] * patch_rest[v + 2];
  fem_material_stress(&material, A, P);
  double J = A[0] * (A[4] * A[8] - A[5] * A[7]) - A[1] * (A[3] * A[8] - A[5] * A[6]) +
             A[2] * (A[3] * A[7] - A[4] * A[6]);
  for (int t = 0; t < PATCH_TETS; t++) {
    int vertices[4];
    double rest[12], x[12], force[12], stress[6];
    FemElement element;
    gather_patch(patch_rest, t, vertices, rest);
    gather_patch(positions, t, vertices, x);
    fem_element_create(&element, rest);
    ck_assert(element.volume > 0);
    volume += element.volume;
    reference_element_force(&element, &material, x, force);
    for (int r = 0; r < 12; r++) forces[3 * vertices[r / 3] + r % 3] += force[r];
    fem_element_cauchy(&element, &material, x, stress);
    for (int s = 0; s < 6; s++) {
      static const int rows[6] = {0, 1, 2, 0, 1, 0}, columns[6] = {0, 1, 2, 1, 2, 2};
      const double *p = P + 3 * rows[s], *f = A + 3 * columns[s];
      double expected =
          _i == FEM_MATERIAL_LINEAR ? p[columns[s]] : (p[0] * f[0] + p[1] * f[1] + p[2] * f[2]) / J;
      ck_assert_near(stress[s], expected, 1e-14);
    }
  }
  ck_assert(volume > 0.8 && volume < 1.2);
  double largest = largest_entry(forces, 3 * PATCH_INNER);
  ck_assert(largest > 1e-3);
  for (int i = 0; i < 3; i++) ck_assert_near(forces[3 * PATCH_INNER + i], 0, 1e-13 * largest);
  // The corners' forces do the work of the stress: Σ f_i X_j = −V P_ij.
  for (int r = 0; r < 9; r++) {
    double moment = 0;
    for (int v = 0; v < PATCH_VERTICES; v++) moment += forces[3 * v + r / 3] * patch_rest[3 * v + r % 3];
    ck_assert_near(moment, -volume * P[r], 1e-13);
  }
}
END_TEST

START_TEST(cauchy_stress_of_simple_states) {
  FemElement element;
  fem_element_create(&element, unit_tet);
  double stress[6], l = 1.3;
  FemMaterial material = make_material(FEM_MATERIAL_STVK);
  double side = sqrt(1 - material.poisson * (l * l - 1));
  double pulled[12] = {0, 0, 0, 0, l, 0, -side, 0, 0, 0, 0, side}; // along y: pulled along x, turned
  fem_element_cauchy(&element, &material, pulled, stress);
  // Force l E (l² − 1)/2 per rest area over the present area side².
  ck_assert_near(stress[1], l * material.young * (l * l - 1) / 2 / (side * side), 1e-14);
  for (int s = 0; s < 6; s++)
    if (s != 1) ck_assert_near(stress[s], 0, 1e-14);
}
END_TEST

START_TEST(a_flat_element_has_no_cauchy_stress) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN);
  FemElement element;
  fem_element_create(&element, unit_tet);
  double stress[6];
  fem_element_cauchy(&element, &material, (const double[12]){0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, stress);
  for (int s = 0; s < 6; s++) ck_assert_double_eq(stress[s], 0);
}
END_TEST

// η = β μ and ζ = β K, the bulk modulus, are what β gives.
START_TEST(viscosities_are_the_lame_parameters_of_damping) {
  Random random = random_seeded(9, 0);
  FemMaterial plain = make_material(FEM_MATERIAL_NEO_HOOKEAN), viscous = plain;
  FemLame lame = fem_material_lame(&plain);
  viscous.viscosity = 0.7 * lame.mu;
  viscous.bulk_viscosity = 0.7 * (lame.lambda + 2.0 / 3 * lame.mu);
  FemElement element;
  static const double rest[12] = {0, 0, 0, 1, 0, 0, 0.2, 1, 0, 0.1, 0.3, 1};
  fem_element_create(&element, rest);
  double x[12], v[12], force[2][12];
  for (int r = 0; r < 12; r++) x[r] = rest[r] + 0.1 * suite_normal(&random), v[r] = suite_normal(&random);
  reference_element_damping_force(&element, &plain, 0.7, x, v, force[0]);
  reference_element_damping_force(&element, &viscous, 0, x, v, force[1]);
  for (int r = 0; r < 12; r++) ck_assert_near(force[0][r], force[1][r], 1e-14);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("element");
  tcase_add_test(cases, the_unit_tetrahedron_has_volume_one_sixth_and_unit_gradients);
  tcase_add_test(cases, a_linear_map_is_its_own_deformation_far_from_the_origin_too);
  tcase_add_test(cases, a_pulled_unit_tetrahedron_has_the_forces_of_its_faces);
  tcase_add_loop_test(cases, force_is_minus_the_derivative_of_energy, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, stiffness_is_minus_the_derivative_of_force_and_symmetric, 0,
                      FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, inverted_elements_have_finite_values_and_consistent_derivatives, 0,
                      FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, rigid_motion_gives_no_force_and_no_damping, 1, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, rigid_spin_of_a_deformed_element_is_not_damped);
  tcase_add_loop_test(cases, forces_and_torques_of_an_element_balance, 1, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, at_rest_damping_is_beta_times_stiffness, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_loop_test(cases, damping_force_and_matrix_agree, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, damping_stiffness_has_the_derivative_of_forces_that_turn_or_move_a_body);
  tcase_add_loop_test(cases, a_patch_of_elements_carries_uniform_stress, 0, FEM_MATERIAL_LAW_COUNT);
  tcase_add_test(cases, cauchy_stress_of_simple_states);
  tcase_add_test(cases, a_flat_element_has_no_cauchy_stress);
  tcase_add_test(cases, viscosities_are_the_lame_parameters_of_damping);
  return suite_run("element", cases, 20);
}
