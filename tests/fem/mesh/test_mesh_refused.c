// SPDX-License-Identifier: GPL-3.0-or-later
// Reading meshes: every refusal with its message, damaged files, no memory.
#include "mesh_files.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/mesh/reader/gmsh_library.h"

START_TEST(faults_are_told_in_the_numbers_of_the_file) {
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "7 4 2 1 1 11 12 13 14\n9 4 2 1 1 12 12 13 15\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "element 9 has vertex 12 twice", "remove", NULL);
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "7 4 2 1 1 11 12 13 14\n9 4 2 1 1 14 12 13 11\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "elements 7 and 9 have the same four vertices", "remove",
                 NULL);
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "7 4 2 1 1 11 12 13 14\n9 4 2 1 1 11 12 13 16\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "elements 7 and 9 lie on the same side", "11, 12, 13",
                 "mesh anew", NULL);
  put("a.msh",
      MSH_NODES MSH_ELEMENTS(3, "7 4 2 1 1 11 12 13 14\n8 4 2 1 1 11 12 13 15\n9 4 2 1 1 11 12 13 16\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "11, 12, 13 belongs to 3 elements (7, 8, 9)", "remove",
                 NULL);
  put("a.msh", MSH_NODES MSH_ELEMENTS(1, "7 4 2 1 1 11 12 14 15\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "element 7 at (0.25, 0, 0) has zero volume", "remove", NULL);
  put("a.msh", MSH_NODES MSH_ELEMENTS(1, "7 4 2 1 1 11 12 13 99\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "gmsh could not read it", "99", NULL);
}
END_TEST

START_TEST(a_coordinate_that_is_not_a_number_is_refused) {
  put("a.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 nan 1 0\n4 0 0 1\n$EndNodes\n"
      "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n");
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "vertex 3", "nan", "finite", NULL);
}
END_TEST

START_TEST(other_elements_are_refused_by_name) {
  put("a.geo",
      "Point(1)={0,0,0,1}; Extrude{1,0,0}{Point{1};Layers{1};Recombine;}"
      "Extrude{0,1,0}{Curve{1};Layers{1};Recombine;} Extrude{0,0,1}{Surface{5};Layers{1};Recombine;}\n");
  expect_refusal(STATUS_INPUT, scratch("a.geo"), "'Hexahedron 8'", "tetrahedra of 4 or 10",
                 "no recombination", NULL);
  put("a.geo",
      "SetFactory(\"OpenCASCADE\"); Box(1)={0,0,0,1,1,1}; Mesh.ElementOrder=3; Mesh.MeshSizeMin=1;\n");
  expect_refusal(STATUS_INPUT, scratch("a.geo"), "'Tetrahedron 20'", "element order 1 or 2", NULL);
  put("a.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 "
                "0\n1 0 1 0\n"
                "1 1 1 0\n0 1 1 0\nHexahedra\n1\n1 2 3 4 5 6 7 8 1\nEnd\n");
  expect_refusal(STATUS_INPUT, scratch("a.mesh"), "1 Hexahedra", "tetrahedra of 4 or 10", NULL);
  put("a.vtk", "# vtk DataFile Version 2.0\nhex\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n0 0 0 1 "
               "0 0 1 1 0 0 1 0\n"
               "0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n");
  expect_refusal(STATUS_INPUT, scratch("a.vtk"), "cell 0 is a hexahedron",
                 "only tetrahedra (types 10 and 24)", NULL);
  // A triquadratic pyramid is a volume, too, though its number lies between those of curves and faces.
  put("a.vtk", "# vtk DataFile Version 2.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 "
               "0 0 0 1 0 0 0 1\nCELLS 2 10\n4 0 1 2 3\n4 0 1 2 3\nCELL_TYPES 2\n10\n37\n");
  expect_refusal(STATUS_INPUT, scratch("a.vtk"), "cell 1 is a volume cell (VTK type 37)", NULL);
}
END_TEST

START_TEST(a_surface_in_a_volume_format_is_told_what_to_do) {
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "1 2 2 1 1 11 12 13\n2 2 2 1 1 11 12 14\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "no tetrahedra, only a surface of 2 triangles", ".stl",
                 "mesh its volume first", NULL);
  put("a.msh", MSH_NODES MSH_ELEMENTS(0, ""));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "has no tetrahedra", ".stl or .geo", NULL);
}
END_TEST

START_TEST(a_file_that_is_not_there_is_an_io_error) {
  expect_refusal(STATUS_IO, "/no/such/file.msh", "No such file", NULL);
  expect_refusal(STATUS_IO, "/no/such/file.node", "No such file", NULL);
  put("a.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
  FemMesh mesh;
  ck_assert_int_eq(fem_mesh_read(&mesh, scratch("a.node"), NULL, NULL), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(), "a.ele"));
  snprintf(directory + strlen(directory), 8, ".stl");
  ck_assert_int_eq(mkdir(directory, 0700), 0);
  expect_refusal(STATUS_IO, directory, "is a directory", NULL);
  rmdir(directory);
  *strrchr(directory, '.') = 0;
}
END_TEST

START_TEST(formats_of_others_are_told_the_converter) {
  expect_refusal(STATUS_INPUT, "thing.vtu", "meshio convert thing.vtu mesh.msh", NULL);
  expect_refusal(STATUS_INPUT, "thing.inp", "meshio convert thing.inp mesh.msh", NULL);
  expect_refusal(STATUS_INPUT, "thing.xdmf", "meshio convert", NULL);
}
END_TEST

START_TEST(an_unknown_ending_is_told_the_known_ones) {
  expect_refusal(STATUS_INPUT, "thing.obj", "ending .obj is not known", ".msh", ".mesh", ".vtk", ".stl",
                 ".geo", ".node", NULL);
  expect_refusal(STATUS_INPUT, "some.dir/thing", "ending is missing", NULL);
}
END_TEST

START_TEST(empty_and_foreign_files_are_refused) {
  const char *endings[] = {"a.msh", "a.mesh", "a.vtk", "a.stl", "a.geo"};
  for (int k = 0; k < 5; k++) {
    put(endings[k], "");
    expect_refusal(STATUS_INPUT, scratch(endings[k]), "is empty", NULL);
  }
  // gmsh would run this as a script.
  put("a.msh", "Point(1) = {0, 0, 0};\n");
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "does not begin with $MeshFormat", NULL);
  put("a.mesh", "solid\n");
  expect_refusal(STATUS_INPUT, scratch("a.mesh"), "does not begin with MeshVersionFormatted", NULL);
  put("a.vtk", "<VTKFile>\n");
  expect_refusal(STATUS_INPUT, scratch("a.vtk"), "does not begin with '# vtk DataFile Version'", NULL);
  put("a.vtk", "# vtk DataFile Version 5.1\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n");
  expect_refusal(STATUS_INPUT, scratch("a.vtk"), "version 5", "meshio convert", "4.2", NULL);
  put("a.geo", "Point(1) = {0, 0;\n");
  expect_refusal(STATUS_INPUT, scratch("a.geo"), "line 1: syntax error", NULL);
  put("a.stl", "solid nothing\nendsolid\n");
  expect_refusal(STATUS_INPUT, scratch("a.stl"), NULL);
}
END_TEST

