// SPDX-License-Identifier: GPL-3.0-or-later
// That curved boundaries are worth keeping: the volume of a ball, groups and loads on its skin, a vessel
// under pressure.
#include "mesh_files.h"
#include "static_solve.h"

#include "base/vec3.h"
#include "fem/mesh/edges.h"
#include "fem/mesh/reader/gmsh_library.h"
#include "fem/scene/load.h"

// A ball of radius 1 by gmsh.
static void read_ball(FemMesh *mesh, double size, int order) {
  char text[512];
  snprintf(text, sizeof text,
           "SetFactory(\"OpenCASCADE\"); Sphere(1) = {0,0,0,1}; Physical Surface(\"skin\") = {1};\n"
           "Physical Volume(\"all\") = {1}; Mesh.MeshSizeMin = %g; Mesh.MeshSizeMax = %g; Mesh.ElementOrder "
           "= %d;\n",
           size, size, order);
  ck_assert_ok(fem_mesh_read(mesh, put("a.geo", text), NULL, NULL));
}

// Straight faces cut off a volume of the order h², curved ones of the order h⁴.
START_TEST(curved_elements_keep_the_volume_of_a_ball) {
  const double exact = 4 * acos(-1) / 3, sizes[] = {0.7, 0.35};
  double straight[2], curved[2];
  for (int k = 0; k < 2; k++) {
    FemMesh mesh;
    FemMeshQuality quality;
    FemMeshCurvature curvature;
    read_ball(&mesh, sizes[k], 2);
    ck_assert_ok(fem_mesh_quality(&mesh, &quality));
    ck_assert_ok(fem_mesh_curvature(&mesh, &curvature));
    straight[k] = 1 - quality.volume / exact, curved[k] = fabs(1 - curvature.volume / exact);
    printf("ball, size %g, %d tetrahedra: straight %.3g too little, curved %.3g off, Jacobian %.3f, nodes "
           "off %.3f\n",
           sizes[k], mesh.tet_count, straight[k], curved[k], curvature.min_jacobian, curvature.deviation);
    ck_assert(curvature.min_jacobian > 0.5);
    fem_mesh_destroy(&mesh);
  }
  ck_assert(straight[1] > 0.01);
  for (int k = 0; k < 2; k++) ck_assert(curved[k] < 0.1 * straight[k]);
  ck_assert(curved[1] < 0.2 * curved[0]);
}
END_TEST

// How many nodes lie on the unit sphere.
static int count_skin(const FemMesh *mesh) {
  int count = 0;
  for (int v = 0; v < mesh->vertex_count; v++)
    count += fabs(vec3_length(vec3_at(mesh->rest + 3 * v)) - 1) < 1e-6;
  return count;
}

START_TEST(groups_hold_corners_of_linear_and_all_nodes_of_quadratic_meshes) {
  FemMesh mesh;
  read_ball(&mesh, 0.7, 2);
  int linear = group_of(&mesh, "skin")->vertex_count;
  ck_assert_int_eq(linear, count_skin(&mesh));
  ck_assert_int_eq(group_of(&mesh, "all")->vertex_count, mesh.vertex_count);
  ck_assert_ok(fem_mesh_make_quadratic(&mesh));
  const FemMeshGroup *skin = group_of(&mesh, "skin");
  // Euler: a closed surface of n corners has 3n − 6 edges.
  ck_assert_int_eq(skin->vertex_count, 4 * linear - 6);
  ck_assert_int_eq(skin->vertex_count, count_skin(&mesh));
  for (int k = 0; k < skin->vertex_count; k++)
    ck_assert_near(vec3_length(vec3_at(mesh.rest + 3 * skin->vertices[k])), 1, 1e-6);
  ck_assert_int_eq(group_of(&mesh, "all")->vertex_count, mesh.vertex_count);
  fem_mesh_destroy(&mesh);
  read_ball(&mesh, 0.7, 2);
  fem_mesh_make_linear(&mesh);
  ck_assert_ptr_null(mesh.middles);
  ck_assert_int_eq(group_of(&mesh, "skin")->vertex_count, linear);
  fem_mesh_destroy(&mesh);
}
END_TEST

// The sum of what a load on the group "skin" gives to all nodes, and of its work in a dilation, Σ f·x.
static Vec3 sum_load(const FemMesh *mesh, FemLoadDef def, double *virial) {
  FemLoad load;
  char skin[] = "skin";
  def.select = (FemSelectDef){.kind = FEM_SELECT_GROUP, .group = skin};
  ck_assert_ok(fem_load_create(&load, &def, mesh, 0));
  Vec3 sum = {0, 0, 0};
  *virial = 0;
  for (int i = 0; i < load.vertex_count; i++) {
    sum = vec3_add(sum, vec3_at(load.force + 3 * i));
    *virial += vec3_dot(vec3_at(load.force + 3 * i), vec3_at(mesh->rest + 3 * load.vertices[i]));
  }
  fem_load_destroy(&load);
  return sum;
}

