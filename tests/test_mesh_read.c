// SPDX-License-Identifier: GPL-3.0-or-later
// Reading meshes: one box in every format, every refusal with its message, meshing in place, readers that
// crash.
#include "suite.h"

#include <errno.h>
#include <omp.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "app/command/mesh.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/random.h"
#include "fem/mesh/mesh.h"
#include "fem/mesh/reader/gmsh_library.h"
#include "fem/mesh/reader/tetgen.h"
#include "fem/mesh/reader/worker.h"

#define DATA TETLAP_SOURCE_DIR "/tests/data/mesh/"
#define MESHES TETLAP_SOURCE_DIR "/meshes/"

static char directory[64];

// A file in the test's own directory; overwritten by the next of the same name.
static char *scratch(const char *name) {
  static char path[160];
  snprintf(path, sizeof path, "%s/%s", directory, name);
  return path;
}

static char *put_bytes(const char *name, const void *bytes, size_t size) {
  char *path = scratch(name);
  FILE *stream = fopen(path, "wb");
  ck_assert_ptr_nonnull(stream);
  ck_assert_uint_eq(fwrite(bytes, 1, size, stream), size);
  fclose(stream);
  return path;
}

static char *put(const char *name, const char *text) {
  return put_bytes(name, text, strlen(text));
}

static void make_directory(void) {
  snprintf(directory, sizeof directory, "/tmp/tetlap_mesh_XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(directory));
}

static void remove_directory(void) {
  static const char *const names[] = {"a.msh", "a.mesh", "a.vtk", "a.stl", "a.geo", "a.node", "a.ele", "out"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) unlink(scratch(names[k]));
  rmdir(directory);
}

// The file must be refused with a message that begins with its name and holds all the words given.
static void expect_refusal(Status code, const char *path, ...) {
  FemMesh mesh;
  Status status = fem_mesh_read(&mesh, path, NULL, NULL);
  ck_assert_msg(status == code, "%s: %d instead of %d: %s", path, (int)status, (int)code, status_message());
  ck_assert_msg(strncmp(status_message(), path, strlen(path)) == 0, "'%s' does not begin with the file",
                status_message());
  va_list words;
  va_start(words, path);
  for (const char *word; (word = va_arg(words, const char *));)
    ck_assert_msg(strstr(status_message(), word) != NULL, "'%s' lacks '%s'", status_message(), word);
  va_end(words);
  ck_assert_ptr_null(mesh.rest);
}

static const FemMeshGroup *group_of(const FemMesh *mesh, const char *name) {
  for (int g = 0; g < mesh->group_count; g++)
    if (strcmp(mesh->groups[g].name, name) == 0) return &mesh->groups[g];
  ck_abort_msg("there is no group '%s'", name);
  return NULL;
}

// All vertices of the group have that coordinate, and there are as many as the mesh has there.
static void expect_plane(const FemMesh *mesh, const char *name, int component, double value) {
  const FemMeshGroup *group = group_of(mesh, name);
  int count = 0;
  for (int v = 0; v < mesh->vertex_count; v++) count += fabs(mesh->rest[3 * v + component] - value) < 1e-12;
  ck_assert_int_gt(count, 3);
  ck_assert_int_eq(group->vertex_count, count);
  for (int k = 0; k < count; k++)
    ck_assert_near(mesh->rest[3 * group->vertices[k] + component], value, 1e-12);
}

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
  ck_assert_ok(fem_mesh_write_medit(&mesh, scratch("a.mesh")));
  ck_assert_ok(fem_mesh_read(&again, scratch("a.mesh"), NULL, NULL));
  ck_assert_int_eq(again.vertex_count, mesh.vertex_count);
  ck_assert_int_eq(again.tet_count, mesh.tet_count);
  ck_assert_mem_eq(again.rest, mesh.rest, 3 * (size_t)mesh.vertex_count * sizeof(double));
  ck_assert_mem_eq(again.tets, mesh.tets, (size_t)mesh.tet_count * sizeof *mesh.tets);
  fem_mesh_destroy(&mesh), fem_mesh_destroy(&again);
}
END_TEST

// One tetrahedron, a vertex that nobody uses, and room for a second element.
#define MSH_NODES                                                                                            \
  "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n11 0 0 0\n12 1 0 0\n13 0 1 0\n14 0 0 1\n15 0 0 -1\n16 "  \
  "5 5 5\n$EndNodes\n"
#define MSH_ELEMENTS(count, lines) "$Elements\n" #count "\n" lines "$EndElements\n"

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

