// SPDX-License-Identifier: GPL-3.0-or-later
// Selections of vertices by their distance from an axis or a point, and by the normal of the surface.
#include "suite.h"

#include "base/memory.h"
#include "fem/scene/select.h"

// A box [0, 2] × [0, 2] × [0, 1] of unit cubes: 18 vertices.
static int count_of(FemSelectDef def) {
  FemMesh mesh;
  int *vertices = NULL, count;
  ck_assert_ok(fem_mesh_box(&mesh, (const double[]){2, 2, 1}, (const int[]){2, 2, 1}));
  Status status = fem_select_vertices(&def, &mesh, &vertices, &count);
  for (int i = 1; i < count; i++) ck_assert_int_lt(vertices[i - 1], vertices[i]);
  memory_free(vertices);
  fem_mesh_destroy(&mesh);
  return status ? -1 : count;
}

static FemSelectDef ring(double z_axis, double min, double max) {
  return (FemSelectDef){.kind = FEM_SELECT_RADIUS,
                        .point = {1, 1, 0},
                        .normal = {0, 0, z_axis},
                        .radius_min = min,
                        .radius_max = max};
}

START_TEST(a_radius_counts_from_an_axis_or_a_point) {
  ck_assert_int_eq(count_of(ring(3, 0, 0)), 2);  // on the axis
  ck_assert_int_eq(count_of(ring(3, 0, 1)), 10); // both ends count as inside
  ck_assert_int_eq(count_of(ring(3, 1, 1)), 8);
  ck_assert_int_eq(count_of(ring(3, 1.1, INFINITY)), 8); // corners, at √2
  ck_assert_int_eq(count_of(ring(0, 0, 0)), 1);          // a point
  ck_assert_int_eq(count_of(ring(0, 0, 1)), 6);
  ck_assert_int_eq(count_of(ring(0, 1.7, 1.8)), 4); // √3
  ck_assert_int_eq(count_of(ring(0, 2, 9)), -1);
  ck_assert_ptr_nonnull(strstr(status_message(), "the selection holds no vertex"));
}
END_TEST

static FemSelectDef facing(double x, double z, double degrees) {
  return (FemSelectDef){.kind = FEM_SELECT_NORMAL, .normal = {x, 0, z}, .degrees = degrees};
}

START_TEST(a_normal_selects_the_faces_that_look_there) {
  ck_assert_int_eq(count_of(facing(0, 1, 1)), 9);   // the top
  ck_assert_int_eq(count_of(facing(0, -4, 1)), 9);  // the bottom
  ck_assert_int_eq(count_of(facing(1, 0, 1)), 6);   // a side
  ck_assert_int_eq(count_of(facing(1, 1, 44)), -1); // between two faces
  ck_assert_int_eq(count_of(facing(1, 1, 46)), 12); // both of them, which share three
  ck_assert_int_eq(count_of(facing(0, 1, 91)), 17); // all but the middle of the bottom
}
END_TEST

int main(void) {
  TCase *test_case = tcase_create("select");
  tcase_add_test(test_case, a_radius_counts_from_an_axis_or_a_point);
  tcase_add_test(test_case, a_normal_selects_the_faces_that_look_there);
  return suite_run("select", test_case, 60);
}
