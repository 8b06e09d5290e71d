// SPDX-License-Identifier: GPL-3.0-or-later
// fem/element/quadratic.h, its faces and its mesh: energies a hand can compute, derivatives, rigid motion,
// patch tests.
#include "suite.h"

#include <string.h>

#include "base/random.h"
#include "base/vec3.h"
#include "fem/element/quadratic_face.h"
#include "fem/mesh/from_arrays.h"
#include "fem/mesh/mesh.h"
#include "fem/scene/load.h"
#include "reference/element.h"
#include "reference/material.h"

static const double corners[12] = {0.1, -0.2, 0, 1.2, 0.1, -0.1, 0.2, 0.9, 0.1, -0.1, 0.2, 1.1};
static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

// Cases beyond LAWS are the same laws with a part of λ by the mean volume change.
enum { LAWS = FEM_MATERIAL_LAW_COUNT };

static FemMaterial make_material(int law) {
  return (FemMaterial){.law = (FemMaterialLaw)law,
                       .young = 1.3,
                       .poisson = 0.3,
                       .density = 1000,
                       .mooney = 0.3,
                       .exponents = {1.8, 1.3, 4},
                       .shares = {0.6, 0.3, 0.1},
                       .viscosity = 0.2,
                       .bulk_viscosity = 0.1};
}

static void place_nodes(const double at[12], double x[30]) {
  memcpy(x, at, 12 * sizeof *x);
  for (int k = 0; k < 6; k++)
    for (int c = 0; c < 3; c++)
      x[12 + 3 * k + c] =
          0.5 * (at[3 * fem_quadratic_edges[k][0] + c] + at[3 * fem_quadratic_edges[k][1] + c]);
}

static void draw_around(Random *random, const double rest[30], double size, double x[30]) {
  for (int r = 0; r < 30; r++) x[r] = rest[r] + size * suite_normal(random);
}

static void map(const double F[9], const double *X, double *x) {
  for (int i = 0; i < 3; i++) x[i] = F[3 * i] * X[0] + F[3 * i + 1] * X[1] + F[3 * i + 2] * X[2];
}

START_TEST(gradients_of_shape_functions_reproduce_quadratic_fields) {
  FemQuadratic element;
  double X[30], volume = 0;
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  for (int p = 0; p < FEM_QUADRATIC_POINTS; p++) {
    FemPoint point = fem_quadratic_point(&element, p);
    double at[3] = {0}, far = (5 - sqrt(5)) / 20;
    for (int a = 0; a < 4; a++)
      for (int c = 0; c < 3; c++) at[c] += (a == p ? 1 - 3 * far : far) * corners[3 * a + c];
    double gradient[3] = {0}, sum[3] = {0};
    for (int a = 0; a < 10; a++) {
      const double *Y = X + 3 * a;
      double value = 2 + Y[0] - 3 * Y[0] * Y[1] + 4 * Y[2] * Y[2] + Y[1] * Y[2];
      for (int c = 0; c < 3; c++) gradient[c] += value * point.gradient[a][c], sum[c] += point.gradient[a][c];
    }
    ck_assert_near(gradient[0], 1 - 3 * at[1], 1e-13);
    ck_assert_near(gradient[1], -3 * at[0] + at[2], 1e-13);
    ck_assert_near(gradient[2], 8 * at[2] + at[1], 1e-13);
    for (int c = 0; c < 3; c++) ck_assert_near(sum[c], 0, 1e-14);
    volume += point.weight;
  }
  ck_assert_near(volume, element.volume, 1e-15);
}
END_TEST

