// SPDX-License-Identifier: GPL-3.0-or-later
// Files of second-order tetrahedra: whose node is on which edge in every format, what is refused, and what
// bodies of linear and of quadratic elements make of them.
#include "mesh_files.h"
#include "static_solve.h"

#include <string.h>
#include <unistd.h>

#include "app/command/commands.h"
#include "base/files/file.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/vec3.h"
#include "fem/element/quadratic.h"
#include "fem/mesh/edges.h"
#include "fem/mesh/mesh.h"
#include "fem/mesh/reader/gmsh_library.h"
#include "fem/model/build.h"

static FILE *begin(const char *name) {
  FILE *stream = fopen(scratch(name), "w");
  ck_assert_ptr_nonnull(stream);
  return stream;
}

// The unit tetrahedron, corners 0 … 3, and on each edge a node of its own displacement.
static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static Vec3 node_between(int a, int b) {
  int low = a < b ? a : b, high = a < b ? b : a;
  Vec3 middle = vec3_scale(0.5, vec3_add(vec3_at(corners[low]), vec3_at(corners[high])));
  return vec3_add(middle, (Vec3){0.01 * (low + 1), 0.02 * high, -0.005 * (low + 2 * high)});
}

// The files number nodes so: those on edges first (6 of them, as fem_quadratic_edges), then the corners.
static int number_between(int a, int b) {
  for (int k = 0; k < 6; k++) {
    const int *ends = fem_quadratic_edges[k];
    if ((ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a)) return k;
  }
  ck_abort_msg("no edge %d %d", a, b);
  return -1;
}

static int number_of_corner(int a) {
  return 6 + a;
}

static void print_node(FILE *stream, int number) {
  const int *ends = number < 6 ? fem_quadratic_edges[number] : NULL;
  Vec3 x = ends ? node_between(ends[0], ends[1]) : vec3_at(corners[number - 6]);
  fprintf(stream, "%.17g %.17g %.17g", x.x, x.y, x.z);
}

// Ten numbers, counted from `base`: the corners in the order given, then the nodes between them by a format's
// own table of pairs, "01 12 …".
static void print_element(FILE *stream, const int order[4], const char *pairs, int base) {
  for (int k = 0; k < 4; k++) fprintf(stream, " %d", number_of_corner(order[k]) + base);
  for (int k = 0; k < 6; k++)
    fprintf(stream, " %d", number_between(order[pairs[3 * k] - '0'], order[pairs[3 * k + 1] - '0']) + base);
}

// The orders as the formats' documents have them, beside the readers' tables: gmsh reference manual, "Node
// ordering"; VTK File Formats, VTK_QUADRATIC_TETRA; libMeshb's GmfTetrahedraP2; TetGen 1.5 as it writes.
static const char gmsh_pairs[] = "01 12 02 03 23 13", vtk_pairs[] = "01 12 02 03 13 23",
                  tetgen_pairs[] = "23 03 01 12 13 02";