START_TEST(faults_are_told_in_the_numbers_of_the_file) {
  put("a.msh", MSH_NODES MSH_ELEMENTS(2, "7 4 2 1 1 11 12 13 14\n9 4 2 1 1 12 12 13 15\n"));
  expect_refusal(STATUS_INPUT, scratch("a.msh"), "element 9 names vertex 12 twice", "remove", NULL);
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

#define FACET(a, b, c)                                                                                       \
  "facet normal 0 0 0\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define O "0 0 0"
#define X "1 0 0"
#define Y "0 1 0"
#define Z "0 0 1"

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
  ck_assert_double_gt(fem_mesh_min_dihedral(&a), 8);
  fem_mesh_destroy(&a), fem_mesh_destroy(&b);
}
END_TEST

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
  ck_assert_int_eq(mesh.vertex_count, meshes[_i].vertex_count);
  ck_assert_int_eq(mesh.tet_count, meshes[_i].tet_count);
  ck_assert_near(q.volume, meshes[_i].volume, meshes[_i].tolerance);
  ck_assert_double_gt(q.min_dihedral_degrees, 8);
  ck_assert_int_eq(q.component_count, 1);
  ck_assert_int_eq(q.coincident_vertex_count + q.pinch_edge_count + q.pinch_vertex_count, 0);
  fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(reading_leaves_threads_signals_and_output_alone) {
  struct sigaction before, after;
  omp_set_num_threads(3);
  ck_assert_int_eq(sigaction(SIGINT, NULL, &before), 0);
  fflush(stdout), fflush(stderr);
  int saved_out = dup(STDOUT_FILENO), saved_error = dup(STDERR_FILENO);
  FILE *catcher = fopen(scratch("out"), "w+");
  dup2(fileno(catcher), STDOUT_FILENO), dup2(fileno(catcher), STDERR_FILENO);
  FemMesh mesh;
  put("a.geo", "Printf(\"shouting\"); Merge \"nothing.stl\"; "
               "Point(1)={0,0,0};\n");
  Status refused = fem_mesh_read(&mesh, scratch("a.geo"), NULL, NULL);
  Status read = fem_mesh_read(&mesh, DATA "box.geo", NULL, NULL);
  fflush(stdout), fflush(stderr);
  dup2(saved_out, STDOUT_FILENO), dup2(saved_error, STDERR_FILENO);
  close(saved_out), close(saved_error);
  ck_assert_int_eq(refused, STATUS_INPUT);
  ck_assert_ok(read);
  fseek(catcher, 0, SEEK_END);
  ck_assert_int_eq(ftell(catcher), 0);
  fclose(catcher);
  ck_assert_int_eq(omp_get_max_threads(), 3);
  ck_assert_int_eq(sigaction(SIGINT, NULL, &after), 0);
  ck_assert(before.sa_handler == after.sa_handler);
  fem_mesh_destroy(&mesh);
}
END_TEST

// Readers that do what gmsh has been seen to do.
static Status read_and_crash(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  raise(SIGSEGV);
  return STATUS_OK;
}
static Status read_and_exit(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  _exit(3);
}
static Status read_for_ever(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  while (pause() < 0) continue;
  return STATUS_OK;
}
static Status read_and_be_interrupted(FemMeshSource *source, const char *path,
                                      const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  raise(SIGINT);
  return STATUS_OK;
}
static Status read_too_much(FemMeshSource *source, const char *path, const FemMeshOptions *options) {
  (void)source, (void)path, (void)options;
  char *block = malloc((size_t)1 << 28);
  if (!block) return status_fail(STATUS_INPUT, "no room for a quarter of a gigabyte");
  memset(block, 1, (size_t)1 << 28);
  free(block);
  return status_fail(STATUS_INPUT, "there was room");
}

// The address sanitizer's allocator does not survive a limit.
#ifdef __SANITIZE_ADDRESS__
enum { CAN_LIMIT_MEMORY = 0 };
#else
enum { CAN_LIMIT_MEMORY = 1 };
#endif

START_TEST(a_reader_that_wants_too_much_memory_gets_none) {
  FemMeshSource source;
  if (!CAN_LIMIT_MEMORY) return;
  ck_assert_int_eq(fem_mesh_worker_run(read_too_much, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "there was room"));
  ck_assert_int_eq(fem_mesh_worker_run(read_too_much, &source, "x", NULL, 1 << 20), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "no room"));
}
END_TEST

START_TEST(a_reader_that_crashes_is_a_message) {
  FemMeshSource source;
  ck_assert_int_eq(fem_mesh_worker_run(read_and_crash, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "crashed"));
  ck_assert_int_eq(fem_mesh_worker_run(read_and_exit, &source, "x", NULL, 0), STATUS_INPUT);
  ck_assert_ptr_nonnull(strstr(status_message(), "exit code 3"));
  ck_assert_int_eq(fem_mesh_worker_run(read_and_be_interrupted, &source, "x", NULL, 0), STATUS_INTERRUPTED);
  // No child is left behind.
  ck_assert_int_eq(waitpid(-1, NULL, WNOHANG), -1);
  ck_assert_int_eq(errno, ECHILD);
}
END_TEST

