// SPDX-License-Identifier: GPL-3.0-or-later
// fem/mesh: what a mesh must be, boxes, placement, quality, surface, and memory that runs out.
#include "suite.h"

#include <limits.h>
#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/vec3.h"
#include "fem/mesh/from_arrays.h"
#include "fem/mesh/mesh.h"

// The corners of a unit cube, x fastest, and its centre; vertex 9 is used by nobody.
static const double cube[10][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},       {0, 0, 1},
                                   {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.5, 0.5, 0.5}, {7, 7, 7}};

static double signed_volume(const FemMesh *mesh) {
  double volume = 0;
  for (int t = 0; t < mesh->tet_count; t++) {
    Vec3 p[4];
    for (int k = 0; k < 4; k++) p[k] = vec3_at(mesh->rest + 3 * mesh->tets[t][k]);
    volume += vec3_det4(p[0], p[1], p[2], p[3]) / 6;
  }
  return volume;
}

static int inverted_count(const FemMesh *mesh) {
  int count = 0;
  for (int t = 0; t < mesh->tet_count; t++) {
    Vec3 p[4];
    for (int k = 0; k < 4; k++) p[k] = vec3_at(mesh->rest + 3 * mesh->tets[t][k]);
    if (!(vec3_det4(p[0], p[1], p[2], p[3]) > 0)) count++;
  }
  return count;
}

// Asserts that the message names the source and everything else a person needs.
static void expect_refusal(int vertex_count, const double *positions, int tet_count, const int *tets,
                           const char *fault, const char *remedy) {
  FemMesh mesh;
  Status status = mesh_from_arrays(&mesh, "thing.msh", vertex_count, positions, tet_count, tets, NULL);
  ck_assert_int_eq(status, STATUS_INPUT);
  ck_assert_msg(strncmp(status_message(), "thing.msh: ", 11) == 0, "%s", status_message());
  ck_assert_msg(strstr(status_message(), fault) != NULL, "'%s' lacks '%s'", status_message(), fault);
  ck_assert_msg(strstr(status_message(), remedy) != NULL, "'%s' lacks '%s'", status_message(), remedy);
  ck_assert_ptr_null(mesh.rest);
  fem_mesh_destroy(&mesh);
}

START_TEST(an_inside_out_tetrahedron_is_turned_and_counted) {
  const int tets[2][4] = {{0, 2, 1, 4}, {1, 2, 4, 7}};
  FemMesh mesh;
  FemMeshRepairs repairs;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 8, cube[0], 2, tets[0], &repairs));
  ck_assert_int_eq(repairs.reoriented_tets, 1);
  ck_assert_int_eq(inverted_count(&mesh), 0);
  ck_assert_near(signed_volume(&mesh), 1. / 6 + 1. / 3, 1e-15);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(unused_vertices_are_dropped_and_the_rest_keep_their_order) {
  const int tet[4] = {1, 3, 7, 8};
  FemMesh mesh;
  FemMeshRepairs repairs;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 10, cube[0], 1, tet, &repairs));
  ck_assert_int_eq(repairs.dropped_vertices, 6);
  ck_assert_int_eq(mesh.vertex_count, 4);
  const int kept[4] = {1, 3, 7, 8};
  for (int v = 0; v < 4; v++) ck_assert_mem_eq(mesh.rest + 3 * v, cube[kept[v]], sizeof cube[0]);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(an_empty_mesh_is_refused) {
  expect_refusal(8, cube[0], 0, NULL, "has no tetrahedra", "give a volume mesh");
}
END_TEST

START_TEST(an_index_out_of_range_is_refused) {
  const int above[2][4] = {{0, 1, 2, 4}, {1, 2, 4, 10}}, below[4] = {0, 1, 2, -1};
  expect_refusal(10, cube[0], 2, above[0], "element 1 refers to vertex 10", "0 to 9");
  expect_refusal(10, cube[0], 1, below, "element 0 refers to vertex -1", "0 to 9");
}
END_TEST

START_TEST(a_repeated_vertex_is_refused) {
  const int tet[4] = {0, 1, 2, 1};
  expect_refusal(8, cube[0], 1, tet, "element 0 has vertex 1 twice", "remove");
}
END_TEST