static const char *write_msh_22(const int order[4]) {
  FILE *stream = begin("a.msh");
  fprintf(stream, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n");
  for (int k = 0; k < 10; k++) fprintf(stream, "%d ", 20 + k), print_node(stream, k), fputs("\n", stream);
  fprintf(stream, "$EndNodes\n$Elements\n1\n7 11 2 1 1");
  print_element(stream, order, gmsh_pairs, 20);
  fprintf(stream, "\n$EndElements\n");
  fclose(stream);
  return scratch("a.msh");
}

static const char *write_msh_41(const int order[4]) {
  FILE *stream = begin("a.msh");
  fprintf(stream,
          "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n"
          "$Nodes\n1 10 20 29\n3 1 0 10\n");
  for (int k = 0; k < 10; k++) fprintf(stream, "%d\n", 20 + k);
  for (int k = 0; k < 10; k++) print_node(stream, k), fputs("\n", stream);
  fprintf(stream, "$EndNodes\n$Elements\n1 1 7 7\n3 1 11 1\n7");
  print_element(stream, order, gmsh_pairs, 20);
  fprintf(stream, "\n$EndElements\n");
  fclose(stream);
  return scratch("a.msh");
}

static const char *write_vtk(const int order[4]) {
  FILE *stream = begin("a.vtk");
  fprintf(stream, "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 10 double\n");
  for (int k = 0; k < 10; k++) print_node(stream, k), fputs("\n", stream);
  fprintf(stream, "\nCELLS 1 11\n10");
  print_element(stream, order, vtk_pairs, 0);
  fprintf(stream, "\n\nCELL_TYPES 1\n24\n");
  fclose(stream);
  return scratch("a.vtk");
}

static const char *write_medit(const int order[4]) {
  FILE *stream = begin("a.mesh");
  fprintf(stream, "MeshVersionFormatted 2\nDimension 3\nVertices\n10\n");
  for (int k = 0; k < 10; k++) print_node(stream, k), fputs(" 0\n", stream);
  fprintf(stream, "TetrahedraP2\n1\n");
  print_element(stream, order, vtk_pairs, 1);
  fprintf(stream, " 1\nEnd\n");
  fclose(stream);
  return scratch("a.mesh");
}

static const char *write_tetgen(const int order[4]) {
  FILE *stream = begin("a.node");
  fprintf(stream, "10 3 0 0\n");
  for (int k = 0; k < 10; k++) fprintf(stream, "%d ", 1 + k), print_node(stream, k), fputs("\n", stream);
  fclose(stream);
  stream = begin("a.ele");
  fprintf(stream, "1 10 0\n1");
  print_element(stream, order, tetgen_pairs, 1);
  fputs("\n", stream);
  fclose(stream);
  return scratch("a.ele");
}

typedef const char *(*Writer)(const int order[4]);
static const Writer writers[] = {write_msh_22, write_msh_41, write_vtk, write_medit, write_tetgen};

// Corners keep their order, so after reading they are 0 … 3 again.
static void expect_nodes(const FemMesh *mesh, double scale) {
  for (int v = 0; v < 4; v++)
    for (int c = 0; c < 3; c++) ck_assert_near(mesh->rest[3 * v + c], (c ? 1 : scale) * corners[v][c], 0);
  for (int k = 0; k < 6; k++) {
    Vec3 x = node_between(fem_quadratic_edges[k][0], fem_quadratic_edges[k][1]);
    const double *found = mesh->middles + 3 * k, wanted[3] = {scale * x.x, x.y, x.z};
    for (int c = 0; c < 3; c++) ck_assert_near(found[c], wanted[c], 1e-15);
  }
}

// Right side out and inside out, and mirrored by its placement: the order of nodes must follow each.
START_TEST(every_format_keeps_each_node_on_its_edge) {
  static const int orders[3][4] = {{0, 1, 2, 3}, {2, 1, 0, 3}, {3, 1, 0, 2}};
  for (int o = 0; o < 3; o++) {
    FemMesh mesh;
    FemMeshRepairs repairs;
    ck_assert_ok(fem_mesh_read(&mesh, writers[_i](orders[o]), NULL, &repairs));
    ck_assert_int_eq(repairs.reoriented_tets, o == 1);
    ck_assert_int_eq(repairs.dropped_vertices, 0);
    ck_assert_int_eq(mesh.vertex_count, 4);
    ck_assert_int_eq(mesh.edge_count, 6);
    expect_nodes(&mesh, 1);
    FemPlacement mirror = {.scale = {1, 1, 1}, .axis = {0, 0, 1}};
    mirror.scale[0] = -1;
    ck_assert_ok(fem_mesh_place(&mesh, &mirror));
    expect_nodes(&mesh, -1);
    ck_assert_ok(fem_mesh_make_quadratic(&mesh));
    for (int k = 0; k < 6; k++) {
      int a = mesh.quadratic[0][fem_quadratic_edges[k][0]], b = mesh.quadratic[0][fem_quadratic_edges[k][1]];
      Vec3 x = node_between(a, b);
      const double *found = mesh.rest + 3 * mesh.quadratic[0][4 + k];
      ck_assert_near(found[0], -x.x, 1e-15);
      ck_assert_near(found[1], x.y, 1e-15);
      ck_assert_near(found[2], x.z, 1e-15);
    }
    fem_mesh_destroy(&mesh);
  }
}
END_TEST

// Two tetrahedra on the triangle 1 2 3 with tips 4 and 5; the nodes on its edges are 6, 7, 8.
#define TWO_NODES                                                                                            \
  "16 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n6 .5 0 0\n7 .5 .5 0\n8 0 .5 0\n9 0 0 .5\n"        \
  "10 .5 0 .5\n11 0 .5 .5\n12 0 0 -.5\n13 .5 0 -.5\n14 0 .5 -.5\n15 9 9 9\n16 .5 0 0\n"

START_TEST(nodes_that_do_not_fit_together_are_refused) {
  put("a.node", TWO_NODES);
  put("a.ele", "2 10 0\n1 1 2 3 4  11 9 6 7 10 8\n2 1 3 2 5  13 12 8 7 14 6\n");
  FemMesh mesh;
  FemMeshRepairs repairs;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, &repairs));
  ck_assert_int_eq(mesh.edge_count, 9);
  ck_assert_int_eq(repairs.dropped_vertices, 2);
  FemMeshCurvature curvature;
  ck_assert_ok(fem_mesh_curvature(&mesh, &curvature));
  ck_assert_near(curvature.deviation, 0, 0);
  ck_assert_near(curvature.min_jacobian, 1, 1e-15);
  ck_assert_near(curvature.volume, 1. / 3, 1e-15);
  fem_mesh_destroy(&mesh);
  put("a.ele", "2 10 0\n1 1 2 3 4  11 9 6 7 10 8\n2 1 3 2 5  13 12 8 7 14 16\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "a.ele: elements 1 and 2 have different nodes, 6 and 16",
                 "vertices 1 and 2", "merge", NULL);
  put("a.ele", "2 10 0\n1 1 2 3 4  11 9 6 7 10 8\n2 1 3 2 5  10 12 8 7 14 6\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "vertex 10", "between vertices 2 and 5 in element 2",
                 "on another edge", NULL);
  put("a.ele", "2 10 0\n1 1 2 3 4  11 9 6 7 10 8\n2 1 3 2 5  4 12 8 7 14 6\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "vertex 4", "a corner elsewhere", NULL);
  put("a.ele", "1 10 0\n1 1 2 3 4  11 9 6 7 10 11\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "element 1 has vertex 11 twice", "ten different", NULL);
  put("a.ele", "1 10 0\n1 1 2 3 4  11 9 6 7 10 17\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "a.ele:2:", "17; it must lie in 1 … 16", NULL);
  put("a.ele", "1 9 0\n1 1 2 3 4 11 9 6 7 10\n");
  expect_refusal(STATUS_INPUT, scratch("a.ele"), "a.ele:1: tetrahedra of 9 nodes", "4 or 10", NULL);
}
END_TEST

// In one volume and in two, whichever comes first.
START_TEST(tetrahedra_of_both_orders_in_a_file_are_refused) {
  static const char nodes[] = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n11\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
                              "4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n9 0 .5 .5\n10 .5 0 .5\n"
                              "11 0 0 -1\n$EndNodes\n$Elements\n2\n";
  for (int k = 0; k < 4; k++) {
    char text[512], *at = text + snprintf(text, sizeof text, "%s", nodes);
    for (int e = 1; e <= 2; e++)
      at += e == 1 + k % 2 ? sprintf(at, "%d 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n", e)
                           : sprintf(at, "%d 4 2 1 %d 1 3 2 11\n", e, 1 + k / 2);
    sprintf(at, "$EndElements\n");
    expect_refusal(STATUS_INPUT, put("a.msh", text), "a.msh: has tetrahedra of 4 and of 10 nodes",
                   "one element order", NULL);
  }
}
END_TEST

// The node on edge 13 far beyond the origin: the element turns inside out, its corners do not.
START_TEST(an_element_that_is_inside_out_is_named_and_has_its_corners) {
  put("a.node", "10 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n"
                "9 0 .5 .5\n10 -.4 0 -.4\n");
  put("a.ele", "1 10 0\n1 1 2 3 4  9 8 5 6 10 7\n");
  FemMesh mesh;
  FemMeshCurvature curvature;
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL));
  ck_assert_ok(fem_mesh_curvature(&mesh, &curvature));
  ck_assert(curvature.min_jacobian < 0);
  ck_assert_near(curvature.deviation, 0.9, 1e-15);
  ck_assert_int_eq(fem_mesh_make_quadratic(&mesh), STATUS_INPUT);
  ck_assert_msg(strstr(status_message(), "element 1 at (0, 0, 0)") != NULL, "%s", status_message());
  ck_assert_msg(strstr(status_message(), "at a point of integration") != NULL, "%s", status_message());
  fem_mesh_destroy(&mesh);
  char text[512];
  for (int is_quadratic = 0; is_quadratic < 2; is_quadratic++) {
    snprintf(text, sizeof text,
             "time: {end: 1}\nbodies:\n  - name: one\n    element: %s\n    mesh: %s\n"
             "    material: {law: linear, young: 1, poisson: 0.3, density: 6}\n",
             is_quadratic ? "quadratic" : "linear", scratch("a.ele"));
    SceneRun run = {0};
    ck_assert_ok(scene_text_read("test.yaml", text, strlen(text), &run.scene));
    Status status = fem_model_create(&run.model, &run.scene);
    ck_assert_int_eq(status, is_quadratic ? STATUS_INPUT : STATUS_OK);
    if (status) {
      const char *const words[] = {"body 'one'", "a.ele: element 1", "element: linear"};
      for (int k = 0; k < 3; k++)
        ck_assert_msg(strstr(status_message(), words[k]) != NULL, "'%s' lacks '%s'", status_message(),
                      words[k]);
    } else {
      ck_assert_int_eq(run.model.vertex_count, 4);
      ck_assert_near(run.model.bodies[0].mass, 1, 1e-15);
    }
    scene_close(&run);
  }
}
END_TEST

