// SPDX-License-Identifier: GPL-3.0-or-later
// Reading meshes: one box in every format, meshing in place.
#include "medit.h"
#include "mesh_files.h"

#include <string.h>
#include <unistd.h>

#include "base/files/file.h"
#include "fem/mesh/reader/gmsh_library.h"

START_TEST(every_format_gives_the_same_box) {
  const char *names[] = {"box_22.msh", "box_22_binary.msh", "box_41.msh", "box_41_binary.msh", "box.mesh",
                         "box.vtk",    "box.node",          "box.ele",    "box.stl",           "box.geo"};
  char path[256];
  snprintf(path, sizeof path, DATA "%s", names[_i]);
  FemMesh mesh;
  FemMeshRepairs repairs;
  FemMeshQuality q;
  ck_assert_ok(fem_mesh_read(&mesh, path, NULL, &repairs));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_near(q.volume, 0.006, 0.006e-12);
  ck_assert_near(q.surface_area, 0.22, 0.22e-12);
  const double size[3] = {0.1, 0.2, 0.3};
  for (int c = 0; c < 3; c++) {
    ck_assert_near(q.box_min[c], 0, 1e-15);
    ck_assert_near(q.box_max[c], size[c], 1e-15);
  }
  ck_assert_int_eq(repairs.reoriented_tets + repairs.dropped_vertices, 0);
  ck_assert_int_eq(q.component_count, 1);
  ck_assert_int_eq(q.coincident_vertex_count + q.pinch_edge_count + q.pinch_vertex_count, 0);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(physical_groups_become_vertex_groups) {
  const char *names[] = {"box_22.msh", "box_22_binary.msh", "box_41.msh", "box_41_binary.msh", "box.geo"};
  char path[256];
  snprintf(path, sizeof path, DATA "%s", names[_i]);
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, path, NULL, NULL));
  ck_assert_int_eq(mesh.group_count, 6);
  expect_plane(&mesh, "bottom", 2, 0);
  expect_plane(&mesh, "top", 2, 0.3);
  expect_plane(&mesh, "surface_7", 1, 0); // a group without a name
  ck_assert_int_eq(group_of(&mesh, "solid")->vertex_count, mesh.vertex_count);
  const FemMeshGroup *corner = group_of(&mesh, "corner"), *edge = group_of(&mesh, "edge");
  ck_assert_int_eq(corner->vertex_count, 1);
  for (int c = 0; c < 3; c++) ck_assert_near(mesh.rest[3 * corner->vertices[0] + c], 0, 1e-15);
  ck_assert_int_eq(edge->vertex_count, 2);
  for (int c = 1; c < 3; c++) ck_assert_near(mesh.rest[3 * edge->vertices[1] + c], 0, 1e-15);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Two boxes that share a face, a physical volume each; a tetrahedron may have all its corners on that face's