START_TEST(a_coordinate_that_is_not_finite_is_refused_even_if_unused) {
  double positions[10][3];
  memcpy(positions, cube, sizeof cube);
  const int tet[4] = {0, 1, 2, 4};
  positions[9][1] = NAN;
  expect_refusal(10, positions[0], 1, tet, "vertex 9", "finite");
  positions[9][1] = 0, positions[0][2] = -INFINITY;
  expect_refusal(10, positions[0], 1, tet, "vertex 0", "finite");
}
END_TEST

START_TEST(a_flat_tetrahedron_is_refused_at_every_scale_and_offset) {
  const int tets[2][4] = {{0, 1, 2, 4}, {4, 5, 6, 7}};
  for (int k = 0; k < 4; k++) {
    const double scale[] = {1, 1e-9, 1e9, 1e-3}, offset[] = {0, 0, 0, 1e6};
    double positions[10][3];
    Random random = random_seeded(1, (uint64_t)k);
    double R[9];
    random_rotation(&random, R);
    for (int v = 0; v < 10; v++)
      for (int c = 0; c < 3; c++)
        positions[v][c] = offset[k] + scale[k] * (R[3 * c] * cube[v][0] + R[3 * c + 1] * cube[v][1] +
                                                  R[3 * c + 2] * cube[v][2]);
    expect_refusal(10, positions[0], 2, tets[0], "element 1 at", "zero volume");
    FemMesh mesh;
    ck_assert_ok(mesh_from_arrays(&mesh, "o", 10, positions[0], 1, tets[0], NULL));
    fem_mesh_destroy(&mesh);
  }
}
END_TEST

START_TEST(duplicate_elements_are_refused) {
  const int tets[3][4] = {{0, 1, 2, 4}, {1, 2, 4, 7}, {4, 2, 1, 0}};
  expect_refusal(8, cube[0], 3, tets[0], "elements 0 and 2 have the same four vertices", "remove one");
}
END_TEST

START_TEST(neighbours_on_the_same_side_of_their_face_are_refused) {
  // Both stand on the triangle 0 1 2, one to the corner above, one to the centre.
  const int tets[2][4] = {{0, 1, 2, 4}, {0, 1, 2, 8}};
  expect_refusal(9, cube[0], 2, tets[0], "elements 0 and 1 lie on the same side", "remove one");
}
END_TEST

START_TEST(a_triangle_with_three_tetrahedra_is_refused) {
  const double below[3] = {0, 0, -1};
  double positions[10][3];
  memcpy(positions, cube, sizeof cube), memcpy(positions[9], below, sizeof below);
  const int tets[3][4] = {{0, 1, 2, 4}, {0, 1, 2, 9}, {0, 1, 2, 8}};
  expect_refusal(10, positions[0], 3, tets[0], "vertices 0, 1, 2 belongs to 3 elements (0, 1, 2)",
                 "at most two");
}
END_TEST