// A curved element: the volume of its points is that of the straight one changed as a hand finds it, affine
// maps keep the ratio of the Jacobians, and an affine displacement is reproduced at every point.
START_TEST(a_curved_element_reproduces_affine_motions) {
  static const double A[9] = {1.2, 0.3, -0.1, 0.05, 0.9, 0.2, -0.3, 0.1, 1.1};
  double nodes[30], moved[30];
  FemQuadratic element;
  for (int k = 0; k < 4; k++) vec3_store(nodes + 3 * k, vec3_at(corners[k]));
  for (int k = 0; k < 6; k++)
    vec3_store(nodes + 12 + 3 * k, node_between(fem_quadratic_edges[k][0], fem_quadratic_edges[k][1]));
  fem_quadratic_create_curved(&element, nodes);
  for (int a = 0; a < 10; a++)
    for (int i = 0; i < 3; i++)
      moved[3 * a + i] =
          7 + A[3 * i] * nodes[3 * a] + A[3 * i + 1] * nodes[3 * a + 1] + A[3 * i + 2] * nodes[3 * a + 2];
  double det = vec3_det4((Vec3){0}, vec3_at(A), vec3_at(A + 3), vec3_at(A + 6));
  for (int p = 0; p < FEM_QUADRATIC_POINTS; p++)
    ck_assert_near(fem_quadratic_det(&element, p, moved), det, 1e-14);
  ck_assert_near(fem_quadratic_min_jacobian(moved), fem_quadratic_min_jacobian(nodes), 1e-13);
  FemQuadratic image;
  fem_quadratic_create_curved(&image, moved);
  ck_assert_near(image.volume, det * element.volume, 1e-14);
  // The middle of edge 12 moved by d along x changes the volume by d ∫ N n_x dA over the faces there, z = 0,
  // which has no n_x, and 123, whose share of the node is a third of ½: by d/6.
  FemQuadratic bulged;
  double straight[30];
  for (int k = 0; k < 4; k++) vec3_store(straight + 3 * k, vec3_at(corners[k]));
  for (int k = 0; k < 6; k++)
    vec3_store(straight + 12 + 3 * k, vec3_scale(0.5, vec3_add(vec3_at(corners[fem_quadratic_edges[k][0]]),
                                                               vec3_at(corners[fem_quadratic_edges[k][1]]))));
  straight[12 + 3 * 3] += 0.03;
  fem_quadratic_create_curved(&bulged, straight);
  ck_assert_near(bulged.volume - 1. / 6, 0.03 / 6, 1e-15);
}
END_TEST