// A traction adds up to the skin's area; a pressure to nothing, and its work in a dilation is −3 p V of the
// volume within (exactly: quadrature of the faces is), which the points of the elements give to h⁴.
START_TEST(loads_act_on_the_curved_skin) {
  const double pi = acos(-1);
  FemMesh mesh;
  FemMeshCurvature curvature;
  double virial;
  read_ball(&mesh, 0.35, 2);
  ck_assert_ok(fem_mesh_curvature(&mesh, &curvature));
  ck_assert_ok(fem_mesh_make_quadratic(&mesh));
  Vec3 pulled = sum_load(&mesh, (FemLoadDef){.kind = FEM_LOAD_TRACTION, .vector = {1, 0, -2}}, &virial);
  ck_assert_near(pulled.x / (4 * pi), 1, 1e-3);
  ck_assert_near(pulled.z, -2 * pulled.x, 1e-12);
  Vec3 pressed =
      sum_load(&mesh, (FemLoadDef){.kind = FEM_LOAD_PRESSURE, .pressure = 5, .is_dead = true}, &virial);
  ck_assert_near(vec3_length(pressed), 0, 1e-12);
  printf("ball: area %.3g, volume by its skin %.3g, by its elements %.3g off\n", pulled.x / (4 * pi) - 1,
         virial / -20 / pi - 1, curvature.volume / (4 * pi / 3) - 1);
  ck_assert_near(virial / (-15 * curvature.volume), 1, 1e-3);
  fem_mesh_destroy(&mesh);
}
END_TEST

// A quarter of a thick-walled cylinder in plane strain (meshes/vessel.geo, coarse): the largest error of the
// inner corners' radial displacement over Lamé's.
static double vessel_error(int order, bool is_curved, double size) {
  const double a = 0.1, b = 0.2, E = 1e6, nu = 0.3, p = 10;
  char text[1024];
  snprintf(
      text, sizeof text,
      "Include \"%svessel.geo\";\nMesh.MeshSizeMin = %g; Mesh.MeshSizeMax = %g; Mesh.ElementOrder = %d;\n",
      MESHES, size, size, order);
  put("a.geo", text);
  snprintf(text, sizeof text,
           "time: {end: 1}\n"
           "bodies:\n"
           "  - name: wall\n"
           "    element: quadratic\n"
           "    mesh: {file: %s, curved: %s}\n"
           "    material: {law: linear, young: %g, poisson: %g, density: 1}\n"
           "    fixed: [{group: x_min, components: [x]}, {group: y_min, components: [y]}, {group: z_min, "
           "components: [z]}, {group: z_max, components: [z]}]\n"
           "    loads: [{group: inner, pressure: %g, follows: nothing}]\n",
           scratch("a.geo"), is_curved ? "true" : "false", E, nu, p);
  SceneRun run;
  scene_open_text(&run, text);
  double *u = solve_linear_static(&run.model), error = 0;
  double exact = (1 + nu) / E * p * a / (b * b - a * a) * ((1 - 2 * nu) * a * a + b * b);
  int count = 0;
  for (int v = 0; v < run.model.vertex_count; v++) {
    const double *rest = run.model.rest + 3 * v;
    double r = hypot(rest[0], rest[1]);
    if (!(fabs(r - a) < 1e-9)) continue;
    error = suite_larger(error, fabs((u[3 * v] * rest[0] + u[3 * v + 1] * rest[1]) / r / exact - 1));
    count++;
  }
  ck_assert_int_gt(count, 5);
  free(u);
  scene_close(&run);
  return error;
}

START_TEST(a_curved_vessel_meets_theory_where_a_straight_one_does_not) {
  double straight = vessel_error(1, false, 0.05), curved = vessel_error(2, false, 0.05);
  double estimated = vessel_error(1, true, 0.05), kept = vessel_error(2, true, 0.05);
  printf("vessel: straight %.3g, curved %.3g, made curved %.3g of Lame's displacement\n", straight, curved,
         estimated);
  ck_assert(curved < 0.01);
  ck_assert(estimated < 0.01);
  ck_assert_double_eq(kept, curved);
  ck_assert(straight > 3 * curved);
}
END_TEST

int main(void) {
  // Loaded once for all tests, each of which reads in a process of its own.
  FemMeshGmshLibrary gmsh;
  if (fem_mesh_gmsh_library_load(&gmsh) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("mesh_curved");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_test(cases, curved_elements_keep_the_volume_of_a_ball);
  tcase_add_test(cases, groups_hold_corners_of_linear_and_all_nodes_of_quadratic_meshes);
  tcase_add_test(cases, loads_act_on_the_curved_skin);
  tcase_add_test(cases, a_curved_vessel_meets_theory_where_a_straight_one_does_not);
  return suite_run("mesh_curved", cases, 60);
}