// The linear law's energy density of u = quadratic in X is quadratic: 1/20 at each corner + 4/5 at the
// centroid integrates it exactly, another rule than the element's. Bending, twist and stretch.
START_TEST(a_quadratic_displacement_has_its_exact_energy) {
  FemMaterial material = make_material(FEM_MATERIAL_LINEAR);
  FemQuadratic element;
  double X[30], x[30], exact = 0;
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  for (int a = 0; a < 10; a++) {
    const double *Y = X + 3 * a;
    x[3 * a] = Y[0] - 0.3 * Y[0] * Y[2] + 0.1 * Y[1] * Y[2];
    x[3 * a + 1] = Y[1] + 0.2 * Y[1] * Y[2] - 0.1 * Y[0] * Y[2];
    x[3 * a + 2] = Y[2] + 0.15 * (Y[0] * Y[0] - Y[1] * Y[1]) + 0.1 * Y[2] * Y[2];
  }
  for (int q = 0; q < 5; q++) {
    double Y[3] = {0};
    for (int a = 0; a < 4; a++)
      for (int c = 0; c < 3; c++) Y[c] += (q == 4 ? 0.25 : a == q) * corners[3 * a + c];
    double F[9] = {1 - 0.3 * Y[2],  0.1 * Y[2],     -0.3 * Y[0] + 0.1 * Y[1],
                   -0.1 * Y[2],     1 + 0.2 * Y[2], 0.2 * Y[1] - 0.1 * Y[0],
                   2 * 0.15 * Y[0], -0.3 * Y[1],    1 + 0.2 * Y[2]};
    exact += (q == 4 ? 0.8 : 0.05) * element.volume * reference_energy(&material, F);
  }
  ck_assert(exact > 1e-3);
  ck_assert_near(reference_quadratic_energy(&element, (FemQuadraticLaw){&material, 0}, x), exact, 1e-14);
}
END_TEST

// Central differences of smooth energies of size 1: h² and rounding 1e-16/h give 1e-9 together.
START_TEST(force_and_stiffness_are_derivatives) {
  FemMaterial material = make_material(_i % LAWS);
  FemQuadraticLaw law = {&material, _i < LAWS ? 0 : 3};
  FemQuadratic element;
  Random random = random_seeded(5, (uint64_t)_i);
  double X[30], x[30], force[30], K[900], above[30], below[30], h = 1e-5;
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  draw_around(&random, X, 0.05, x);
  reference_quadratic_force(&element, law, x, force);
  reference_quadratic_stiffness(&element, law, x, K);
  double net[3] = {0}, torque[3] = {0};
  for (int r = 0; r < 30; r++) {
    double here = x[r];
    x[r] = here + h;
    double high = reference_quadratic_energy(&element, law, x);
    reference_quadratic_force(&element, law, x, above);
    x[r] = here - h;
    double low = reference_quadratic_energy(&element, law, x);
    reference_quadratic_force(&element, law, x, below);
    x[r] = here;
    ck_assert_near(force[r], -(high - low) / (2 * h), 1e-8);
    for (int c = 0; c < 30; c++) {
      ck_assert_near(K[30 * r + c], -(above[c] - below[c]) / (2 * h), 1e-7);
      ck_assert(K[30 * r + c] == K[30 * c + r]);
    }
    net[r % 3] += force[r];
    torque[r % 3] += x[r - r % 3 + (r + 1) % 3] * force[r - r % 3 + (r + 2) % 3] -
                     x[r - r % 3 + (r + 2) % 3] * force[r - r % 3 + (r + 1) % 3];
  }
  for (int c = 0; c < 3; c++) ck_assert_near(net[c], 0, 1e-15);
  for (int c = 0; c < 3 && material.law != FEM_MATERIAL_LINEAR; c++) ck_assert_near(torque[c], 0, 1e-14);
}
END_TEST

START_TEST(turned_inside_out_it_stays_finite_with_the_same_derivatives) {
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN);
  FemQuadraticLaw law = {&material, 3};
  FemQuadratic element;
  double X[30], x[30], force[30], h = 1e-5;
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  for (int r = 0; r < 30; r++) x[r] = r % 3 == 0 ? -X[r] : X[r] + 0.03 * sin(r);
  ck_assert(fem_quadratic_det(&element, 0, x) < 0);
  reference_quadratic_force(&element, law, x, force);
  for (int r = 0; r < 30; r++) {
    double here = x[r];
    x[r] = here + h;
    double high = reference_quadratic_energy(&element, law, x);
    x[r] = here - h;
    double low = reference_quadratic_energy(&element, law, x);
    x[r] = here;
    ck_assert_near(force[r], -(high - low) / (2 * h), 1e-7);
  }
}
END_TEST