// TetGen 1.5 marks corners only: their group takes the nodes on its edges as that of a linear mesh does. One
// that marks nodes on edges too means those and no others.
START_TEST(a_group_that_names_no_nodes_on_edges_has_those_between_its_corners) {
  static const int added[2] = {3, 1};
  for (int is_told = 0; is_told < 2; is_told++) {
    char text[512];
    snprintf(text, sizeof text,
             "10 3 0 1\n1 0 0 0 5\n2 1 0 0 5\n3 0 1 0 5\n4 0 0 1 0\n5 .5 0 0 0\n6 .5 .5 0 %d\n7 0 .5 0 0\n"
             "8 0 0 .5 0\n9 0 .5 .5 0\n10 .5 0 .5 0\n",
             is_told ? 5 : 0);
    put("a.node", text);
    put("a.ele", "1 10 0\n1 1 2 3 4  9 8 5 6 10 7\n");
    FemMesh mesh;
    ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL));
    ck_assert_int_eq(group_of(&mesh, "marker_5")->vertex_count, 3);
    ck_assert_ok(fem_mesh_make_quadratic(&mesh));
    const FemMeshGroup *group = group_of(&mesh, "marker_5");
    ck_assert_int_eq(group->vertex_count, 3 + added[is_told]);
    for (int k = 0; k < group->vertex_count; k++) ck_assert(mesh.rest[3 * group->vertices[k] + 2] == 0);
    fem_mesh_destroy(&mesh);
  }
}
END_TEST