static char *replaced(const char *text, const char *old, const char *new) {
  const char *at = strstr(text, old);
  ck_assert_ptr_nonnull(at);
  size_t size = strlen(text) + strlen(new) + 1;
  char *copy = memory_zeroed(size, 1);
  snprintf(copy, size, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
  return copy;
}

START_TEST(a_count_beyond_the_file_is_refused_at_once) {
  // Without a word: gmsh fails or gives up for want of memory, as the allocator has it.
  const struct {
    const char *file, *name, *old, *new, *word;
  } cases[] = {
      {"box.mesh", "a.mesh", "Tetrahedra\n 88", "Tetrahedra\n 2000000000",
       "announces 2000000000 Tetrahedra, but 440 numbers follow"},
      {"box.mesh", "a.mesh", "Vertices\n 40", "Vertices\n 2000000000",
       "announces 2000000000 Vertices, but 160 numbers follow"},
      {"box.mesh", "a.mesh", "Tetrahedra\n 88", "Tetrahedra\n 89", "announces 89 Tetrahedra"},
      {"box.vtk", "a.vtk", "POINTS 40", "POINTS 2000000000", "announces 2000000000 points"},
      {"box.vtk", "a.vtk", "CELLS 118", "CELLS 2000000000", "announces 2000000000 cells"},
      {"box.vtk", "a.vtk", "CELL_TYPES 118", "CELL_TYPES 2000000000", "cell types that it announces"},
      {"box_22.msh", "a.msh", "$Nodes\n40", "$Nodes\n2000000000", ""},
      {"box_22.msh", "a.msh", "$Elements\n118", "$Elements\n2000000000", ""},
      {"box_41.msh", "a.msh", "0 1 0 1\n1\n", "0 1 0 2000000000\n1\n", ""},
      {"box_41.msh", "a.msh", "0 1 15 1\n1 1", "0 1 15 2000000000\n1 1", ""},
      {"box.node", "a.node", "40 3 0 1", "400000000 3 0 1", "is it complete"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char path[256], *text;
    size_t size;
    snprintf(path, sizeof path, DATA "%s", cases[k].file);
    ck_assert_ok(file_read(path, &text, &size));
    char *changed = replaced(text, cases[k].old, cases[k].new);
    put(cases[k].name, changed);
    expect_refusal(STATUS_INPUT, scratch(cases[k].name), cases[k].word, NULL);
    memory_free(text), memory_free(changed);
  }
}
END_TEST

// Wherever a file is cut, it is refused, unless only what follows the mesh was lost.
START_TEST(a_truncated_file_is_refused_or_whole) {
  const char *files[] = {"box_22.msh", "box_22_binary.msh", "box_41.msh", "box_41_binary.msh",
                         "box.mesh",   "box.vtk",           "box.stl"};
  const char *names[] = {"a.msh", "a.msh", "a.msh", "a.msh", "a.mesh", "a.vtk", "a.stl"};
  enum { CUTS = 12 };
  char path[256], *bytes;
  size_t size;
  snprintf(path, sizeof path, DATA "%s", files[_i]);
  ck_assert_ok(file_read(path, &bytes, &size));
  int refused = 0;
  for (size_t k = 0; k < CUTS; k++) {
    put_bytes(names[_i], bytes, size * k / CUTS);
    FemMesh mesh;
    FemMeshQuality q;
    Status status = fem_mesh_read(&mesh, scratch(names[_i]), NULL, NULL);
    if (status == STATUS_OK) {
      ck_assert_ok(fem_mesh_quality(&mesh, &q));
      ck_assert_near(q.volume, 0.006, 0.006e-12);
    } else {
      ck_assert_int_eq(status, STATUS_INPUT);
      refused++;
    }
    fem_mesh_destroy(&mesh);
  }
  ck_assert_int_ge(refused, CUTS - 2);
  memory_free(bytes);
}
END_TEST

// Bytes changed at random: refused or read, but never a crash, and what is read keeps its promises.
START_TEST(a_damaged_file_never_crashes_the_program) {
  const char *files[] = {"box_22_binary.msh", "box_41_binary.msh", "box.vtk",
                         "box.mesh",          "box.stl",           "box_41.msh"};
  const char *names[] = {"a.msh", "a.msh", "a.vtk", "a.mesh", "a.stl", "a.msh"};
  char path[256], *bytes;
  size_t size;
  snprintf(path, sizeof path, DATA "%s", files[_i]);
  ck_assert_ok(file_read(path, &bytes, &size));
  Random random = random_seeded(11, (uint64_t)_i);
  for (int k = 0; k < 10; k++) {
    char *damaged = memory_copy(bytes, size, 1);
    for (int n = 1 + random_below(&random, 3); n > 0; n--)
      damaged[random_below(&random, (int)size)] =
          (char)(random_below(&random, 2) ? '9' : random_below(&random, 256));
    put_bytes(names[_i], damaged, size);
    memory_free(damaged);
    FemMesh mesh;
    Status status = fem_mesh_read(&mesh, scratch(names[_i]), NULL, NULL);
    ck_assert(status == STATUS_OK || status == STATUS_INPUT || status == STATUS_MEMORY);
    if (status) ck_assert_msg(strncmp(status_message(), scratch(names[_i]), 10) == 0, "%s", status_message());
    for (int t = 0; t < mesh.tet_count; t++)
      for (int c = 0; c < 4; c++) ck_assert(mesh.tets[t][c] >= 0 && mesh.tets[t][c] < mesh.vertex_count);
    fem_mesh_destroy(&mesh);
  }
  memory_free(bytes);
}
END_TEST

START_TEST(a_surface_that_encloses_nothing_is_refused) {
  put("a.stl", "solid t\n" FACET(O, Y, X) FACET(O, X, Z) FACET(O, Z, Y) "endsolid t\n");
  expect_refusal(STATUS_INPUT, scratch("a.stl"), "surface is open", "only one triangle: 3", "close the holes",
                 NULL);
  put("a.stl",
      "solid t\n" FACET(O, Y, X) FACET(O, X, Z) FACET(O, Z, Y) FACET(X, Y, Z) FACET(O, X, "0 -1 0")
          FACET(O, "0 -1 0", "0 0 -1") FACET(O, "0 0 -1", X) FACET(X, "0 0 -1", "0 -1 0") "endsolid t\n");
  expect_refusal(STATUS_INPUT, scratch("a.stl"), "not manifold", "more than two triangles: 1",
                 "(0, 0, 0) to (1, 0, 0)", NULL);
  put("a.stl", "solid t\n" FACET(O, Y, X) FACET(O, X, Z) FACET(O, Z, Y) FACET(X, Y, Z)
                   FACET("5 0 0", "5 1 0", "6 0 0") FACET("5 0 0", "6 0 0", "5 0 1")
                       FACET("5 0 0", "5 0 1", "5 1 0") FACET("6 0 0", "5 1 0", "5 0 1") "endsolid t\n");
  expect_refusal(STATUS_INPUT, scratch("a.stl"), "2 separate shells", "one file for each", NULL);
}
END_TEST

START_TEST(a_surface_that_crosses_itself_is_refused) {
  // A prism whose top vertex is pushed out through its bottom.
  put("a.stl", "solid t\n" FACET(O, Y, X) FACET(O, X, Z) FACET(O, Z, Y) FACET(X, "0.2 0.2 -1", Z)
                   FACET(Y, Z, "0.2 0.2 -1") FACET(X, Y, "0.2 0.2 -1") "endsolid t\n");
  expect_refusal(STATUS_INPUT, scratch("a.stl"), "gmsh could not mesh it", NULL);
}
END_TEST

START_TEST(a_size_is_checked_before_anything_is_meshed) {
  const double wrong[] = {-1, NAN, INFINITY};
  FemMesh mesh;
  for (int k = 0; k < 3; k++) {
    ck_assert_int_eq(fem_mesh_read(&mesh, DATA "box.geo", &(FemMeshOptions){.size = wrong[k]}, NULL),
                     STATUS_INPUT);
    ck_assert_ptr_nonnull(strstr(status_message(), "give a positive length"));
  }
  ck_assert_int_eq(fem_mesh_read(&mesh, DATA "box.geo", &(FemMeshOptions){.size = 1e-9}, NULL), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "would make about"));
  ck_assert_ptr_nonnull(strstr(status_message(), "0.1 × 0.2 × 0.3"));
  ck_assert_int_eq(fem_mesh_read(&mesh, DATA "box_41.msh", &(FemMeshOptions){.size = 0.1}, NULL),
                   STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "is meshed already"));
}
END_TEST

