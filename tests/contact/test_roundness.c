// SPDX-License-Identifier: GPL-3.0-or-later
// How bodies curve, and the edges of their facets along that: strips one element wide, domes, flat faces.
#include "contact/surface/roundness.h"

#include "base/vec3.h"
#include "fem/mesh/mesh.h"
#include "suite.h"

static const double CREASE = M_PI / 6;

static ContactRoundness roundness_of(const FemMesh *mesh) {
  ContactRoundness roundness;
  ContactBody body = {.name = "body", .vertex_end = mesh->vertex_count, .tet_end = mesh->tet_count};
  ContactSystemDef def = {.vertex_count = mesh->vertex_count,
                          .rest = mesh->rest,
                          .tets = (const int(*)[4])mesh->tets,
                          .tet_count = mesh->tet_count,
                          .bodies = &body,
                          .body_count = 1,
                          .crease = CREASE};
  ck_assert_ok(contact_roundness_measure(&roundness, &def, &body, CREASE, NULL));
  return roundness;
}

enum { ALONG = 24 };

// Half a pipe about z between radii, so many elements through it and along its axis.
static ContactRoundness pipe(double inner, double outer, double width, int through, int across) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){1, 1, 1}, (int[]){ALONG, across, through}));
  for (int v = 0; v < mesh.vertex_count; v++) {
    Vec3 x = vec3_at(mesh.rest + 3 * v);
    double r = inner + (outer - inner) * x.z;
    vec3_store(mesh.rest + 3 * v, (Vec3){r * cos(M_PI * x.x), r * sin(M_PI * x.x), width * x.y});
  }
  ContactRoundness roundness = roundness_of(&mesh);
  fem_mesh_destroy(&mesh);
  return roundness;
}

// However wide the strip is, its diagonals and the edges across it tell nothing that its rims do not. Its
// ends curve less; what a curve through vertices is short of is of second order in the edge over the radius.
START_TEST(a_strip_one_element_wide_is_as_round_as_its_rims) {
  static const double WIDTHS[] = {0.02, 0.131, 1};
  for (int across = 1; across <= 3; across++) {
    ContactRoundness roundness = pipe(0.9, 1, across * WIDTHS[_i], 2, across);
    ck_assert_near(roundness.round, 1, 0.02);
    ck_assert_near(roundness.hollow, 1 / 0.9, 0.02 / 0.9);
    ck_assert_double_ge(roundness.edge, 0.98 * 0.9 * M_PI / ALONG);
    ck_assert_double_le(roundness.edge, 1.02 * M_PI / ALONG);
  }
}
END_TEST

// A point of a smooth surface keeps within a quarter of the elements; the curvature does not.
START_TEST(a_thin_shell_is_as_round_as_a_thick_one) {
  double sagitta = 1 - cos(M_PI / ALONG / 2);
  ContactRoundness roundness = pipe(1 - sagitta, 1, 0.1, 1, 1);
  ck_assert_near(roundness.round, 1, 0.02);
  ck_assert_near(roundness.hollow, 1, 0.02);
}
END_TEST

// Both ways alike: the edge of the square that two facets of right angles make, squeezed at the dome's rim.
START_TEST(a_dome_curves_both_ways) {
  enum { CELLS = 12 };
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){1, 1, 1}, (int[]){CELLS, CELLS, 1}));
  for (int v = 0; v < mesh.vertex_count; v++) {
    Vec3 x = vec3_at(mesh.rest + 3 * v), ray = {0.6 * (x.x - 0.5), 0.6 * (x.y - 0.5), 1};
    vec3_store(mesh.rest + 3 * v, vec3_scale((1.8 + 0.2 * x.z) / vec3_length(ray), ray));
  }
  ContactRoundness roundness = roundness_of(&mesh);
  ck_assert_near(roundness.round, 0.5, 0.01);
  ck_assert_near(roundness.hollow, 1 / 1.8, 0.01);
  ck_assert_double_ge(roundness.edge, 0.9 * 1.8 * 0.6 / CELLS);
  ck_assert_double_le(roundness.edge, 2 * 0.6 / CELLS);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(flat_faces_do_not_curve) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_box(&mesh, (double[]){3, 2, 1}, (int[]){6, 4, 2}));
  ContactRoundness roundness = roundness_of(&mesh);
  ck_assert_double_eq(roundness.round, 0);
  ck_assert_double_eq(roundness.hollow, 0);
  ck_assert_near(roundness.edge, 0.5, 1e-12);
  fem_mesh_destroy(&mesh);
}
END_TEST

int main(void) {
  TCase *tests = tcase_create("roundness");
  tcase_add_loop_test(tests, a_strip_one_element_wide_is_as_round_as_its_rims, 0, 3);
  tcase_add_test(tests, a_thin_shell_is_as_round_as_a_thick_one);
  tcase_add_test(tests, a_dome_curves_both_ways);
  tcase_add_test(tests, flat_faces_do_not_curve);
  return suite_run("roundness", tests, 20);
}