// The text that a call writes to a stream.
static char *catch_output(int descriptor, void (*call)(void *), void *argument) {
  fflush(NULL);
  int saved = dup(descriptor);
  FILE *catcher = fopen(scratch("out"), "w");
  dup2(fileno(catcher), descriptor);
  call(argument);
  fflush(NULL);
  dup2(saved, descriptor);
  close(saved), fclose(catcher);
  char *text;
  size_t size;
  ck_assert_ok(file_read(scratch("out"), &text, &size));
  return text;
}

static void open_linear(void *run) {
  char text[512];
  snprintf(text, sizeof text,
           "time: {end: 1}\nbodies:\n  - name: one\n    mesh: %s\n"
           "    material: {law: linear, young: 1, poisson: 0.3, density: 6}\n",
           scratch("a.ele"));
  scene_open_text(run, text);
}

START_TEST(a_linear_body_says_what_it_leaves_out) {
  SceneRun run;
  write_tetgen((int[4]){0, 1, 2, 3});
  log_set_level(LOG_INFO);
  char *text = catch_output(STDERR_FILENO, open_linear, &run);
  // Largest on edge 03, of length 1: (0.01, 0.06, −0.03).
  double share = sqrt(0.01 * 0.01 + 0.06 * 0.06 + 0.03 * 0.03);
  char words[32];
  snprintf(words, sizeof words, "up to %.2g of an edge", share);
  ck_assert_msg(strstr(text, "a.ele: second-order tetrahedra, taken by their corners") != NULL, "%s", text);
  ck_assert_msg(strstr(text, words) != NULL, "'%s' lacks '%s'", text, words);
  ck_assert_int_eq(run.model.vertex_count, 4);
  memory_free(text);
  scene_close(&run);
}
END_TEST

static void run_mesh_command(void *arguments) {
  char **list = arguments;
  int count = 0;
  while (list[count]) count++;
  ck_assert_int_eq(app_command_mesh.run(count, list), 0);
}

START_TEST(the_command_tells_the_order) {
  char path[160];
  snprintf(path, sizeof path, "%s", write_medit((int[4]){0, 1, 2, 3}));
  char *plain[] = {"tetlap mesh", path, NULL}, *json[] = {"tetlap mesh", "--json", path, NULL},
       *linear[] = {"tetlap mesh", MESHES "block.msh", NULL};
  char *text = catch_output(STDOUT_FILENO, run_mesh_command, plain);
  ck_assert_msg(strstr(text, "order        2: ten nodes") != NULL, "%s", text);
  ck_assert_msg(strstr(text, "smallest Jacobian") != NULL, "%s", text);
  memory_free(text);
  text = catch_output(STDOUT_FILENO, run_mesh_command, json);
  ck_assert_msg(strstr(text, "\"order\": 2") != NULL, "%s", text);
  ck_assert_msg(strstr(text, "\"nodes_on_edges\": 6") != NULL, "%s", text);
  memory_free(text);
  text = catch_output(STDOUT_FILENO, run_mesh_command, linear);
  ck_assert_msg(strstr(text, "order        1") != NULL, "%s", text);
  memory_free(text);
}
END_TEST

static bool are_equal(const void *a, const void *b, size_t count, size_t size) {
  return a != b && memcmp(a, b, count * size) == 0;
}