// The rank of a symmetric matrix by elimination with the largest entry as pivot.
static int rank_of(double A[900], double relative) {
  double first = 0;
  int rank = 0;
  bool row_used[30] = {false};
  for (; rank < 30; rank++) {
    int pr = -1, pc = -1;
    double largest = 0;
    for (int r = 0; r < 30; r++)
      for (int c = 0; c < 30 && !row_used[r]; c++)
        if (fabs(A[30 * r + c]) > largest) largest = fabs(A[30 * r + c]), pr = r, pc = c;
    if (rank == 0) first = largest;
    if (!(largest > relative * first)) break;
    row_used[pr] = true;
    for (int r = 0; r < 30; r++) {
      if (row_used[r]) continue;
      double factor = A[30 * r + pc] / A[30 * pr + pc];
      for (int c = 0; c < 30; c++) A[30 * r + c] -= factor * A[30 * pr + c];
    }
  }
  return rank;
}

// No hourglass: 30 − 6. The smallest pivot is far above rounding.
START_TEST(only_rigid_motions_cost_no_energy) {
  FemMaterial material = make_material(_i % LAWS);
  FemQuadratic element;
  double X[30], K[900];
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  reference_quadratic_stiffness(&element, (FemQuadraticLaw){&material, _i < LAWS ? 0 : 100}, X, K);
  ck_assert_int_eq(rank_of(K, 1e-10), 24);
}
END_TEST

START_TEST(rigid_motion_gives_no_force_and_no_damping) {
  FemMaterial material = make_material(_i);
  FemQuadratic element;
  double X[30], x[30], v[30], force[30], c = cos(1.1), s = sin(1.1);
  const double Q[9] = {c, -s, 0, s, c, 0, 0, 0, 1};
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  for (int a = 0; a < 10; a++) {
    map(material.law == FEM_MATERIAL_LINEAR ? identity : Q, X + 3 * a, x + 3 * a);
    x[3 * a] += 100;
    const double spin[3] = {-x[3 * a + 1], x[3 * a] - 100, 0};
    for (int i = 0; i < 3; i++) v[3 * a + i] = 2 + spin[i];
  }
  reference_quadratic_force(&element, (FemQuadraticLaw){&material, 5}, x, force);
  for (int r = 0; r < 30; r++) ck_assert_near(force[r], 0, 1e-12);
  reference_quadratic_damping_force(&element, &material, 0.3, x, v, force);
  for (int r = 0; r < 30; r++) ck_assert_near(force[r], 0, 1e-12);
}
END_TEST

// Force against the dissipation, matrices against differences of the force. The damping stiffness is the
// geometric part (fem/lanes/viscous.inc): with φ a motion that turns or moves the element, φ · matrix must
// be φ · derivative.
START_TEST(damping_force_power_and_matrices_agree) {
  FemMaterial material = make_material(_i);
  FemQuadratic element;
  Random random = random_seeded(7, (uint64_t)_i);
  double X[30], x[30], v[30], force[30], D[900], K[900], above[30], below[30], slope[900], h = 1e-5,
                                                                                           power = 0;
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  draw_around(&random, X, 0.1, x);
  for (int r = 0; r < 30; r++) v[r] = suite_normal(&random);
  reference_quadratic_damping_force(&element, &material, 0.3, x, v, force);
  reference_quadratic_damping_matrix(&element, &material, 0.3, x, v, 0, 1, D);
  reference_quadratic_damping_matrix(&element, &material, 0.3, x, v, 1, 0, K);
  for (int r = 0; r < 30; r++) {
    double here = v[r], there = x[r];
    power -= force[r] * v[r];
    v[r] = here + h;
    reference_quadratic_damping_force(&element, &material, 0.3, x, v, above);
    v[r] = here - h;
    reference_quadratic_damping_force(&element, &material, 0.3, x, v, below);
    v[r] = here;
    for (int c = 0; c < 30; c++) ck_assert_near(D[30 * r + c], -(above[c] - below[c]) / (2 * h), 1e-8);
    x[r] = there + h;
    reference_quadratic_damping_force(&element, &material, 0.3, x, v, above);
    x[r] = there - h;
    reference_quadratic_damping_force(&element, &material, 0.3, x, v, below);
    x[r] = there;
    for (int c = 0; c < 30; c++) slope[30 * c + r] = -(above[c] - below[c]) / (2 * h);
  }
  for (int axis = 0; axis < 3; axis++)
    for (int c = 0; c < 30; c++) {
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      double turned = 0, moved = 0, expected = 0, none = 0;
      for (int a = 0; a < 10; a++) {
        turned += x[3 * a + next] * K[30 * (3 * a + last) + c] - x[3 * a + last] * K[30 * (3 * a + next) + c];
        expected += x[3 * a + next] * slope[30 * (3 * a + last) + c] -
                    x[3 * a + last] * slope[30 * (3 * a + next) + c];
        moved += K[30 * (3 * a + axis) + c], none += slope[30 * (3 * a + axis) + c];
      }
      ck_assert_near(turned, expected, 1e-7);
      ck_assert_near(moved, none, 1e-7);
      ck_assert_near(K[30 * c + axis], K[30 * axis + c], 1e-13);
    }
  ck_assert(power > 0);
}
END_TEST