static void expect_tetgen_refusal(const char *nodes, const char *tets, const char *place, const char *words) {
  put("a.node", nodes), put("a.ele", tets);
  FemMesh mesh;
  ck_assert_int_eq(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), place) != NULL, "'%s' lacks '%s'", status_message(), place);
  ck_assert_msg(strstr(status_message(), words) != NULL, "'%s' lacks '%s'", status_message(), words);
}

START_TEST(tetgen_faults_are_told_with_their_line) {
  expect_tetgen_refusal("", "1 4 0\n0 0 1 2 3\n", "a.node:1:", "expected");
  expect_tetgen_refusal("4 2 0 0\n", "", "a.node:1:", "the dimension is 2; it must be 3");
  expect_tetgen_refusal("1 3 0 0\n0 0 zero 0\n", "", "a.node:2:", "a coordinate expected, not 'zero'");
  expect_tetgen_refusal("1 3 0 0\n0 0 0\n", "", "a.node:2:", "the line or the file ends");
  expect_tetgen_refusal("2 3 0 0\n0 0 0 0\n5 0 0 1\n", "",
                        "a.node:3:", "number of a node is 5; it must be 1");
  expect_tetgen_refusal(NODES, "1 7 0\n0 0 1 2 3 0 1 2\n", "a.ele:1:", "4 or 10");
  expect_tetgen_refusal(NODES, "1 4 0\n0 0 1 2 4\n", "a.ele:2:", "4; it must lie in 0 … 3");
  expect_tetgen_refusal(NODES, "2 4 0\n0 0 1 2 3\n", "a.ele:", "complete");
  expect_tetgen_refusal(NODES, "99999999999 4 0\n", "a.ele:1:", "must lie in");
  expect_tetgen_refusal(NODES, "1e3 4 0\n", "a.ele:1:", "not '1e3'");
  expect_tetgen_refusal(NODES, "1 4 0\n0 0 1 2 2\n", "a.ele: ", "element 0 has vertex 2 twice");
  expect_tetgen_refusal("4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 inf\n", "1 4 0\n1 1 2 3 4\n",
                        "a.ele: ", "vertex 4 has the position");
}
END_TEST