static volatile sig_atomic_t alarm_count;
static void count_alarm(int number) {
  (void)number;
  alarm_count = alarm_count + 1;
}

START_TEST(a_signal_that_we_handle_ends_a_reader_that_runs_on) {
  struct sigaction action = {.sa_handler = count_alarm};
  sigaction(SIGALRM, &action, NULL);
  // Repeated, so that one that comes before the wait begins is not the only one.
  timer_t timer;
  ck_assert_int_eq(timer_create(CLOCK_MONOTONIC, NULL, &timer), 0);
  timer_settime(timer, 0, &(struct itimerspec){{0, 50000000}, {0, 50000000}}, NULL);
  FemMeshSource source;
  Status status = fem_mesh_worker_run(read_for_ever, &source, "x", NULL, 0);
  timer_delete(timer);
  ck_assert_int_gt(alarm_count, 0);
  ck_assert_int_eq(status, STATUS_INTERRUPTED);
  ck_assert_int_eq(waitpid(-1, NULL, WNOHANG), -1);
}
END_TEST

#define NODES "# nodes\n4 3 1 0\n0 0 0 0 .5\n1 1 0 0 .5 # second\n\n2 0 1 0 .5\n3 0 0 1 .5\n"

static void expect_tetgen_refusal(const char *nodes, const char *tets, const char *place, const char *words) {
  put("a.node", nodes), put("a.ele", tets);
  FemMesh mesh;
  ck_assert_int_eq(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), place) != NULL, "'%s' lacks '%s'", status_message(), place);
  ck_assert_msg(strstr(status_message(), words) != NULL, "'%s' lacks '%s'", status_message(), words);
}

START_TEST(tetgen_files_may_count_from_zero_and_hold_comments_and_attributes) {
  put("a.node", NODES), put("a.ele", "1 4 2\n0  0 1 2 3  8 9\n# the end");
  FemMesh mesh;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.node"), NULL, NULL));
  ck_assert_int_eq(mesh.vertex_count, 4);
  ck_assert_int_eq(mesh.group_count, 0);
  fem_mesh_destroy(&mesh);
}
END_TEST

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
  expect_tetgen_refusal(NODES, "1 4 0\n0 0 1 2 2\n", "a.ele: ", "element 0 names vertex 2 twice");
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

// Runs the subcommand with its output in a file; `*text` is owned by the caller.
static int run_command(int count, char **arguments, char **text) {
  fflush(stdout);
  int saved = dup(STDOUT_FILENO);
  FILE *catcher = fopen(scratch("out"), "w");
  dup2(fileno(catcher), STDOUT_FILENO);
  int code = app_command_mesh.run(count, arguments);
  fflush(stdout);
  dup2(saved, STDOUT_FILENO);
  close(saved), fclose(catcher);
  size_t size;
  ck_assert_ok(file_read(scratch("out"), text, &size));
  return code;
}

START_TEST(the_command_says_what_a_mesh_holds) {
  char *text;
  char *plain[] = {"tetlap mesh", MESHES "block.msh", NULL},
       *json[] = {"tetlap mesh", "--json", MESHES "block.msh", NULL};
  ck_assert_int_eq(run_command(2, plain, &text), 0);
  const char *words[] = {"vertices     145", "tetrahedra   399", "0.008 m³",        "dihedral",
                         "min det",          "bottom (31)",      "nothing is wrong"};
  for (size_t k = 0; k < sizeof words / sizeof *words; k++)
    ck_assert_msg(strstr(text, words[k]) != NULL, "'%s' lacks '%s'", text, words[k]);
  memory_free(text);
  ck_assert_int_eq(run_command(3, json, &text), 0);
  const char *keys[] = {"\"vertices\": 145", "\"tetrahedra\": 399", "\"min_dihedral_degrees\"",
                        "\"remarks\": []"};
  for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
    ck_assert_msg(strstr(text, keys[k]) != NULL, "'%s' lacks '%s'", text, keys[k]);
  memory_free(text);
}
END_TEST

START_TEST(the_command_says_what_is_wrong) {
  put("a.ele", "1 4 0\n1 1 3 2 4\n");
  char path[160], *text, *plain[] = {"tetlap mesh", path, NULL};
  snprintf(path, sizeof path, "%s",
           put("a.node", "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 .2 .2 .02\n5 9 9 9\n"));
  ck_assert_int_eq(run_command(2, plain, &text), 0);
  ck_assert_ptr_nonnull(strstr(text, "inside out and have been turned: 1"));
  ck_assert_ptr_nonnull(strstr(text, "smallest dihedral angle is"));
  ck_assert_ptr_nonnull(strstr(text, "have been left out: 1"));
  memory_free(text);
  char *missing[] = {"tetlap mesh", "/no/such.msh", NULL};
  ck_assert_int_eq(run_command(2, missing, &text), 74);
  memory_free(text);
}
END_TEST