START_TEST(stress_of_a_uniform_state_is_the_same_everywhere) {
  const double F[9] = {1.1, 0.05, 0, -0.02, 0.95, 0.03, 0.01, 0, 1.02};
  FemMaterial material = make_material(FEM_MATERIAL_NEO_HOOKEAN),
              whole = fem_material_with_lambda(&material, 2);
  FemQuadratic element;
  double X[30], x[30], P[9], expected[6], stress[6];
  reference_quadratic_create(&element, corners);
  place_nodes(corners, X);
  for (int a = 0; a < 10; a++) map(F, X + 3 * a, x + 3 * a);
  fem_material_stress(&whole, F, P);
  fem_material_cauchy(whole.law, F, P, expected);
  FemQuadraticLaw law = {&material, fem_material_lame(&whole).lambda - fem_material_lame(&material).lambda};
  for (int part = 0; part < FEM_QUADRATIC_PARTS; part++) {
    fem_quadratic_cauchy(&element, law, x, part, stress);
    for (int s = 0; s < 6; s++) ck_assert_near(stress[s], expected[s], 1e-14);
  }
  double J = vec3_dot(vec3_at(F), vec3_cross(vec3_at(F + 3), vec3_at(F + 6)));
  for (int p = 0; p < 4; p++) ck_assert_near(fem_quadratic_det(&element, p, x), J, 1e-14);
}
END_TEST

START_TEST(mass_shares_are_positive_and_whole) {
  double sum = 0;
  for (int a = 0; a < 10; a++) {
    ck_assert(fem_quadratic_mass_share(a) > 0);
    sum += fem_quadratic_mass_share(a);
  }
  ck_assert_near(sum, 1, 1e-15);
  ck_assert_near(fem_quadratic_mass_share(0), 1.0 / 36, 1e-16);
}
END_TEST

// A box of tetrahedra whose inner vertices are off the grid.
static void make_mesh(FemMesh *mesh) {
  const double size[3] = {1, 1, 1};
  const int cells[3] = {2, 3, 2};
  ck_assert_ok(fem_mesh_box(mesh, size, cells));
  Random random = random_seeded(9, 0);
  int moved = 0;
  for (int a = 0; a < mesh->vertex_count; a++) {
    double *X = mesh->rest + 3 * a;
    if (X[0] * (1 - X[0]) * X[1] * (1 - X[1]) * X[2] * (1 - X[2]) < 1e-6) continue;
    for (int c = 0; c < 3; c++) X[c] += 0.06 * suite_normal(&random);
    moved++;
  }
  ck_assert_int_eq(moved, 2);
  ck_assert_ok(fem_mesh_make_quadratic(mesh));
}