START_TEST(a_copy_has_all_that_a_mesh_has) {
  FemMesh mesh, copy;
  write_tetgen((int[4]){0, 2, 1, 3});
  ck_assert_ok(fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL));
  ck_assert_ok(fem_mesh_copy(&copy, &mesh));
  ck_assert_int_gt(mesh.edge_count, 0);
  ck_assert_int_eq(copy.vertex_count, mesh.vertex_count);
  ck_assert_int_eq(copy.tet_count, mesh.tet_count);
  ck_assert_int_eq(copy.edge_count, mesh.edge_count);
  ck_assert(are_equal(copy.rest, mesh.rest, (size_t)mesh.vertex_count, sizeof(double[3])));
  ck_assert(are_equal(copy.tets, mesh.tets, (size_t)mesh.tet_count, sizeof *mesh.tets));
  ck_assert(are_equal(copy.middles, mesh.middles, (size_t)mesh.edge_count, sizeof(double[3])));
  fem_mesh_destroy(&copy), fem_mesh_destroy(&mesh);
  ck_assert_ok(fem_mesh_box(&mesh, (double[3]){1, 1, 1}, (int[3]){1, 1, 1}));
  ck_assert_ok(fem_mesh_copy(&copy, &mesh));
  ck_assert_int_gt(mesh.group_count, 0);
  ck_assert_int_eq(copy.group_count, mesh.group_count);
  for (int g = 0; g < mesh.group_count; g++) {
    ck_assert_str_eq(copy.groups[g].name, mesh.groups[g].name);
    ck_assert_int_eq(copy.groups[g].vertex_count, mesh.groups[g].vertex_count);
    ck_assert(are_equal(copy.groups[g].vertices, mesh.groups[g].vertices, (size_t)mesh.groups[g].vertex_count,
                        sizeof(int)));
  }
  fem_mesh_destroy(&copy), fem_mesh_destroy(&mesh);
}
END_TEST

START_TEST(every_failed_allocation_is_an_error) {
  write_tetgen((int[4]){0, 2, 1, 3});
  int k = 1;
  for (Status status = STATUS_MEMORY; status != STATUS_OK; k++) {
    FemMesh mesh, copy = {0};
    FemMeshCurvature curvature;
    memory_fail_at(k);
    status = fem_mesh_read(&mesh, scratch("a.ele"), NULL, NULL);
    if (!status) status = fem_mesh_curvature(&mesh, &curvature);
    if (!status) status = fem_mesh_copy(&copy, &mesh);
    if (!status) status = fem_mesh_make_quadratic(&mesh);
    memory_fail_at(0);
    ck_assert_msg(status == STATUS_OK || status == STATUS_MEMORY, "k = %d: %s", k, status_message());
    ck_assert_int_lt(k, 200);
    fem_mesh_destroy(&copy);
    fem_mesh_destroy(&mesh);
  }
  ck_assert_int_gt(k, 15);
}
END_TEST

int main(void) {
  // Loaded once for all tests, each of which reads in a process of its own.
  FemMeshGmshLibrary gmsh;
  if (fem_mesh_gmsh_library_load(&gmsh) != STATUS_OK) return EXIT_FAILURE;
  TCase *cases = tcase_create("mesh_second");
  tcase_add_checked_fixture(cases, make_directory, remove_directory);
  tcase_add_loop_test(cases, every_format_keeps_each_node_on_its_edge, 0, sizeof writers / sizeof *writers);
  tcase_add_test(cases, nodes_that_do_not_fit_together_are_refused);
  tcase_add_test(cases, tetrahedra_of_both_orders_in_a_file_are_refused);
  tcase_add_test(cases, an_element_that_is_inside_out_is_named_and_has_its_corners);
  tcase_add_test(cases, a_curved_element_reproduces_affine_motions);
  tcase_add_test(cases, a_group_that_names_no_nodes_on_edges_has_those_between_its_corners);
  tcase_add_test(cases, a_linear_body_says_what_it_leaves_out);
  tcase_add_test(cases, the_command_tells_the_order);
  tcase_add_test(cases, a_copy_has_all_that_a_mesh_has);
  tcase_add_test(cases, every_failed_allocation_is_an_error);
  return suite_run("mesh_second", cases, 60);
}