// rim, so groups of vertices alone could not tell.
START_TEST(physical_volumes_hold_their_tetrahedra) {
  const char *path = put("two.geo", "Point(1) = {0, 0, 0, 0.05};\n"
                                    "Extrude {0.1, 0, 0} { Point{1}; }\nExtrude {0, 0.1, 0} { Curve{1}; }\n"
                                    "a[] = Extrude {0, 0, 0.1} { Surface{5}; };\n"
                                    "b[] = Extrude {0, 0, 0.05} { Surface{a[0]}; };\n"
                                    "Physical Volume(\"core\") = {a[1]};\nPhysical Volume(\"shell\") = "
                                    "{b[1]};\nPhysical Surface(\"between\") = {a[0]};\n");
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, path, NULL, NULL));
  const FemMeshGroup *core = group_of(&mesh, "core"), *shell = group_of(&mesh, "shell");
  ck_assert_int_gt(core->tet_count, 0);
  ck_assert_int_gt(shell->tet_count, 0);
  ck_assert_int_eq(core->tet_count + shell->tet_count, mesh.tet_count);
  ck_assert_int_eq(group_of(&mesh, "between")->tet_count, 0);
  for (int k = 0; k < 2; k++) {
    const FemMeshGroup *group = k ? shell : core;
    for (int i = 0; i < group->tet_count; i++) {
      double height = 0;
      for (int v = 0; v < 4; v++) height += 0.25 * mesh.rest[3 * mesh.tets[group->tets[i]][v] + 2];
      ck_assert(k ? height > 0.1 : height < 0.1);
      ck_assert(i == 0 || group->tets[i] > group->tets[i - 1]);
    }
  }
  FemMesh copy;
  ck_assert_ok(fem_mesh_copy(&copy, &mesh));
  ck_assert_int_eq(group_of(&copy, "core")->tet_count, core->tet_count);
  fem_mesh_destroy(&copy);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(references_and_markers_become_groups_where_there_are_no_names) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, DATA "box.mesh", NULL, NULL));
  expect_plane(&mesh, "surface_5", 2, 0);
  expect_plane(&mesh, "surface_27", 2, 0.3);
  fem_mesh_destroy(&mesh);
  ck_assert_ok(fem_mesh_read(&mesh, DATA "box.node", NULL, NULL));
  ck_assert_int_eq(mesh.group_count, 2);
  expect_plane(&mesh, "marker_5", 2, 0);
  expect_plane(&mesh, "marker_27", 2, 0.3);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(what_is_written_is_read_back_exactly) {
  FemMesh mesh, again;
  ck_assert_ok(fem_mesh_box(&mesh, (double[3]){0.1, 0.3, 1. / 3}, (int[3]){2, 3, 1}));
  for (int k = 0; k < 3 * mesh.vertex_count; k++) mesh.rest[k] -= 1. / 7;
  medit_write(&mesh, scratch("a.mesh"));
  ck_assert_ok(fem_mesh_read(&again, scratch("a.mesh"), NULL, NULL));
  ck_assert_int_eq(again.vertex_count, mesh.vertex_count);
  ck_assert_int_eq(again.tet_count, mesh.tet_count);
  ck_assert_mem_eq(again.rest, mesh.rest, 3 * (size_t)mesh.vertex_count * sizeof(double));
  ck_assert_mem_eq(again.tets, mesh.tets, (size_t)mesh.tet_count * sizeof *mesh.tets);
  fem_mesh_destroy(&mesh), fem_mesh_destroy(&again);
}
END_TEST

START_TEST(orientation_is_repaired_and_unused_vertices_are_dropped) {
  FemMesh mesh;
  FemMeshRepairs repairs;
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "7 4 2 1 1 11 13 12 14\n8 4 2 1 1 11 12 13 15\n"));
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.msh"), NULL, &repairs));
  ck_assert_int_eq(repairs.reoriented_tets, 2);
  ck_assert_int_eq(mesh.vertex_count, 5);
  FemMeshQuality q;
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_near(q.volume, 1. / 3, 1e-15);
  fem_mesh_destroy(&mesh);
}
END_TEST