START_TEST(a_mesh_made_quadratic_is_cut_into_a_sound_mesh) {
  FemMesh mesh, again;
  FemMeshRepairs repairs;
  FemMeshQuality quality;
  make_mesh(&mesh);
  ck_assert_int_eq(mesh.tet_count, 8 * 72);
  // Sound: nothing to mend, no face with three tetrahedra, one volume, the whole of it.
  ck_assert_ok(mesh_from_arrays(&again, "parts", mesh.vertex_count, mesh.rest, mesh.tet_count, mesh.tets[0],
                                &repairs));
  ck_assert_int_eq(repairs.reoriented_tets + repairs.dropped_vertices, 0);
  ck_assert_ok(fem_mesh_quality(&mesh, &quality));
  ck_assert_near(quality.volume, 1, 1e-14);
  ck_assert_near(quality.surface_area, 6, 1e-13);
  ck_assert_int_eq(quality.component_count, 1);
  ck_assert_int_eq(quality.coincident_vertex_count, 0);
  for (int e = 0; e < mesh.quadratic_count; e++)
    for (int k = 0; k < 4; k++) {
      bool has = false; // part k holds corner k
      for (int m = 0; m < 4; m++) has = has || mesh.tets[8 * e + k][m] == mesh.quadratic[e][k];
      ck_assert(has);
    }
  fem_mesh_destroy(&again);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(groups_take_in_the_middles_of_their_edges_and_no_others) {
  FemMesh mesh;
  make_mesh(&mesh);
  ck_assert_int_eq(mesh.group_count, 6);
  for (int g = 0; g < 6; g++) {
    const FemMeshGroup *group = &mesh.groups[g];
    int next = 0;
    for (int a = 0; a < mesh.vertex_count; a++) {
      bool is_on = mesh.rest[3 * a + g / 2] == g % 2;
      bool is_in = next < group->vertex_count && group->vertices[next] == a;
      ck_assert_int_eq(is_on, is_in);
      next += is_in;
    }
    ck_assert_int_eq(next, group->vertex_count);
  }
  fem_mesh_destroy(&mesh);
}
END_TEST

// A slab one cell thick: a group of its two faces has nothing of what lies between.
START_TEST(a_group_of_two_faces_has_nothing_between_them) {
  const double size[3] = {1, 1, 0.2};
  const int cells[3] = {3, 3, 1};
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, size, cells));
  FemMeshGroup *low = &mesh.groups[4], *high = &mesh.groups[5];
  int *both = realloc(low->vertices, (size_t)(low->vertex_count + high->vertex_count) * sizeof *both);
  memcpy(both + low->vertex_count, high->vertices, (size_t)high->vertex_count * sizeof *both);
  low->vertices = both, low->vertex_count += high->vertex_count;
  // All vertices are in it now, and every tetrahedron; without the top of one corner column it is not so
  // there.
  int kept = 0;
  for (int i = 0; i < low->vertex_count; i++) {
    const double *X = mesh.rest + 3 * both[i];
    bool is_left_out = X[2] == 0.2 && X[0] > 0.5 && X[1] > 0.5;
    if (!is_left_out) both[kept++] = both[i];
  }
  low->vertex_count = kept;
  ck_assert_ok(fem_mesh_make_quadratic(&mesh));
  for (int i = 0; i < low->vertex_count; i++) {
    const double *X = mesh.rest + 3 * low->vertices[i];
    if (X[0] > 0.9 && X[1] > 0.9) ck_assert(X[2] == 0);
  }
  fem_mesh_destroy(&mesh);
}
END_TEST