// gmsh's library is not installed while this is set (--wrap in tests/CMakeLists.txt).
static bool gmsh_is_missing;
void *__real_dlopen(const char *name, int flags);
void *__wrap_dlopen(const char *name, int flags);
char *__real_dlerror(void);
char *__wrap_dlerror(void);

void *__wrap_dlopen(const char *name, int flags) {
  return gmsh_is_missing ? NULL : __real_dlopen(name, flags);
}

char *__wrap_dlerror(void) {
  static char reason[] = "libgmsh.so: no such file";
  return gmsh_is_missing ? reason : __real_dlerror();
}

START_TEST(without_gmsh_a_message_says_what_to_install_and_tetgen_files_are_read) {
  FemMesh mesh;
  gmsh_is_missing = true;
  ck_assert_int_eq(fem_mesh_read(&mesh, TETLAP_SOURCE_DIR "/meshes/block.msh", NULL, NULL), STATUS_IO);
  ck_assert_ptr_nonnull(strstr(status_message(),
                               "block.msh: gmsh, which reads this, cannot be loaded "
                               "(libgmsh.so: no such file); install gmsh's library, version 4."));
  put("a.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"), put("a.ele", "1 4 0\n1 1 2 3 4\n");
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL));
  fem_mesh_destroy(&mesh);
  gmsh_is_missing = false;
  ck_assert_ok(fem_mesh_read(&mesh, TETLAP_SOURCE_DIR "/meshes/block.msh", NULL, NULL));
  fem_mesh_destroy(&mesh);
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
  snprintf(command, sizeof command, "%s check %s 2>&1 | grep -c 'have been turned: 1'", TETLAP_PROGRAM,
           scratch("three.yaml"));
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
  tcase_add_test(cases, references_and_markers_become_groups_where_there_are_no_names);
  tcase_add_test(cases, what_is_written_is_read_back_exactly);
  tcase_add_test(cases, orientation_is_repaired_and_unused_vertices_are_dropped);
  tcase_add_test(cases, faults_are_told_in_the_numbers_of_the_file);
  tcase_add_test(cases, a_coordinate_that_is_not_a_number_is_refused);
  tcase_add_test(cases, other_elements_are_refused_by_name);
  tcase_add_test(cases, a_surface_in_a_volume_format_is_told_what_to_do);
  tcase_add_test(cases, a_file_that_is_not_there_is_an_io_error);
  tcase_add_test(cases, a_count_beside_its_word_is_read);
  tcase_add_test(cases, formats_of_others_are_told_the_converter);
  tcase_add_test(cases, an_unknown_ending_is_told_the_known_ones);
  tcase_add_test(cases, empty_and_foreign_files_are_refused);
  tcase_add_test(cases, a_count_beyond_the_file_is_refused_at_once);
  tcase_add_loop_test(cases, a_truncated_file_is_refused_or_whole, 0, 7);
  tcase_add_loop_test(cases, a_damaged_file_never_crashes_the_program, 0, 6);
  tcase_add_test(cases, a_closed_surface_is_filled);
  tcase_add_test(cases, a_surface_that_encloses_nothing_is_refused);
  tcase_add_test(cases, a_surface_that_crosses_itself_is_refused);
  tcase_add_test(cases, a_size_is_checked_before_anything_is_meshed);
  tcase_add_loop_test(cases, meshing_twice_gives_the_same_mesh, 0, 3);
  tcase_add_loop_test(cases, our_meshes_are_what_their_readme_says, 0, 8);
  tcase_add_test(cases, reading_leaves_threads_signals_and_output_alone);
  tcase_add_test(cases, a_reader_that_crashes_is_a_message);
  tcase_add_test(cases, a_reader_that_wants_too_much_memory_gets_none);
  tcase_add_test(cases, a_signal_that_we_handle_ends_a_reader_that_runs_on);
  tcase_add_test(cases, tetgen_files_may_count_from_zero_and_hold_comments_and_attributes);
  tcase_add_test(cases, tetgen_faults_are_told_with_their_line);
  tcase_add_loop_test(cases, every_failed_allocation_is_an_error, 0, 2);
  tcase_add_test(cases, without_gmsh_a_message_says_what_to_install_and_tetgen_files_are_read);
  tcase_add_test(cases, a_file_of_several_bodies_is_read_once);
  tcase_add_test(cases, the_command_says_what_a_mesh_holds);
  tcase_add_test(cases, the_command_says_what_is_wrong);
  return suite_run("mesh_read", cases, 60);
}