// Fails the k-th allocation for every k until none is left to fail; leaks are the sanitizer's to find.
START_TEST(every_failed_allocation_is_an_error) {
  const char *paths[] = {DATA "box.node", DATA "box_41.msh"};
  const int least[] = {10, 8};
  int k = 1;
  for (Status status = STATUS_MEMORY; status != STATUS_OK; k++) {
    FemMesh mesh;
    memory_fail_at(k);
    status = fem_mesh_read(&mesh, paths[_i], NULL, NULL);
    memory_fail_at(0);
    ck_assert_msg(status == STATUS_OK || status == STATUS_MEMORY, "k = %d: %s", k, status_message());
    ck_assert_int_lt(k, 200);
    fem_mesh_destroy(&mesh);
  }
  ck_assert_int_gt(k, least[_i]);
}
END_TEST

int main(void) {
  // Loaded once for all tests, each of which reads in a process of its own.
  FemMeshGmshLibrary gmsh;
  if (fem_mesh_gmsh_library_load(&gmsh) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("mesh_refused");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_test(cases, faults_are_told_in_the_numbers_of_the_file);
  tcase_add_test(cases, a_coordinate_that_is_not_a_number_is_refused);
  tcase_add_test(cases, other_elements_are_refused_by_name);
  tcase_add_test(cases, a_surface_in_a_volume_format_is_told_what_to_do);
  tcase_add_test(cases, a_file_that_is_not_there_is_an_io_error);
  tcase_add_test(cases, formats_of_others_are_told_the_converter);
  tcase_add_test(cases, an_unknown_ending_is_told_the_known_ones);
  tcase_add_test(cases, empty_and_foreign_files_are_refused);
  tcase_add_test(cases, a_count_beyond_the_file_is_refused_at_once);
  tcase_add_loop_test(cases, a_truncated_file_is_refused_or_whole, 0, 7);
  tcase_add_loop_test(cases, a_damaged_file_never_crashes_the_program, 0, 6);
  tcase_add_test(cases, a_surface_that_encloses_nothing_is_refused);
  tcase_add_test(cases, a_surface_that_crosses_itself_is_refused);
  tcase_add_test(cases, a_size_is_checked_before_anything_is_meshed);
  tcase_add_test(cases, tetgen_faults_are_told_with_their_line);
  tcase_add_loop_test(cases, every_failed_allocation_is_an_error, 0, 2);
  return suite_run("mesh_refused", cases, 60);
}