// x = F X on an irregular mesh: no force inside, on middles as on corners, for every law and split.
START_TEST(a_linear_field_passes_the_patch_test) {
  static const double F[9] = {1.05, 0.02, -0.03, 0.01, 0.97, 0.04, 0.02, 0, 1.02};
  FemMaterial material = make_material(_i % LAWS), whole = material;
  FemQuadraticLaw law = {&material, _i < LAWS ? 0 : 50};
  FemMesh mesh;
  make_mesh(&mesh);
  whole = fem_material_with_lambda(&material, fem_material_lame(&material).lambda + law.bulk);
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *force = calloc(n, sizeof *force), energy = 0, P[9];
  for (int e = 0; e < mesh.quadratic_count; e++) {
    FemQuadratic element;
    double at[12], x[30], own[30];
    for (int k = 0; k < 4; k++) memcpy(at + 3 * k, mesh.rest + 3 * mesh.quadratic[e][k], 3 * sizeof *at);
    for (int k = 0; k < 10; k++) map(F, mesh.rest + 3 * mesh.quadratic[e][k], x + 3 * k);
    reference_quadratic_create(&element, at);
    reference_quadratic_force(&element, law, x, own);
    energy += reference_quadratic_energy(&element, law, x);
    for (int r = 0; r < 30; r++) force[3 * mesh.quadratic[e][r / 3] + r % 3] += own[r];
  }
  ck_assert_near(energy, reference_energy(&whole, F), 1e-12);
  fem_material_stress(&whole, F, P);
  int inside = 0;
  for (int a = 0; a < mesh.vertex_count; a++) {
    const double *X = mesh.rest + 3 * a;
    bool is_inside = true;
    for (int c = 0; c < 3; c++) is_inside = is_inside && X[c] > 1e-9 && X[c] < 1 - 1e-9;
    inside += is_inside;
    for (int c = 0; c < 3 && is_inside; c++) ck_assert_near(force[3 * a + c], 0, 1e-13);
  }
  ck_assert_int_gt(inside, 20);
  // What the surface holds on x = 1 is P e_x.
  for (int c = 0; c < 3; c++) {
    double sum = 0;
    for (int a = 0; a < mesh.vertex_count; a++) sum -= force[3 * a + c] * mesh.rest[3 * a];
    ck_assert_near(sum, P[3 * c], 1e-12);
  }
  free(force);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Loads.

static FemLoad load_on_surface(const FemLoadDef *def, FemMesh *mesh) {
  FemLoad load;
  make_mesh(mesh);
  ck_assert_ok(fem_load_create(&load, def, mesh, 0));
  return load;
}

// Positions of a curved surface near rest.
static double *bend(const FemMesh *mesh, Random *random) {
  size_t n = 3 * (size_t)mesh->vertex_count;
  double *x = malloc(n * sizeof *x);
  for (size_t i = 0; i < n; i++) x[i] = mesh->rest[i] + 0.03 * suite_normal(random);
  return x;
}

// Volume of a quadratic mesh: of each element ∫ det F, of the third degree in the reference coordinates, by
// the exact degree-3 rule of Keast: −4/5 at the centroid, 9/20 at (1/2, 1/6, 1/6, 1/6). Another way than over
// the surface.
static double volume_of(const FemMesh *mesh, const double *x) {
  double sum = 0;
  for (int e = 0; e < mesh->quadratic_count; e++)
    for (int q = 0; q < 5; q++) {
      double L[4], t[3][3] = {{0}};
      for (int a = 0; a < 4; a++) L[a] = q == 4 ? 0.25 : a == q ? 0.5 : 1.0 / 6;
      // Derivatives along L₁, L₂, L₃ at fixed sum 1.
      for (int d = 0; d < 3; d++)
        for (int node = 0; node < 10; node++) {
          double slope;
          if (node < 4) {
            slope = (4 * L[node] - 1) * ((node == d + 1) - (node == 0));
          } else {
            int a = fem_quadratic_edges[node - 4][0], b = fem_quadratic_edges[node - 4][1];
            slope = 4 * (L[a] * ((b == d + 1) - (b == 0)) + L[b] * ((a == d + 1) - (a == 0)));
          }
          for (int c = 0; c < 3; c++) t[d][c] += slope * x[3 * mesh->quadratic[e][node] + c];
        }
      double det = vec3_dot(vec3_at(t[0]), vec3_cross(vec3_at(t[1]), vec3_at(t[2])));
      sum += (q == 4 ? -0.8 : 0.45) * det / 6;
    }
  return sum;
}

START_TEST(a_following_pressure_is_the_gradient_of_the_curved_volume) {
  FemLoadDef def = {.kind = FEM_LOAD_PRESSURE, .pressure = 3};
  FemMesh mesh;
  FemLoad load = load_on_surface(&def, &mesh);
  ck_assert_int_eq(load.triangle_count, 0);
  ck_assert_int_eq(load.face_count, 4 * (2 * 3 + 2 * 2 + 3 * 2));
  Random random = random_seeded(13, 1);
  double *x = bend(&mesh, &random), *force = calloc(3 * (size_t)mesh.vertex_count, sizeof *force), h = 1e-5;
  ck_assert_near(volume_of(&mesh, mesh.rest), 1, 1e-13);
  fem_load_add_force(&load, 2, x, force);
  for (int i = 0; i < 3 * mesh.vertex_count; i++) {
    double here = x[i];
    x[i] = here + h;
    double above = volume_of(&mesh, x);
    x[i] = here - h;
    double below = volume_of(&mesh, x);
    x[i] = here;
    ck_assert_near(force[i], -2 * 3 * (above - below) / (2 * h), 1e-8);
  }
  free(x);
  free(force);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(the_stiffness_of_a_closed_curved_surface_is_exact) {
  FemLoadDef def = {.kind = FEM_LOAD_PRESSURE, .pressure = 3};
  FemMesh mesh;
  FemLoad load = load_on_surface(&def, &mesh);
  Random random = random_seeded(14, 1);
  size_t n = 3 * (size_t)mesh.vertex_count;
  double *x = bend(&mesh, &random), *d = malloc(n * sizeof *d), *product = calloc(n, sizeof *d);
  double *above = calloc(n, sizeof *d), *below = calloc(n, sizeof *d), h = 1e-5;
  for (size_t i = 0; i < n; i++) d[i] = suite_normal(&random);
  for (int k = 0; k < load.face_count; k++) {
    const int *face = load.faces[k];
    double at[18], K[324];
    for (int a = 0; a < 6; a++) memcpy(at + 3 * a, x + 3 * face[a], 3 * sizeof *at);
    fem_quadratic_face_stiffness(3, at, K);
    for (int r = 0; r < 18; r++)
      for (int c = 0; c < 18; c++)
        product[3 * face[r / 3] + r % 3] += K[18 * r + c] * d[3 * face[c / 3] + c % 3];
  }
  for (size_t i = 0; i < n; i++) x[i] += h * d[i];
  fem_load_add_force(&load, 1, x, above);
  for (size_t i = 0; i < n; i++) x[i] -= 2 * h * d[i];
  fem_load_add_force(&load, 1, x, below);
  for (size_t i = 0; i < n; i++) ck_assert_near(product[i], -(above[i] - below[i]) / (2 * h), 1e-8);
  double *all[] = {x, d, product, above, below};
  for (int i = 0; i < 5; i++) free(all[i]);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Totals, and corners of faces that take nothing.
START_TEST(dead_loads_add_up) {
  static const FemLoadKind kinds[] = {FEM_LOAD_TRACTION, FEM_LOAD_BODY_FORCE, FEM_LOAD_FORCE};
  static const double totals[] = {6, 1, 1}; // area, volume, 1
  FemLoadDef def = {.kind = kinds[_i], .vector = {1, -2, 3}};
  FemMesh mesh;
  FemLoad load = load_on_surface(&def, &mesh);
  double *force = calloc(3 * (size_t)mesh.vertex_count, sizeof *force), sum[3] = {0};
  fem_load_add_force(&load, 1, mesh.rest, force);
  for (int i = 0; i < 3 * mesh.vertex_count; i++) sum[i % 3] += force[i];
  for (int c = 0; c < 3; c++) ck_assert_near(sum[c], totals[_i] * def.vector[c], 1e-12);
  for (int e = 0; e < mesh.quadratic_count; e++)
    for (int k = 0; k < 4; k++) {
      double corner = force[3 * mesh.quadratic[e][k]];
      ck_assert(kinds[_i] == FEM_LOAD_TRACTION ? fabs(corner) < 1e-15 : corner > 1e-6);
    }
  free(force);
  fem_load_destroy(&load);
  fem_mesh_destroy(&mesh);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("quadratic");
  tcase_add_test(cases, gradients_of_shape_functions_reproduce_quadratic_fields);
  tcase_add_test(cases, a_quadratic_displacement_has_its_exact_energy);
  tcase_add_loop_test(cases, force_and_stiffness_are_derivatives, 0, 2 * LAWS);
  tcase_add_test(cases, turned_inside_out_it_stays_finite_with_the_same_derivatives);
  tcase_add_loop_test(cases, only_rigid_motions_cost_no_energy, 0, 2 * LAWS);
  tcase_add_loop_test(cases, rigid_motion_gives_no_force_and_no_damping, 0, LAWS);
  tcase_add_loop_test(cases, damping_force_power_and_matrices_agree, 0, LAWS);
  tcase_add_test(cases, stress_of_a_uniform_state_is_the_same_everywhere);
  tcase_add_test(cases, mass_shares_are_positive_and_whole);
  tcase_add_test(cases, a_mesh_made_quadratic_is_cut_into_a_sound_mesh);
  tcase_add_test(cases, groups_take_in_the_middles_of_their_edges_and_no_others);
  tcase_add_test(cases, a_group_of_two_faces_has_nothing_between_them);
  tcase_add_loop_test(cases, a_linear_field_passes_the_patch_test, 0, 2 * LAWS);
  tcase_add_test(cases, a_following_pressure_is_the_gradient_of_the_curved_volume);
  tcase_add_test(cases, the_stiffness_of_a_closed_curved_surface_is_exact);
  tcase_add_loop_test(cases, dead_loads_add_up, 0, 3);
  return suite_run("quadratic", cases, 30);
}