// The format lets a word and its count share a line.
START_TEST(a_count_beside_its_word_is_read) {
  put("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
                "Tetrahedra 1\n1 2 3 4 7\nEnd\n");
  FemMesh mesh;
  FemMeshRepairs repairs;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.mesh"), NULL, &repairs));
  ck_assert_int_eq(mesh.vertex_count, 4);
  ck_assert_int_eq(mesh.tet_count, 1);
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) ck_assert_double_eq(mesh.rest[3 * v + c], v == c + 1);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(a_closed_surface_is_filled) {
  put("a.stl", "solid t\n" FACET(O, Y, X) FACET(O, X, Z) FACET(O, Z, Y) FACET(X, Y, Z) "endsolid t\n");
  FemMesh mesh;
  FemMeshQuality q;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.stl"), NULL, NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_near(q.volume, 1. / 6, 1e-15);
  ck_assert_int_eq(q.surface_triangle_count, 4);
  int coarse = mesh.tet_count;
  fem_mesh_destroy(&mesh);
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.stl"), &(FemMeshOptions){.size = 0.2}, NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  ck_assert_near(q.volume, 1. / 6, 1e-12);
  ck_assert_int_gt(mesh.tet_count, 20 * coarse);
  ck_assert_near(q.mean_edge, 0.2, 0.06);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(meshing_twice_gives_the_same_mesh) {
  FemMesh a, b;
  const FemMeshOptions options[] = {{.size = 0.03}, {.size = 0.04}, {.size = 0.012}};
  const char *paths[] = {DATA "box.geo", MESHES "slab.geo", MESHES "bunny_like.stl"};
  ck_assert_ok(fem_mesh_read(&a, paths[_i], &options[_i], NULL));
  ck_assert_ok(fem_mesh_read(&b, paths[_i], &options[_i], NULL));
  ck_assert_int_gt(a.tet_count, 500);
  ck_assert_int_eq(a.tet_count, b.tet_count);
  ck_assert_int_eq(a.vertex_count, b.vertex_count);
  ck_assert_mem_eq(a.rest, b.rest, 3 * (size_t)a.vertex_count * sizeof(double));
  ck_assert_mem_eq(a.tets, b.tets, (size_t)a.tet_count * sizeof *a.tets);
  // Of some sizes gmsh 4.13 has no seed of the eight that gives 8°; slivers have less than 1°.
  ck_assert_double_gt(fem_mesh_min_dihedral(&a), 4);
  fem_mesh_destroy(&a), fem_mesh_destroy(&b);
}
END_TEST

// Counts of what gmsh makes of a geometry are those of its version 4.8; 4.13 makes up to 1 % more or less.
START_TEST(our_meshes_are_what_their_readme_says) {
  const struct {
    const char *path;
    int vertex_count, tet_count;
    double volume, tolerance; // of an inscribed polyhedron: a few per cent
  } meshes[] = {
      {MESHES "tet.mesh", 4, 1, 0.001 / (6 * sqrt(2)), 1e-18},
      {MESHES "block.msh", 145, 399, 0.008, 1e-15},
      {MESHES "sphere.msh", 391, 1443, 4. / 3 * acos(-1) * 0.001, 0.03 * 0.0042},
      {MESHES "block.geo", 145, 399, 0.008, 1e-15},
      {MESHES "sphere.geo", 391, 1443, 4. / 3 * acos(-1) * 0.001, 0.03 * 0.0042},
      {MESHES "beam.geo", 726, 2327, 0.01, 1e-15},
      {MESHES "slab.geo", 442, 1211, 0.018, 1e-15},
      {MESHES "bunny_like.stl", 2545, 10836, 0.0009, 0.00001},
  };
  FemMesh mesh;
  FemMeshQuality q;
  ck_assert_ok(fem_mesh_read(&mesh, meshes[_i].path, NULL, NULL));
  ck_assert_ok(fem_mesh_quality(&mesh, &q));
  const double slack = strstr(meshes[_i].path, ".geo") ? 0.02 : 0;
  ck_assert_near(mesh.vertex_count, meshes[_i].vertex_count, slack * meshes[_i].vertex_count);
  ck_assert_near(mesh.tet_count, meshes[_i].tet_count, slack * meshes[_i].tet_count);
  ck_assert_near(q.volume, meshes[_i].volume, meshes[_i].tolerance);
  ck_assert_double_gt(q.min_dihedral_degrees, 8);
  ck_assert_int_eq(q.component_count, 1);
  ck_assert_int_eq(q.coincident_vertex_count + q.pinch_edge_count + q.pinch_vertex_count, 0);
  fem_mesh_destroy(&mesh);
}
END_TEST

// A group of what is left of all surfaces when others are taken away, whatever signs gmsh gives to them.
START_TEST(the_rest_of_a_boundary_is_a_group) {
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, MESHES "halfspace.geo", NULL, NULL));
  const FemMeshGroup *outer = group_of(&mesh, "outer");
  ck_assert_int_gt(outer->vertex_count, 20);
  for (int k = 0; k < outer->vertex_count; k++) {
    const double *x = mesh.rest + 3 * (size_t)outer->vertices[k];
    ck_assert_near(sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), 20, 1e-9);
  }
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(tetgen_files_may_count_from_zero_and_hold_comments_and_attributes) {
  put("a.node", NODES), put("a.ele", "1 4 2\n0  0 1 2 3  8 9\n# the end");
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.node"), NULL, NULL));
  ck_assert_int_eq(mesh.vertex_count, 4);
  ck_assert_int_eq(mesh.group_count, 0);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(tetgen_files_in_capitals_belong_together) {
  put("B.NODE", NODES), put("B.ELE", "1 4 0\n0  0 1 2 3\n");
  const char *names[] = {"B.NODE", "B.ELE"};
  for (int k = 0; k < 2; k++) {
    FemMesh mesh;
    ck_assert_ok(fem_mesh_read(&mesh, scratch(names[k]), NULL, NULL));
    ck_assert_int_eq(mesh.vertex_count, 4);
    fem_mesh_destroy(&mesh);
  }
}
END_TEST

// Reading says that it turned an element: once, however many bodies are made of the file.
START_TEST(a_file_of_several_bodies_is_read_once) {
  char command[512], count[8] = "";
  put("a.node", "4 3 0 0\n1 0 0 0\n2 0 1 0\n3 1 0 0\n4 0 0 1\n"), put("a.ele", "1 4 0\n1 1 2 3 4\n");
  put("three.yaml", "time: {end: 1}\nbodies:\n"
                    "  - {name: a, mesh: a.ele, material: {young: 1, poisson: 0, density: 1}}\n"
                    "  - {name: b, mesh: a.ele, material: {young: 1, poisson: 0, density: 1}, place: "
                    "{translate: [3, 0, 0]}}\n"
                    "  - {name: c, mesh: a.ele, material: {young: 1, poisson: 0, density: 1}, place: "
                    "{translate: [6, 0, 0]}}\n");
  snprintf(command, sizeof command, "%s check %s 2>&1 | grep -c 'orientation was corrected: 1'",
           TETLAP_PROGRAM, scratch("three.yaml"));
  FILE *pipe = popen(command, "r");
  ck_assert_ptr_nonnull(fgets(count, sizeof count, pipe));
  ck_assert_int_eq(pclose(pipe), 0);
  ck_assert_str_eq(count, "1\n");
  snprintf(command, sizeof command, "%s check %s | grep -q '36 displacements'", TETLAP_PROGRAM,
           scratch("three.yaml"));
  ck_assert_int_eq(system(command), 0);
}
END_TEST

int main(void) {
  // Loaded once for all tests, each of which reads in a process of its own.
  FemMeshGmshLibrary gmsh;
  if (fem_mesh_gmsh_library_load(&gmsh) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("mesh_read");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_loop_test(cases, every_format_gives_the_same_box, 0, 10);
  tcase_add_loop_test(cases, physical_groups_become_vertex_groups, 0, 5);
  tcase_add_test(cases, physical_volumes_hold_their_tetrahedra);
  tcase_add_test(cases, references_and_markers_become_groups_where_there_are_no_names);
  tcase_add_test(cases, what_is_written_is_read_back_exactly);
  tcase_add_test(cases, orientation_is_repaired_and_unused_vertices_are_dropped);
  tcase_add_test(cases, a_count_beside_its_word_is_read);
  tcase_add_test(cases, a_closed_surface_is_filled);
  tcase_add_loop_test(cases, meshing_twice_gives_the_same_mesh, 0, 3);
  tcase_add_loop_test(cases, our_meshes_are_what_their_readme_says, 0, 8);
  tcase_add_test(cases, the_rest_of_a_boundary_is_a_group);
  tcase_add_test(cases, tetgen_files_may_count_from_zero_and_hold_comments_and_attributes);
  tcase_add_test(cases, tetgen_files_in_capitals_belong_together);
  tcase_add_test(cases, a_file_of_several_bodies_is_read_once);
  return suite_run("mesh_read", cases, 60);
}