START_TEST(bodies_that_share_only_an_edge_or_a_vertex_are_accepted_and_reported) {
  // Two tetrahedra on either side of the edge 0 1; then two that meet in vertex 0.
  const double positions[7][3] = {{0, 0, 0},  {1, 0, 0},   {0, 1, 0},  {0, 1, 1},
                                  {0, -1, 0}, {0, -1, -1}, {-1, -1, 0}};
  const int at_edge[2][4] = {{0, 1, 2, 3}, {0, 1, 4, 5}}, at_vertex[2][4] = {{0, 1, 2, 3}, {0, 4, 5, 6}};
  FemMesh mesh;
  FemMeshQuality quality;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 7, positions[0], 2, at_edge[0], NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &quality));
  ck_assert_int_eq(quality.pinch_edge_count, 1);
  ck_assert_int_eq(quality.pinch_vertex_count, 0);
  ck_assert_int_eq(quality.component_count, 1);
  fem_mesh_destroy(&mesh);
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 7, positions[0], 2, at_vertex[0], NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &quality));
  ck_assert_int_eq(quality.pinch_edge_count, 0);
  ck_assert_int_eq(quality.pinch_vertex_count, 1);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(coincident_vertices_and_separate_parts_are_counted) {
  // Two tetrahedra on either side of a triangle whose vertices exist twice.
  const double positions[8][3] = {{0, 0, 0},    {1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                                  {-0.0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  const int tets[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  FemMesh mesh;
  FemMeshQuality quality;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 8, positions[0], 2, tets[0], NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &quality));
  ck_assert_int_eq(quality.coincident_vertex_count, 3);
  ck_assert_int_eq(quality.component_count, 2);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_regular_tetrahedron_has_the_angles_of_the_books) {
  const double positions[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const int tet[4] = {0, 1, 2, 3};
  FemMesh mesh;
  FemMeshQuality q;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 4, positions[0], 1, tet, NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  // arccos ⅓; edge 2√2; a³/(6√2); √3 a².
  ck_assert_near(q.min_dihedral_degrees, 70.528779365509308, 1e-12);
  ck_assert_near(q.max_dihedral_degrees, 70.528779365509308, 1e-12);
  ck_assert_near(fem_mesh_min_dihedral(&mesh), 70.528779365509308, 1e-12);
  ck_assert_near(q.min_det, sqrt(0.5), 1e-15);
  ck_assert_near(q.volume, 8. / 3, 1e-15);
  ck_assert_near(q.surface_area, 8 * sqrt(3), 1e-13);
  ck_assert_near(q.min_edge, 2 * sqrt(2), 1e-15);
  ck_assert_near(q.mean_edge, 2 * sqrt(2), 1e-15);
  ck_assert_near(q.max_edge, 2 * sqrt(2), 1e-15);
  ck_assert_int_eq(q.surface_triangle_count, 4);
  ck_assert_int_eq(q.component_count, 1);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(the_worst_tetrahedron_is_named) {
  // The corner tetrahedron 0 1 2 4 has a right angle; the flat pyramid below has a smaller one.
  const double positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, 0.3, -0.01}};
  const int tets[2][4] = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  FemMesh mesh;
  FemMeshQuality q;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 5, positions[0], 2, tets[0], NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_int_eq(q.min_dihedral_tet, 1);
  ck_assert_int_eq(q.min_det_tet, 1);
  // At the edges along the axes: atan(0.01/0.3).
  ck_assert_near(q.min_dihedral_degrees, atan(0.01 / 0.3) * 180 / acos(-1), 1e-10);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_box_has_its_volume_surface_and_groups) {
  const double size[3] = {0.1, 0.7, 0.3};
  const int cells[3] = {2, 3, 4};
  FemMesh mesh;
  FemMeshQuality q;
  ck_assert_ok(fem_mesh_box(&mesh, size, cells));
  ck_assert_int_eq(mesh.vertex_count, 3 * 4 * 5);
  ck_assert_int_eq(mesh.tet_count, 6 * 2 * 3 * 4);
  ck_assert_int_eq(inverted_count(&mesh), 0);
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_near(q.volume, 0.021, 1e-16);
  ck_assert_near(q.surface_area, 2 * (0.07 + 0.03 + 0.21), 1e-14);
  ck_assert_int_eq(q.surface_triangle_count, 2 * 2 * (6 + 8 + 12));
  ck_assert_int_eq(q.pinch_edge_count + q.pinch_vertex_count + q.coincident_vertex_count, 0);
  ck_assert_mem_eq(q.box_max, size, sizeof size);
  const char *names[] = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  const int counts[] = {20, 20, 15, 15, 12, 12};
  ck_assert_int_eq(mesh.group_count, 6);
  for (int g = 0; g < 6; g++) {
    const FemMeshGroup *group = &mesh.groups[g];
    ck_assert_str_eq(group->name, names[g]);
    ck_assert_int_eq(group->vertex_count, counts[g]);
    for (int k = 0; k < group->vertex_count; k++) {
      ck_assert(k == 0 || group->vertices[k] > group->vertices[k - 1]);
      ck_assert_double_eq(mesh.rest[3 * group->vertices[k] + g / 2], g % 2 ? size[g / 2] : 0);
    }
  }
  // It passes the gate that files pass: conforming, no face too many, nothing to mend.
  FemMesh copy;
  FemMeshRepairs repairs;
  ck_assert_ok(
      mesh_from_arrays(&copy, "o", mesh.vertex_count, mesh.rest, mesh.tet_count, mesh.tets[0], &repairs));
  ck_assert_int_eq(repairs.reoriented_tets + repairs.dropped_vertices, 0);
  fem_mesh_destroy(&copy), fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(an_impossible_box_is_refused) {
  FemMesh mesh;
  ck_assert_int_eq(fem_mesh_box(&mesh, (double[3]){1, 0, 1}, (int[3]){1, 1, 1}), STATUS_INPUT);
  ck_assert_int_eq(fem_mesh_box(&mesh, (double[3]){1, NAN, 1}, (int[3]){1, 1, 1}), STATUS_INPUT);
  ck_assert_int_eq(fem_mesh_box(&mesh, (double[3]){1, 1, 1}, (int[3]){1, 0, 1}), STATUS_INPUT);
  ck_assert_int_eq(fem_mesh_box(&mesh, (double[3]){1, 1, 1}, (int[3]){INT_MAX, INT_MAX, INT_MAX}),
                   STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "at most"));
}
END_TEST

// A cube with bumps: no symmetry that could hide a mistake.
static void make_bumpy(FemMesh *mesh) {
  ck_assert_ok(fem_mesh_box(mesh, (double[3]){1, 1, 1}, (int[3]){3, 3, 3}));
  Random random = random_seeded(7, 0);
  for (int k = 0; k < 3 * mesh->vertex_count; k++) mesh->rest[k] += random_between(&random, -0.05, 0.05);
  ck_assert_int_eq(inverted_count(mesh), 0);
}

START_TEST(the_surface_is_closed_and_encloses_the_volume) {
  FemMesh mesh;
  make_bumpy(&mesh);
  int(*triangles)[3], count;
  ck_assert_ok(fem_mesh_surface(&mesh, &triangles, &count));
  Vec3 area = {0, 0, 0};
  double volume = 0;
  for (int n = 0; n < count; n++) {
    Vec3 a = vec3_at(mesh.rest + 3 * triangles[n][0]), b = vec3_at(mesh.rest + 3 * triangles[n][1]);
    Vec3 c = vec3_at(mesh.rest + 3 * triangles[n][2]);
    area = vec3_add(area, vec3_scale(0.5, vec3_cross(vec3_sub(b, a), vec3_sub(c, a))));
    volume += vec3_dot(a, vec3_cross(b, c)) / 6;
  }
  ck_assert_int_eq(count, 12 * 9);
  ck_assert_near(vec3_length(area), 0, 1e-14);
  ck_assert_near(volume, signed_volume(&mesh), 1e-14);
  memory_free(triangles);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(the_order_of_elements_and_vertices_changes_nothing) {
  FemMesh mesh, shuffled;
  make_bumpy(&mesh);
  Random random = random_seeded(3, 0);
  int *order = memory_zeroed((size_t)mesh.vertex_count, sizeof *order);
  double *positions = memory_zeroed((size_t)mesh.vertex_count, sizeof(double[3]));
  for (int v = 0; v < mesh.vertex_count; v++) order[v] = v;
  for (int v = mesh.vertex_count - 1; v > 0; v--) {
    int w = random_below(&random, v + 1), kept = order[v];
    order[v] = order[w], order[w] = kept;
  }
  for (int v = 0; v < mesh.vertex_count; v++)
    memcpy(positions + 3 * order[v], mesh.rest + 3 * v, sizeof(double[3]));
  int(*tets)[4] = memory_zeroed((size_t)mesh.tet_count, sizeof *tets);
  for (int t = 0; t < mesh.tet_count; t++)
    for (int k = 0; k < 4; k++) tets[mesh.tet_count - 1 - t][(k + t) % 4] = order[mesh.tets[t][k]];
  FemMeshRepairs repairs;
  ck_assert_ok(
      mesh_from_arrays(&shuffled, "o", mesh.vertex_count, positions, mesh.tet_count, tets[0], &repairs));
  // A cycle of four is odd, two of them even.
  ck_assert_int_eq(repairs.reoriented_tets, mesh.tet_count / 2);
  FemMeshQuality a, b;
  ck_assert_ok(fem_mesh_quality(&mesh, &a));
  ck_assert_ok(fem_mesh_quality(&shuffled, &b));
  ck_assert_near(a.volume, b.volume, 1e-14);
  ck_assert_near(a.surface_area, b.surface_area, 1e-13);
  ck_assert_near(a.min_dihedral_degrees, b.min_dihedral_degrees, 1e-11);
  ck_assert_near(a.mean_edge, b.mean_edge, 1e-14);
  ck_assert_int_eq(a.surface_triangle_count, b.surface_triangle_count);
  memory_free(order), memory_free(positions), memory_free(tets);
  fem_mesh_destroy(&mesh), fem_mesh_destroy(&shuffled);
}
END_TEST

START_TEST(a_placement_scales_then_turns_then_shifts) {
  const int tet[4] = {0, 1, 2, 4};
  FemMesh mesh;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 5, cube[0], 1, tet, NULL));
  FemPlacement placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}};
  memcpy(placement.scale, (double[3]){2, 3, 4}, sizeof placement.scale);
  memcpy(placement.axis, (double[3]){0, 0, -5}, sizeof placement.axis);
  placement.angle_degrees = -90;
  memcpy(placement.translate, (double[3]){10, 20, 30}, sizeof placement.translate);
  ck_assert_ok(fem_mesh_place(&mesh, &placement));
  // A quarter turn takes x to y and y to −x, exactly.
  const double expected[4][3] = {{10, 20, 30}, {10, 22, 30}, {7, 20, 30}, {10, 20, 34}};
  ck_assert_mem_eq(mesh.rest, expected, sizeof expected);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_rotation_about_a_diagonal_permutes_the_axes) {
  const int tet[4] = {0, 1, 2, 4};
  FemMesh mesh;
  ck_assert_ok(mesh_from_arrays(&mesh, "o", 5, cube[0], 1, tet, NULL));
  FemPlacement placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}};
  memcpy(placement.axis, (double[3]){1, 1, 1}, sizeof placement.axis);
  placement.angle_degrees = 120;
  ck_assert_ok(fem_mesh_place(&mesh, &placement));
  const double expected[4][3] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  for (int k = 0; k < 12; k++) ck_assert_near(mesh.rest[k], expected[k / 3][k % 3], 1e-15);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_mirror_keeps_the_orientation_positive) {
  const double signs[4][3] = {{-1, 1, 1}, {-1, -1, 1}, {-1, -1, -1}, {1, -1, 2}};
  for (int k = 0; k < 4; k++) {
    FemMesh mesh;
    make_bumpy(&mesh);
    double volume = signed_volume(&mesh);
    FemPlacement placement = {.scale = {1, 1, 1}, .axis = {0, 0, 1}};
    memcpy(placement.scale, signs[k], sizeof signs[k]);
    placement.angle_degrees = 33;
    ck_assert_ok(fem_mesh_place(&mesh, &placement));
    ck_assert_int_eq(inverted_count(&mesh), 0);
    ck_assert_near(signed_volume(&mesh), volume * signs[k][2] * (signs[k][2] < 0 ? -1 : 1), 1e-14);
    fem_mesh_destroy(&mesh);
  }
}
END_TEST

START_TEST(an_impossible_placement_is_refused_and_changes_nothing) {
  FemMesh mesh;
  make_bumpy(&mesh);
  size_t size = 3 * (size_t)mesh.vertex_count;
  double *before = memory_copy(mesh.rest, size, sizeof *before);
  FemPlacement cases[6];
  for (int k = 0; k < 6; k++) cases[k] = (FemPlacement){.scale = {1, 1, 1}, .axis = {0, 0, 1}};
  cases[0].scale[1] = 0;
  cases[1].scale[2] = NAN;
  cases[2].translate[0] = INFINITY;
  cases[3].angle_degrees = NAN;
  cases[4].angle_degrees = 30, cases[4].axis[2] = 0;
  cases[5].scale[0] = 1e308, cases[5].scale[1] = 1e-10;
  for (int k = 0; k < 6; k++) {
    ck_assert_msg(fem_mesh_place(&mesh, &cases[k]) == STATUS_INPUT, "case %d", k);
    ck_assert_mem_eq(mesh.rest, before, size * sizeof *before);
  }
  memory_free(before);
  fem_mesh_destroy(&mesh);
}
END_TEST

static Status make_from_arrays(const FemMesh *source) {
  FemMesh mesh;
  Status status = mesh_from_arrays(&mesh, "o", source->vertex_count, source->rest, source->tet_count,
                                   source->tets[0], NULL);
  fem_mesh_destroy(&mesh);
  return status;
}

static Status make_box(const FemMesh *source) {
  (void)source;
  FemMesh mesh;
  Status status = fem_mesh_box(&mesh, (double[3]){1, 1, 1}, (int[3]){2, 2, 2});
  fem_mesh_destroy(&mesh);
  return status;
}

static Status measure(const FemMesh *source) {
  FemMeshQuality quality;
  return fem_mesh_quality(source, &quality);
}

// Fails the k-th allocation for every k until none is left to fail; leaks are the sanitizer's to find.
START_TEST(every_failed_allocation_is_an_error) {
  Status (*const makers[])(const FemMesh *) = {make_from_arrays, make_box, measure};
  const int least[] = {4, 10, 6};
  FemMesh source;
  make_bumpy(&source);
  for (int m = 0; m < 3; m++) {
    int k = 1;
    for (Status status = STATUS_MEMORY; status != STATUS_OK; k++) {
      memory_fail_at(k);
      status = makers[m](&source);
      memory_fail_at(0);
      ck_assert(status == STATUS_OK || status == STATUS_MEMORY);
      if (status) ck_assert_ptr_nonnull(strstr(status_message(), "memory"));
      ck_assert_int_lt(k, 100);
    }
    ck_assert_int_gt(k, least[m]);
  }
  fem_mesh_destroy(&source);
}
END_TEST

int main(void) {
  TCase *cases = tcase_create("mesh");
  tcase_add_test(cases, an_inside_out_tetrahedron_is_turned_and_counted);
  tcase_add_test(cases, unused_vertices_are_dropped_and_the_rest_keep_their_order);
  tcase_add_test(cases, an_empty_mesh_is_refused);
  tcase_add_test(cases, an_index_out_of_range_is_refused);
  tcase_add_test(cases, a_repeated_vertex_is_refused);
  tcase_add_test(cases, a_coordinate_that_is_not_finite_is_refused_even_if_unused);
  tcase_add_test(cases, a_flat_tetrahedron_is_refused_at_every_scale_and_offset);
  tcase_add_test(cases, duplicate_elements_are_refused);
  tcase_add_test(cases, neighbours_on_the_same_side_of_their_face_are_refused);
  tcase_add_test(cases, a_triangle_with_three_tetrahedra_is_refused);
  tcase_add_test(cases, bodies_that_share_only_an_edge_or_a_vertex_are_accepted_and_reported);
  tcase_add_test(cases, coincident_vertices_and_separate_parts_are_counted);
  tcase_add_test(cases, a_regular_tetrahedron_has_the_angles_of_the_books);
  tcase_add_test(cases, the_worst_tetrahedron_is_named);
  tcase_add_test(cases, a_box_has_its_volume_surface_and_groups);
  tcase_add_test(cases, an_impossible_box_is_refused);
  tcase_add_test(cases, the_surface_is_closed_and_encloses_the_volume);
  tcase_add_test(cases, the_order_of_elements_and_vertices_changes_nothing);
  tcase_add_test(cases, a_placement_scales_then_turns_then_shifts);
  tcase_add_test(cases, a_rotation_about_a_diagonal_permutes_the_axes);
  tcase_add_test(cases, a_mirror_keeps_the_orientation_positive);
  tcase_add_test(cases, an_impossible_placement_is_refused_and_changes_nothing);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("mesh", cases, 30);
}
